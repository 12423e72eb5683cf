// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/membrane/RadialForce.hpp"

#include <algorithm>
#include <cmath>

namespace hexmembrane {

namespace {

/// Of ring k with particles at(i).
template <typename At>
RingShape shapeOf(int perRing, const At& at)
{
	RingShape shape{Vec3::Zero(), 0};
	for (int i = 0; i < perRing; ++i) shape.centre += at(i);
	shape.centre /= perRing;
	for (int i = 0; i < perRing; ++i) shape.radius += (at(i) - shape.centre).template head<2>().norm();
	shape.radius /= perRing;
	return shape;
}

template <typename Positions>
double areaOf(const HexStencil& tube, const Positions& x, int k, double sphereRadius, AreaRule rule)
{
	if (rule == AreaRule::cube) return 4 * sphereRadius * sphereRadius;
	const int below = std::max(k - 1, 0), above = std::min(k + 1, tube.rings - 1);
	const double height = (ringShape(tube, x, above).centre[2] - ringShape(tube, x, below).centre[2]) / (above - below);
	const double inner = ringShape(tube, x, k).radius - sphereRadius;
	return std::abs(height) * 2 * M_PI * std::max(inner, 0.) / tube.perRing;
}

} // namespace

RingShape ringShape(const HexStencil& tube, const std::vector<Vec3>& x, int k)
{
	return shapeOf(tube.perRing, [&](int i) { return x[k * tube.perRing + i]; });
}

RingShape ringShape(const HexStencil& tube, const PaddedRings& x, int k)
{
	return shapeOf(tube.perRing, [&](int i) { return x.get(k, i); });
}

double particleArea(const HexStencil& tube, const std::vector<Vec3>& x, int k, double sphereRadius, AreaRule rule)
{
	return areaOf(tube, x, k, sphereRadius, rule);
}

double particleArea(const HexStencil& tube, const PaddedRings& x, int k, double sphereRadius, AreaRule rule) { return areaOf(tube, x, k, sphereRadius, rule); }

Vec3 towardAxis(const Vec3& x, const Vec3& centre)
{
	Vec3 arm(centre[0] - x[0], centre[1] - x[1], 0);
	const double length = arm.norm();
	return length > 0 ? Vec3(arm / length) : Vec3::Zero();
}

} // namespace hexmembrane
