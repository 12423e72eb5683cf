// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "RadialForce.hpp"

#include "Check.hpp"

#include <algorithm>
#include <cmath>

namespace hexmembrane {

AreaRule areaRuleFromName(const std::string& name)
{
	if (name == "tributary") return AreaRule::tributary;
	if (name == "cube") return AreaRule::cube;
	reject("MembraneRadialServo.areaRule", "'" + name + "'", "unknown", "'tributary' or 'cube'");
}

RingShape ringShape(const HexStencil& tube, const std::vector<Vec3>& x, int k)
{
	const Vec3* first = x.data() + k * tube.perRing;
	RingShape shape{Vec3::Zero(), 0};
	for (int i = 0; i < tube.perRing; ++i) shape.centre += first[i];
	shape.centre /= tube.perRing;
	for (int i = 0; i < tube.perRing; ++i) shape.radius += (first[i] - shape.centre).head<2>().norm();
	shape.radius /= tube.perRing;
	return shape;
}

double particleArea(const HexStencil& tube, const std::vector<Vec3>& x, int k, double sphereRadius, AreaRule rule)
{
	if (rule == AreaRule::cube) return 4 * sphereRadius * sphereRadius;
	const int below = std::max(k - 1, 0), above = std::min(k + 1, tube.rings - 1);
	const double height = (ringShape(tube, x, above).centre[2] - ringShape(tube, x, below).centre[2]) / (above - below);
	const double inner = ringShape(tube, x, k).radius - sphereRadius;
	return std::abs(height) * 2 * M_PI * std::max(inner, 0.) / tube.perRing;
}

Vec3 towardAxis(const Vec3& x, const Vec3& centre)
{
	Vec3 arm(centre[0] - x[0], centre[1] - x[1], 0);
	const double length = arm.norm();
	return length > 0 ? Vec3(arm / length) : Vec3::Zero();
}

} // namespace hexmembrane
