// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/base/Simd.hpp"
#include "kernels/base/Vec3.hpp"

#include <cmath>

/* Several doubles side by side, in GCC's and clang's vector types: plain operators, compiled to whatever the function around them is compiled for
 * (HEXMEMBRANE_WIDEST). Everything here is inlined into that function: a vector type must not cross the border between two instruction sets.
 *
 * What has a parameter V is written once for any number of lanes; a function by HEXMEMBRANE_WIDEST_LANES is given the number that its set's registers hold. */
namespace hexmembrane {

#define HEXMEMBRANE_INLINE inline __attribute__((always_inline))

template <int n>
struct LanesOf {
	typedef double Type __attribute__((vector_size(8 * n)));
};
template <int n>
using Lanes = typename LanesOf<n>::Type; ///< n doubles, n = 2, 4 or 8
using Four = Lanes<4>;                   ///< what a record holds in a row
using Two = Lanes<2>;
template <class V>
constexpr int laneCount = sizeof(V) / sizeof(double);
template <class V>
using LaneMask = decltype(V{} < V{}); ///< of a comparison: all bits or none

template <class V>
HEXMEMBRANE_INLINE V lanes(double value)
{
	return value - V{};
}
template <class V>
HEXMEMBRANE_INLINE V load(const double* from)
{
	V v;
	__builtin_memcpy(&v, from, sizeof v);
	return v;
}
template <class V>
HEXMEMBRANE_INLINE void store(double* to, V v)
{
	__builtin_memcpy(to, &v, sizeof v);
}

HEXMEMBRANE_INLINE Four joined(Two low, Two high) { return __builtin_shufflevector(low, high, 0, 1, 2, 3); }
HEXMEMBRANE_INLINE Lanes<8> joined(Four low, Four high) { return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7); }
HEXMEMBRANE_INLINE Two lowHalf(Four v) { return __builtin_shufflevector(v, v, 0, 1); }
HEXMEMBRANE_INLINE Two highHalf(Four v) { return __builtin_shufflevector(v, v, 2, 3); }
HEXMEMBRANE_INLINE Four lowHalf(Lanes<8> v) { return __builtin_shufflevector(v, v, 0, 1, 2, 3); }
HEXMEMBRANE_INLINE Four highHalf(Lanes<8> v) { return __builtin_shufflevector(v, v, 4, 5, 6, 7); }

/// Of all lanes, neighbours first.
HEXMEMBRANE_INLINE double total(Two v) { return v[0] + v[1]; }
template <class V>
HEXMEMBRANE_INLINE double total(V v)
{
	return total(lowHalf(v)) + total(highHalf(v));
}

template <class V>
HEXMEMBRANE_INLINE V squareRoot(V v)
{
	V root = v;
	for (int k = 0; k < laneCount<V>; ++k) root[k] = std::sqrt(v[k]);
	return root;
}
HEXMEMBRANE_INLINE double squareRoot(double v) { return std::sqrt(v); }

/// The larger one; a NaN in `a` gives b, one in `b` stays.
template <class V>
HEXMEMBRANE_INLINE V larger(V a, V b)
{
	return a > b ? a : b;
}

/// A row of four numbers for each lane, as registers hold them: always four registers. Their order is the one that turns into columns by the fewest steps, so
/// rows are added and subtracted by register, and looked at one by one with row().
template <class V>
struct Rows {
	V part[4];

	/// \param at(k) where the four numbers of row k stand
	template <class At>
	static HEXMEMBRANE_INLINE Rows loaded(const At& at)
	{
		if constexpr (laneCount<V> == 2)
			return {{load<V>(at(0)), load<V>(at(0) + 2), load<V>(at(1)), load<V>(at(1) + 2)}};
		else if constexpr (laneCount<V> == 4)
			return {{load<V>(at(0)), load<V>(at(1)), load<V>(at(2)), load<V>(at(3))}};
		else
			return {{joined(load<Four>(at(0)), load<Four>(at(2))), joined(load<Four>(at(1)), load<Four>(at(3))),
			         joined(load<Four>(at(4)), load<Four>(at(6))), joined(load<Four>(at(5)), load<Four>(at(7)))}};
	}
	template <class At>
	HEXMEMBRANE_INLINE void stored(const At& at) const
	{
#pragma GCC unroll 8
		for (int k = 0; k < laneCount<V>; ++k) store(at(k), row(k));
	}
	HEXMEMBRANE_INLINE Four row(int k) const
	{
		if constexpr (laneCount<V> == 2)
			return joined(part[2 * k], part[2 * k + 1]);
		else if constexpr (laneCount<V> == 4)
			return part[k];
		else {
			const V& both = part[k / 4 * 2 + k % 2];
			return k & 2 ? highHalf(both) : lowHalf(both);
		}
	}
	/// The first number of all rows, the second, the third, the fourth.
	HEXMEMBRANE_INLINE void columns(V& a, V& b, V& c, V& d) const
	{
		const V &p = part[0], &q = part[1], &r = part[2], &s = part[3];
		if constexpr (laneCount<V> == 2) {
			a = __builtin_shufflevector(p, r, 0, 2);
			b = __builtin_shufflevector(p, r, 1, 3);
			c = __builtin_shufflevector(q, s, 0, 2);
			d = __builtin_shufflevector(q, s, 1, 3);
		} else if constexpr (laneCount<V> == 4) {
			const V evenPq = __builtin_shufflevector(p, q, 0, 4, 2, 6), oddPq = __builtin_shufflevector(p, q, 1, 5, 3, 7);
			const V evenRs = __builtin_shufflevector(r, s, 0, 4, 2, 6), oddRs = __builtin_shufflevector(r, s, 1, 5, 3, 7);
			a = __builtin_shufflevector(evenPq, evenRs, 0, 1, 4, 5);
			b = __builtin_shufflevector(oddPq, oddRs, 0, 1, 4, 5);
			c = __builtin_shufflevector(evenPq, evenRs, 2, 3, 6, 7);
			d = __builtin_shufflevector(oddPq, oddRs, 2, 3, 6, 7);
		} else {
			const V evenPq = __builtin_shufflevector(p, q, 0, 8, 2, 10, 4, 12, 6, 14),
			        oddPq = __builtin_shufflevector(p, q, 1, 9, 3, 11, 5, 13, 7, 15);
			const V evenRs = __builtin_shufflevector(r, s, 0, 8, 2, 10, 4, 12, 6, 14),
			        oddRs = __builtin_shufflevector(r, s, 1, 9, 3, 11, 5, 13, 7, 15);
			a = __builtin_shufflevector(evenPq, evenRs, 0, 1, 4, 5, 8, 9, 12, 13);
			b = __builtin_shufflevector(oddPq, oddRs, 0, 1, 4, 5, 8, 9, 12, 13);
			c = __builtin_shufflevector(evenPq, evenRs, 2, 3, 6, 7, 10, 11, 14, 15);
			d = __builtin_shufflevector(oddPq, oddRs, 2, 3, 6, 7, 10, 11, 14, 15);
		}
	}
	static HEXMEMBRANE_INLINE Rows ofColumns(V a, V b, V c, V d)
	{
		if constexpr (laneCount<V> == 2)
			return {{__builtin_shufflevector(a, b, 0, 2), __builtin_shufflevector(c, d, 0, 2), __builtin_shufflevector(a, b, 1, 3),
			         __builtin_shufflevector(c, d, 1, 3)}};
		else if constexpr (laneCount<V> == 4) {
			Rows rows;
			Rows{{a, b, c, d}}.columns(rows.part[0], rows.part[1], rows.part[2], rows.part[3]);
			return rows;
		} else {
			const V evenAb = __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14),
			        oddAb = __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15);
			const V evenCd = __builtin_shufflevector(c, d, 0, 8, 2, 10, 4, 12, 6, 14),
			        oddCd = __builtin_shufflevector(c, d, 1, 9, 3, 11, 5, 13, 7, 15);
			return {{__builtin_shufflevector(evenAb, evenCd, 0, 1, 8, 9, 2, 3, 10, 11),
			         __builtin_shufflevector(oddAb, oddCd, 0, 1, 8, 9, 2, 3, 10, 11),
			         __builtin_shufflevector(evenAb, evenCd, 4, 5, 12, 13, 6, 7, 14, 15),
			         __builtin_shufflevector(oddAb, oddCd, 4, 5, 12, 13, 6, 7, 14, 15)}};
		}
	}
	/// The first three numbers of these rows, then the fourth of `others`.
	HEXMEMBRANE_INLINE Rows withFourth(const Rows& others) const
	{
		Rows rows;
		if constexpr (laneCount<V> == 2)
			rows = {{part[0], __builtin_shufflevector(part[1], others.part[1], 0, 3), part[2],
			         __builtin_shufflevector(part[3], others.part[3], 0, 3)}};
		else if constexpr (laneCount<V> == 4)
			for (int i = 0; i < 4; ++i) rows.part[i] = __builtin_shufflevector(part[i], others.part[i], 0, 1, 2, 7);
		else
			for (int i = 0; i < 4; ++i) rows.part[i] = __builtin_shufflevector(part[i], others.part[i], 0, 1, 2, 11, 4, 5, 6, 15);
		return rows;
	}
	/// The first two numbers of these rows, then those of `others`.
	HEXMEMBRANE_INLINE Rows withFirstTwo(const Rows& others) const
	{
		Rows rows;
		if constexpr (laneCount<V> == 2)
			rows = {{part[0], others.part[0], part[2], others.part[2]}};
		else if constexpr (laneCount<V> == 4)
			for (int i = 0; i < 4; ++i) rows.part[i] = __builtin_shufflevector(part[i], others.part[i], 0, 1, 4, 5);
		else
			for (int i = 0; i < 4; ++i) rows.part[i] = __builtin_shufflevector(part[i], others.part[i], 0, 1, 8, 9, 4, 5, 12, 13);
		return rows;
	}
};
template <class V>
HEXMEMBRANE_INLINE Rows<V> operator+(const Rows<V>& a, const Rows<V>& b)
{
	return {{a.part[0] + b.part[0], a.part[1] + b.part[1], a.part[2] + b.part[2], a.part[3] + b.part[3]}};
}
template <class V>
HEXMEMBRANE_INLINE Rows<V> operator-(const Rows<V>& a, const Rows<V>& b)
{
	return {{a.part[0] - b.part[0], a.part[1] - b.part[1], a.part[2] - b.part[2], a.part[3] - b.part[3]}};
}

/// As many vectors as lanes.
template <class V>
struct Lanes3 {
	V x, y, z;

	friend HEXMEMBRANE_INLINE Lanes3 operator+(const Lanes3& a, const Lanes3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
	friend HEXMEMBRANE_INLINE Lanes3 operator-(const Lanes3& a, const Lanes3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
	friend HEXMEMBRANE_INLINE Lanes3 operator*(V s, const Lanes3& v) { return {s * v.x, s * v.y, s * v.z}; }
	friend HEXMEMBRANE_INLINE V dot(const Lanes3& a, const Lanes3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
	friend HEXMEMBRANE_INLINE Lanes3 cross(const Lanes3& a, const Lanes3& b)
	{
		return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
	}
};

HEXMEMBRANE_INLINE double dot(const Vec3& a, const Vec3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
HEXMEMBRANE_INLINE Vec3 cross(const Vec3& a, const Vec3& b) { return a.cross(b); }

/// The part of v across the unit vector n.
HEXMEMBRANE_INLINE Vec3 acrossNormal(const Vec3& v, const Vec3& n) { return v - dot(n, v) * n; }
template <class V>
HEXMEMBRANE_INLINE Lanes3<V> acrossNormal(const Lanes3<V>& v, const Lanes3<V>& n)
{
	return v - dot(n, v) * n;
}

/// What a formula is written over: one number (V = double) or several (V = Lanes). `mask ? a : b` is a branch for the one and a choice lane by lane for the others.
template <class V>
struct Width {
	using Vector = Lanes3<V>;
	using Mask = LaneMask<V>;
	HEXMEMBRANE_INLINE static V constant(double value) { return lanes<V>(value); }
};
template <>
struct Width<double> {
	using Vector = Vec3;
	using Mask = bool;
	static double constant(double value) { return value; }
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
