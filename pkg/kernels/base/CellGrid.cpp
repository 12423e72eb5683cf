// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/base/CellGrid.hpp"

#include "kernels/base/Check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace hexmembrane {

CellGrid::CellGrid(const Vec3& low, const Vec3& high, double cellSize) : origin(low)
{
	requirePositive("cellSize", cellSize, "m");
	double total = 1;
	for (int axis = 0; axis < 3; ++axis) {
		requireFinite("low", low[axis], "m");
		requireFinite("high", high[axis], "m");
		const double length = high[axis] - low[axis];
		if (!(length >= 0)) reject("high", high[axis], "below low = " + formatNumber(low[axis]), "a box with low <= high on every axis");
		const double cells = std::max(1.0, std::floor(length / cellSize));
		total *= cells;
		if (total > double(maxCells))
			reject("cellSize", cellSize, "makes more than " + std::to_string(maxCells) + " cells in this box", "a larger cell or a smaller box");
		count[axis] = int(cells);
		perLength[axis] = length > 0 ? cells / length : 0;
	}
}

int CellGrid::cellOf(double coordinate, int axis) const
{
	const double cell = (coordinate - origin[axis]) * perLength[axis];
	// clamped as a double: far outside, the conversion to int would be undefined
	return int(std::clamp(cell, 0.0, double(count[axis] - 1)));
}

// Along one axis, never too large: cells at the border reach to infinity, and a point beside a border between cells may have been rounded across it.
double CellGrid::distanceToCells(double coordinate, int cell, int axis) const
{
	const double place = (coordinate - origin[axis]) * perLength[axis], below = cell > 0 ? cell - place : 0,
	             above = cell + 1 < count[axis] ? place - cell - 1 : 0;
	const double cells = std::max(below, above) - 1e-6;
	return cells > 0 ? cells / perLength[axis] : 0;
}

void CellGrid::fill(const std::vector<Vec3>& points)
{
	if (points.size() > std::size_t(std::numeric_limits<int>::max())) reject("points", double(points.size()), "too many", "fewer than 2^31 points");
	for (std::size_t i = 0; i < points.size(); ++i)
		for (int axis = 0; axis < 3; ++axis)
			if (!std::isfinite(points[i][axis]))
				reject("points[" + std::to_string(i) + "]", points[i][axis], "not a finite coordinate", "find out what sent the point away");

	cellIndex.resize(points.size());
	sorted.resize(points.size());
	first.assign(std::size_t(count[0]) * count[1] * count[2] + 1, 0);
	for (std::size_t i = 0; i < points.size(); ++i) {
		cellIndex[i] = int(indexOf(cellOf(points[i][0], 0), cellOf(points[i][1], 1), cellOf(points[i][2], 2)));
		++first[cellIndex[i]];
	}
	for (std::size_t c = 1; c < first.size(); ++c) first[c] += first[c - 1];
	// now first[c] is the end of cell c; filling from the back turns it into the start and keeps the order of the points within a cell
	for (std::size_t i = points.size(); i-- > 0;) sorted[--first[cellIndex[i]]] = int(i);
}

NearPairs findNearPairs(const std::vector<Vec3>& centres, const std::vector<double>& radii, double gap, const Vec3& low, const Vec3& high)
{
	if (centres.size() != radii.size())
		reject("radii", double(radii.size()), "radii for " + std::to_string(centres.size()) + " centres", "one radius for each centre");
	requireNonNegative("gap", gap, "m");
	NearPairs pairs;
	pairs.start.assign(centres.size() + 1, 0);
	if (centres.empty()) return pairs;
	for (std::size_t i = 0; i < radii.size(); ++i) requirePositive("radii[" + std::to_string(i) + "]", radii[i], "m");

	// no finer than one cell a sphere: a few grains of dust in a large box need no millions of cells
	const double reach = 2 * *std::max_element(radii.begin(), radii.end()) + gap;
	const double spacing = std::cbrt(std::abs((high - low).prod()) / double(centres.size()));
	CellGrid grid(low, high, std::max(reach, spacing));
	grid.fill(centres);
	const auto forEachNear = [&](auto&& visit) {
		grid.forEachPair([&](int i, int j) {
			const double near = radii[i] + radii[j] + gap;
			if ((centres[i] - centres[j]).squaredNorm() < near * near) visit(std::min(i, j), std::max(i, j));
		});
	};
	std::vector<std::array<int, 2>> found;
	forEachNear([&](int i, int j) {
		found.push_back({i, j});
		++pairs.start[std::size_t(i) + 1];
	});
	for (std::size_t i = 1; i < pairs.start.size(); ++i) pairs.start[i] += pairs.start[i - 1];
	pairs.other.resize(found.size());
	std::vector<int> next(pairs.start.begin(), pairs.start.end() - 1);
	for (const auto& pair : found) pairs.other[next[pair[0]]++] = pair[1];
	for (std::size_t i = 0; i < centres.size(); ++i) std::sort(pairs.other.begin() + pairs.start[i], pairs.other.begin() + pairs.start[i + 1]);
	return pairs;
}

} // namespace hexmembrane
