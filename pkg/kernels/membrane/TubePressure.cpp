// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/membrane/TubePressure.hpp"

#include "kernels/base/Check.hpp"
#include "kernels/base/Simd.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hexmembrane {

namespace {

/// The three coordinates of a row.
struct Row {
	const double *x, *y, *z;
	Row(const PaddedRings& field, int k, int shift = 0) : x(field.row(0, k) + shift), y(field.row(1, k) + shift), z(field.row(2, k) + shift) {}
};

struct OutRow {
	double *x, *y, *z;
	OutRow(PaddedRings& field, int k) : x(field.row(0, k)), y(field.row(1, k)), z(field.row(2, k)) {}
};

/// Twice the area vectors of the triangles between a ring, `a`, and the next one, `c`, which is shifted so that c[i] stands right above a[i].
HEXMEMBRANE_WIDEST void areaRow(int n, Row a, Row c, OutRow up, OutRow down)
{
	double* __restrict ux = up.x, * __restrict uy = up.y, * __restrict uz = up.z;
	double* __restrict dx = down.x, * __restrict dy = down.y, * __restrict dz = down.z;
#pragma omp simd
	for (int i = 0; i < n; ++i) {
		const double bx = a.x[i + 1] - a.x[i], by = a.y[i + 1] - a.y[i], bz = a.z[i + 1] - a.z[i];
		const double rx = c.x[i] - a.x[i], ry = c.y[i] - a.y[i], rz = c.z[i] - a.z[i];
		const double lx = c.x[i - 1] - a.x[i], ly = c.y[i - 1] - a.y[i], lz = c.z[i - 1] - a.z[i];
		ux[i] = by * rz - bz * ry;
		uy[i] = bz * rx - bx * rz;
		uz[i] = bx * ry - by * rx;
		dx[i] = ry * lz - rz * ly;
		dy[i] = rz * lx - rx * lz;
		dz[i] = rx * ly - ry * lx;
	}
}

/// What a particle sums: three triangles of its own row, and three of the row below, shifted as in areaRow.
template <typename Value>
inline double six(Value up, Value down, Value below, Value belowDown, int i)
{
	return (up[i] + up[i - 1] + down[i]) + (below[i] + belowDown[i] + belowDown[i + 1]);
}

/// inner = x - offset S/|S| with S the sum round each particle; where the triangles cancel the particle itself.
HEXMEMBRANE_WIDEST void innerRow(int n, double offset, Row x, Row up, Row down, Row below, Row belowDown, OutRow out)
{
	double* __restrict ox = out.x, * __restrict oy = out.y, * __restrict oz = out.z;
	constexpr double tiny = std::numeric_limits<double>::min();
#pragma omp simd
	for (int i = 0; i < n; ++i) {
		const double sx = six(up.x, down.x, below.x, belowDown.x, i);
		const double sy = six(up.y, down.y, below.y, belowDown.y, i);
		const double sz = six(up.z, down.z, below.z, belowDown.z, i);
		const double c = offset / std::max(std::sqrt(sx * sx + sy * sy + sz * sz), tiny);
		ox[i] = x.x[i] - c * sx;
		oy[i] = x.y[i] - c * sy;
		oz[i] = x.z[i] - c * sz;
	}
}

HEXMEMBRANE_WIDEST void forceRow(int n, double factor, Row up, Row down, Row below, Row belowDown, OutRow out)
{
	double* __restrict ox = out.x, * __restrict oy = out.y, * __restrict oz = out.z;
#pragma omp simd
	for (int i = 0; i < n; ++i) {
		ox[i] = factor * six(up.x, down.x, below.x, belowDown.x, i);
		oy[i] = factor * six(up.y, down.y, below.y, belowDown.y, i);
		oz[i] = factor * six(up.z, down.z, below.z, belowDown.z, i);
	}
}

} // namespace

// Rows of triangles beyond the tube's ends stay zero: two more rows of storage, ring k's triangles in row k + 1.
TubePressure::TubePressure(const HexStencil& s, int firstRing, int lastRing, double inwards)
    : force(s.perRing, s.rings), stencil(s), first(firstRing), last(lastRing), offset(inwards), up(s.perRing, s.rings + 2), down(up), inner(s.perRing, s.rings)
{
	requireNonNegative("offset", inwards, "m");
	if (first < 0 || first > last || last >= s.rings) reject("first", first, "no such rings", "0 <= first <= last < rings");
}

void TubePressure::areaVectors(const PaddedRings& x)
{
	const int from = std::max(first - 2, 0), to = std::min(last + 1, stencil.rings - 2);
#pragma omp parallel for schedule(static)
	for (int k = from; k <= to; ++k) {
		areaRow(stencil.perRing, Row(x, k), Row(x, k + 1, HexStencil::right(k)), OutRow(up, k + 1), OutRow(down, k + 1));
		up.wrap(k + 1);
		down.wrap(k + 1);
	}
}

void TubePressure::compute(double pressure, const PaddedRings& position)
{
	const int n = stencil.perRing;
	// a particle's triangles of the row below: those whose upper right neighbour it is, at i - right(k - 1), which is right(k + 1)
	const auto below = [&](const PaddedRings& field, int k) { return Row(field, k, -HexStencil::right(k + 1)); };
	areaVectors(position);
	if (offset > 0) {
		const int from = std::max(first - 1, 0), to = std::min(last + 1, stencil.rings - 1);
#pragma omp parallel for schedule(static)
		for (int k = from; k <= to; ++k) {
			innerRow(n, offset, Row(position, k), Row(up, k + 1), Row(down, k + 1), below(up, k), below(down, k), OutRow(inner, k));
			inner.wrap(k);
		}
		areaVectors(inner);
	}
#pragma omp parallel for schedule(static)
	for (int k = first; k <= last; ++k) forceRow(n, -pressure / 6, Row(up, k + 1), Row(down, k + 1), below(up, k), below(down, k), OutRow(force, k));
}

double TubePressure::area() const
{
	double sum = 0;
	for (int k = first; k <= last; ++k)
		for (int i = 0; i < stencil.perRing; ++i) {
			const int r = HexStencil::right(k + 1);
			const auto size = [](const PaddedRings& field, int row, int j) {
				return Vec3(field.row(0, row)[j], field.row(1, row)[j], field.row(2, row)[j]).norm();
			};
			sum += size(up, k + 1, i) + size(up, k + 1, i - 1) + size(down, k + 1, i) + size(up, k, i - r) + size(down, k, i - r) +
			       size(down, k, i - r + 1);
		}
	return sum / 6;
}

} // namespace hexmembrane
