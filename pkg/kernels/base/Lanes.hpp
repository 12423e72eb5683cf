// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/base/Simd.hpp"
#include "kernels/base/Vec3.hpp"

#include <cmath>

/* Four doubles at a time, in GCC's and clang's vector types: plain operators, compiled to whatever the function around them is compiled for
 * (HEXMEMBRANE_WIDEST). Everything here is inlined into that function: a vector type must not cross the border between two instruction sets. */
namespace hexmembrane {

#define HEXMEMBRANE_INLINE inline __attribute__((always_inline))

typedef double Lanes __attribute__((vector_size(32)));
typedef long long LaneMask __attribute__((vector_size(32))); ///< of a comparison: all bits or none
typedef double HalfLanes __attribute__((vector_size(16)));

HEXMEMBRANE_INLINE Lanes lanes(double value) { return Lanes{value, value, value, value}; }

HEXMEMBRANE_INLINE Lanes load4(const double* from)
{
	Lanes v;
	__builtin_memcpy(&v, from, sizeof v);
	return v;
}
HEXMEMBRANE_INLINE void store4(double* to, Lanes v) { __builtin_memcpy(to, &v, sizeof v); }

HEXMEMBRANE_INLINE HalfLanes load2(const double* from)
{
	HalfLanes v;
	__builtin_memcpy(&v, from, sizeof v);
	return v;
}
HEXMEMBRANE_INLINE void store2(double* to, HalfLanes v) { __builtin_memcpy(to, &v, sizeof v); }

HEXMEMBRANE_INLINE Lanes joined(HalfLanes low, HalfLanes high) { return __builtin_shufflevector(low, high, 0, 1, 2, 3); }
HEXMEMBRANE_INLINE HalfLanes lowHalf(Lanes v) { return __builtin_shufflevector(v, v, 0, 1); }
HEXMEMBRANE_INLINE HalfLanes highHalf(Lanes v) { return __builtin_shufflevector(v, v, 2, 3); }

HEXMEMBRANE_INLINE Lanes squareRoot(Lanes v)
{
	Lanes root = v;
	for (int k = 0; k < 4; ++k) root[k] = std::sqrt(v[k]);
	return root;
}
HEXMEMBRANE_INLINE double squareRoot(double v) { return std::sqrt(v); }

/// The larger one; a NaN in `a` gives b, one in `b` stays.
template <class V>
HEXMEMBRANE_INLINE V larger(V a, V b)
{
	return a > b ? a : b;
}

/// Rows become columns: four records of four numbers become the four numbers of four records, and back.
HEXMEMBRANE_INLINE void transpose(Lanes& a, Lanes& b, Lanes& c, Lanes& d)
{
	const Lanes evenAb = __builtin_shufflevector(a, b, 0, 4, 2, 6), oddAb = __builtin_shufflevector(a, b, 1, 5, 3, 7);
	const Lanes evenCd = __builtin_shufflevector(c, d, 0, 4, 2, 6), oddCd = __builtin_shufflevector(c, d, 1, 5, 3, 7);
	a = __builtin_shufflevector(evenAb, evenCd, 0, 1, 4, 5);
	b = __builtin_shufflevector(oddAb, oddCd, 0, 1, 4, 5);
	c = __builtin_shufflevector(evenAb, evenCd, 2, 3, 6, 7);
	d = __builtin_shufflevector(oddAb, oddCd, 2, 3, 6, 7);
}

/// Four vectors.
struct Lanes3 {
	Lanes x, y, z;
};

HEXMEMBRANE_INLINE Lanes3 operator+(const Lanes3& a, const Lanes3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
HEXMEMBRANE_INLINE Lanes3 operator-(const Lanes3& a, const Lanes3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
HEXMEMBRANE_INLINE Lanes3 operator*(Lanes s, const Lanes3& v) { return {s * v.x, s * v.y, s * v.z}; }
HEXMEMBRANE_INLINE Lanes dot(const Lanes3& a, const Lanes3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
HEXMEMBRANE_INLINE Lanes3 cross(const Lanes3& a, const Lanes3& b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }

HEXMEMBRANE_INLINE double dot(const Vec3& a, const Vec3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
HEXMEMBRANE_INLINE Vec3 cross(const Vec3& a, const Vec3& b) { return a.cross(b); }

/// The part of v across the unit vector n.
HEXMEMBRANE_INLINE Vec3 acrossNormal(const Vec3& v, const Vec3& n) { return v - dot(n, v) * n; }
HEXMEMBRANE_INLINE Lanes3 acrossNormal(const Lanes3& v, const Lanes3& n) { return v - dot(n, v) * n; }

/// What a formula is written over: one number (V = double) or four (V = Lanes). `mask ? a : b` is a branch for the one and a choice lane by lane for the other.
template <class V>
struct Width;
template <>
struct Width<double> {
	using Vector = Vec3;
	using Mask = bool;
	static double constant(double value) { return value; }
};
template <>
struct Width<Lanes> {
	using Vector = Lanes3;
	using Mask = LaneMask;
	HEXMEMBRANE_INLINE static Lanes constant(double value) { return lanes(value); }
};
template <class V>
using Vector = typename Width<V>::Vector;
template <class V>
using Mask = typename Width<V>::Mask;
template <class V>
HEXMEMBRANE_INLINE V constant(double value)
{
	return Width<V>::constant(value);
}

} // namespace hexmembrane
