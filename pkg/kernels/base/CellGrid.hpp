// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/base/Vec3.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace hexmembrane {

/// Finds what lies near what in O(N): a box cut into equal cells, points sorted by cell with a counting sort.
///
/// Two points closer than `cellSize` on every axis always lie in the same or in neighbouring cells, points outside the box included (they are counted in
/// the border cells, where a grid of the right size has few of them). All visits come in an order that follows from the points alone, so that sums over
/// them are reproducible. Not thread safe while filling; visiting is const and safe from many threads.
class CellGrid {
public:
	/// Box from `low` to `high` (m) in cells at least `cellSize` wide (m).
	/// \throws std::invalid_argument for a box that is empty or not finite, a cell size that is not positive, or more than `maxCells` cells.
	CellGrid(const Vec3& low, const Vec3& high, double cellSize);

	/// Sorts `points` into the cells, forgetting those of before. \throws std::invalid_argument naming the first point that is not finite.
	void fill(const std::vector<Vec3>& points);

	/// Calls visit(i, j) once for every unordered pair of points in the same or in neighbouring cells.
	template <class Visit>
	void forEachPair(Visit&& visit) const;

	/// Calls visit(i) for every point in the cell of `place` and in its neighbours. Nothing is near a place that is not finite: it is no error, since the call
	/// stands in parallel loops, which no exception may leave.
	template <class Visit>
	void forEachNear(const Vec3& place, Visit&& visit) const;

	/// Calls visit(i) for every point in the cells that the ball round `place` meets: all points within `reach` (m) and some beyond. Cells of a row come one
	/// after the other, so that points that were sorted by order() are read as they lie. Nothing is near a place or a reach that is not finite.
	template <class Visit>
	void forEachWithin(const Vec3& place, double reach, Visit&& visit) const;

	/// Number of cells along x, y and z.
	const std::array<int, 3>& cells() const { return count; }
	/// Indices of the points sorted by cell: neighbours in this order are neighbours in space.
	const std::vector<int>& order() const { return sorted; }

	/// Limit of the number of cells (1 GB of bookkeeping would be a mistake of units, not a wish).
	static constexpr std::size_t maxCells = std::size_t(1) << 27;

private:
	int cellOf(double coordinate, int axis) const;
	double distanceToCells(double coordinate, int cell, int axis) const;
	std::size_t indexOf(int ix, int iy, int iz) const { return (std::size_t(iz) * count[1] + iy) * count[0] + ix; }

	Vec3 origin;
	Vec3 perLength; // cells per metre along each axis
	std::array<int, 3> count;
	std::vector<int> first; // first[c] .. first[c + 1]: the points of cell c in `sorted`
	std::vector<int> sorted;
	std::vector<int> cellIndex; // of each point, kept to spare an allocation
};

template <class Visit>
void CellGrid::forEachPair(Visit&& visit) const
{
	// the 13 neighbours that come later in the order of the cells; with the cell itself every pair is met once
	static constexpr int later[13][3] = {{1, 0, 0},  {-1, 1, 0}, {0, 1, 0}, {1, 1, 0},  {-1, -1, 1}, {0, -1, 1}, {1, -1, 1},
	                                     {-1, 0, 1}, {0, 0, 1},  {1, 0, 1}, {-1, 1, 1}, {0, 1, 1},   {1, 1, 1}};
	for (int iz = 0; iz < count[2]; ++iz)
		for (int iy = 0; iy < count[1]; ++iy)
			for (int ix = 0; ix < count[0]; ++ix) {
				const std::size_t c = indexOf(ix, iy, iz);
				const int end = first[c + 1];
				if (first[c] == end) continue;
				for (int a = first[c]; a < end; ++a)
					for (int b = a + 1; b < end; ++b) visit(sorted[a], sorted[b]);
				for (const auto& d : later) {
					const int jx = ix + d[0], jy = iy + d[1], jz = iz + d[2];
					if (jx < 0 || jx >= count[0] || jy < 0 || jy >= count[1] || jz >= count[2]) continue;
					const std::size_t n = indexOf(jx, jy, jz);
					for (int a = first[c]; a < end; ++a)
						for (int b = first[n]; b < first[n + 1]; ++b) visit(sorted[a], sorted[b]);
				}
			}
}

template <class Visit>
void CellGrid::forEachNear(const Vec3& place, Visit&& visit) const
{
	if (first.empty() || !place.allFinite()) return;
	std::array<int, 3> c;
	for (int axis = 0; axis < 3; ++axis) c[axis] = cellOf(place[axis], axis);
	for (int iz = std::max(c[2] - 1, 0); iz <= std::min(c[2] + 1, count[2] - 1); ++iz)
		for (int iy = std::max(c[1] - 1, 0); iy <= std::min(c[1] + 1, count[1] - 1); ++iy)
			for (int ix = std::max(c[0] - 1, 0); ix <= std::min(c[0] + 1, count[0] - 1); ++ix) {
				const std::size_t n = indexOf(ix, iy, iz);
				for (int a = first[n]; a < first[n + 1]; ++a) visit(sorted[a]);
			}
}

template <class Visit>
void CellGrid::forEachWithin(const Vec3& place, double reach, Visit&& visit) const
{
	if (first.empty() || !place.allFinite() || !(reach >= 0) || !(reach < std::numeric_limits<double>::infinity())) return;
	const int lastZ = cellOf(place[2] + reach, 2), lastY = cellOf(place[1] + reach, 1), firstY = cellOf(place[1] - reach, 1);
	for (int iz = cellOf(place[2] - reach, 2); iz <= lastZ; ++iz) {
		const double dz = distanceToCells(place[2], iz, 2), left = reach * reach - dz * dz;
		for (int iy = firstY; iy <= lastY; ++iy) {
			const double dy = distanceToCells(place[1], iy, 1), square = left - dy * dy;
			if (square < 0) continue;
			const double half = std::sqrt(square);
			const int end = first[indexOf(cellOf(place[0] + half, 0), iy, iz) + 1];
			for (int a = first[indexOf(cellOf(place[0] - half, 0), iy, iz)]; a < end; ++a) visit(sorted[a]);
		}
	}
}

/// Neighbour list of spheres: the partners of sphere i are other[start[i]] .. other[start[i + 1] - 1], all > i, ascending. Every pair stands once.
struct NearPairs {
	std::vector<int> start;
	std::vector<int> other;
};

/// All pairs of spheres whose surfaces are nearer than `gap` (m, >= 0): |xi - xj| < ri + rj + gap. `low` and `high` bound where the spheres are.
/// Sorted, so that whatever is summed along the list is reproducible. \throws std::invalid_argument as CellGrid does, or for unequal lengths.
NearPairs findNearPairs(const std::vector<Vec3>& centres, const std::vector<double>& radii, double gap, const Vec3& low, const Vec3& high);

} // namespace hexmembrane
