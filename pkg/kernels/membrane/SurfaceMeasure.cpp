// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/membrane/SurfaceMeasure.hpp"

#include "kernels/base/Check.hpp"

#include <algorithm>

namespace hexmembrane {

namespace {

/// A triangle cut by two planes has at most five corners.
struct Polygon {
	std::array<Vec3, 6> corner;
	int size = 0;
	void add(const Vec3& c) { corner[size++] = c; }
};

/// Keeps the side where sign * (z - level) >= 0.
Polygon clip(const Polygon& in, double level, double sign)
{
	Polygon out;
	for (int i = 0; i < in.size; ++i) {
		const Vec3& a = in.corner[i];
		const Vec3& b = in.corner[(i + 1) % in.size];
		const double da = sign * (a[2] - level), db = sign * (b[2] - level);
		if (da >= 0) out.add(a);
		if ((da > 0 && db < 0) || (da < 0 && db > 0)) out.add(a + (da / (da - db)) * (b - a));
	}
	return out;
}

void add(const Polygon& polygon, TubeSlab& slab)
{
	const Vec3& first = polygon.corner[0];
	for (int i = 1; i + 1 < polygon.size; ++i) {
		const Vec3& b = polygon.corner[i];
		const Vec3& c = polygon.corner[i + 1];
		const Vec3 area = 0.5 * (b - first).cross(c - first);
		const Vec3 centroid = (first + b + c) / 3;
		slab.area += area.norm();
		slab.volume += 0.5 * (centroid[0] * area[0] + centroid[1] * area[1]);
	}
}

} // namespace

std::vector<TubeSlab> measureTube(const std::vector<std::array<int, 3>>& triangles, const std::vector<Vec3>& x, const std::vector<double>& heights)
{
	for (size_t k = 1; k < heights.size(); ++k)
		if (!(heights[k - 1] < heights[k]))
			reject("zBottom", heights[k - 1], "not below zTop = " + formatNumber(heights[k]), "give the lower platen's face first");
	std::vector<TubeSlab> slabs(heights.empty() ? 0 : heights.size() - 1, TubeSlab{0, 0});
	for (const auto& t : triangles) {
		const auto [low, high] = std::minmax({x[t[0]][2], x[t[1]][2], x[t[2]][2]});
		const auto above = std::lower_bound(heights.begin(), heights.end(), low);
		for (size_t k = above == heights.begin() ? 0 : above - heights.begin() - 1; k < slabs.size() && heights[k] <= high; ++k) {
			Polygon polygon;
			for (int corner : t) polygon.add(x[corner]);
			if (low < heights[k]) polygon = clip(polygon, heights[k], 1.);
			if (heights[k + 1] < high) polygon = clip(polygon, heights[k + 1], -1.);
			add(polygon, slabs[k]);
		}
	}
	return slabs;
}

double closedVolume(const std::vector<std::array<int, 3>>& triangles, const std::vector<Vec3>& x)
{
	double sum = 0;
	for (const auto& t : triangles) sum += x[t[0]].dot(x[t[1]].cross(x[t[2]]));
	return sum / 6;
}

} // namespace hexmembrane
