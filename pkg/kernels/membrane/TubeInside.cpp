// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/membrane/TubeInside.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hexmembrane {

namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

double square(double a) { return a * a; }

double solidAngle(const Vec3& a, const Vec3& b, const Vec3& c)
{
	const double la = a.norm(), lb = b.norm(), lc = c.norm();
	return 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}

} // namespace

TubeInside::TubeInside(int perRing, const std::vector<std::array<int, 3>>& triangles, const std::vector<Vec3>& x)
    : perRing(perRing), triangles(triangles), x(x), normals(x.size(), Vec3::Zero())
{
	for (const auto& t : triangles) {
		const Vec3 first = x[t[1]] - x[t[0]], second = x[t[2]] - x[t[0]], area = first.cross(second);
		for (int corner : t) normals[corner] += area;
		longest = std::max({longest, first.squaredNorm(), second.squaredNorm(), (second - first).squaredNorm()});
	}
	for (Vec3& n : normals) n /= std::max(n.norm(), std::numeric_limits<double>::min());
	for (const Vec3& p : x)
		for (int a = 0; a < 2; ++a) axis[a] += p[a] / x.size();
	std::vector<double> away;
	for (size_t start = 0; start + perRing <= x.size(); start += perRing) {
		Ring ring{inf, -inf};
		double least = inf;
		for (int i = 0; i < perRing; ++i) {
			const Vec3& p = x[start + i];
			ring = {std::min(ring.low, p[2]), std::max(ring.high, p[2])};
			least = std::min(least, square(p[0] - axis[0]) + square(p[1] - axis[1]));
		}
		rings.push_back(ring);
		away.push_back(least);
	}
	for (size_t k = 0; k + 1 < rings.size(); ++k)
		bands.push_back(
		        {std::min(rings[k].low, rings[k + 1].low), std::max(rings[k].high, rings[k + 1].high), std::min(away[k], away[k + 1]) - longest / 2});
}

bool TubeInside::nearAxis(const Vec3& point) const
{
	double free = inf;
	for (const Band& band : bands)
		if (band.low <= point[2] && point[2] <= band.high) free = std::min(free, band.free);
	return free < inf && square(point[0] - axis[0]) + square(point[1] - axis[1]) < free;
}

int TubeInside::nearest(const Vec3& point) const
{
	const auto gap = [&](const Ring& ring) { return std::max({0., ring.low - point[2], point[2] - ring.high}); };
	int found = 0;
	double least = inf;
	const auto look = [&](size_t k) {
		if (square(gap(rings[k])) >= least) return;
		for (int i = 0; i < perRing; ++i) {
			const int p = static_cast<int>(k) * perRing + i;
			const double distance = (x[p] - point).squaredNorm();
			if (distance < least) found = p, least = distance;
		}
	};
	// the ring at the point's height first, so that most others are passed over
	const auto level = std::min_element(rings.begin(), rings.end(), [&](const Ring& a, const Ring& b) { return gap(a) < gap(b); });
	look(level - rings.begin());
	for (size_t k = 0; k < rings.size(); ++k) look(k);
	return found;
}

bool TubeInside::bySolidAngle(const Vec3& point) const
{
	double sum = 0;
	for (const auto& t : triangles) sum += solidAngle(x[t[0]] - point, x[t[1]] - point, x[t[2]] - point);
	const int last = static_cast<int>(x.size()) - perRing;
	Vec3 lower = Vec3::Zero(), upper = Vec3::Zero();
	for (int i = 0; i < perRing; ++i) lower += x[i] / perRing, upper += x[last + i] / perRing;
	for (int i = 0; i < perRing; ++i) {
		const int after = (i + 1) % perRing;
		sum += solidAngle(x[after] - point, x[i] - point, lower - point);
		sum += solidAngle(x[last + i] - point, x[last + after] - point, upper - point);
	}
	return sum > 2 * M_PI;
}

bool TubeInside::inside(const Vec3& point) const
{
	if (nearAxis(point)) return true;
	const int beside = nearest(point);
	return (point - x[beside]).dot(normals[beside]) < -0.5 * std::sqrt(longest) || bySolidAngle(point);
}

} // namespace hexmembrane
