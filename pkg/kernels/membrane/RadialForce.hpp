// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/membrane/PaddedRings.hpp"
#include "kernels/base/Vec3.hpp"

#include <vector>

namespace hexmembrane {

/// Area that a particle of group 2 stands for.
enum class AreaRule {
	tributary, ///< its share of the ring's present inner surface: 2 pi (r - R)/n times half the distance of the two neighbouring rings
	cube       ///< the source study's (2R)^2, a cube round the sphere: 15.47 % more than the flat lattice's tributary area 2 sqrt(3) R^2
};

/// Present shape of a ring: centroid of its particles and their mean distance from the vertical axis through it (m).
struct RingShape {
	Vec3 centre;
	double radius;
};

/// Shape of ring k of the tube with particle positions x.
RingShape ringShape(const HexStencil& tube, const std::vector<Vec3>& x, int k);
RingShape ringShape(const HexStencil& tube, const PaddedRings& x, int k);

/// Area (m2) of one particle of ring k by the rule. \param sphereRadius R (m)
double particleArea(const HexStencil& tube, const std::vector<Vec3>& x, int k, double sphereRadius, AreaRule rule);
double particleArea(const HexStencil& tube, const PaddedRings& x, int k, double sphereRadius, AreaRule rule);

/// Unit vector from x to the vertical axis through `centre`; zero on the axis.
Vec3 towardAxis(const Vec3& x, const Vec3& centre);

} // namespace hexmembrane
