// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/base/Vec3.hpp"

namespace hexmembrane {

/// Contact of a sphere with the inside of an upright cylinder.
struct CylinderContact {
	double penetration; ///< overlap (m), negative: distance
	Vec3 normal;        ///< unit vector from the wall to the sphere, horizontal, towards the axis; zero for a centre on the axis
	Vec3 point;         ///< half way through the overlap
};

/// \param axis any point of the vertical axis \param wallRadius radius of the inside (m)
inline CylinderContact cylinderContact(const Vec3& axis, double wallRadius, const Vec3& centre, double sphereRadius)
{
	const Vec3 arm(centre[0] - axis[0], centre[1] - axis[1], 0);
	const double distance = arm.norm();
	const Vec3 outward = distance > 0 ? Vec3(arm / distance) : Vec3::Zero();
	const double penetration = distance + sphereRadius - wallRadius;
	return {penetration, -outward, centre + (sphereRadius - 0.5 * penetration) * outward};
}

} // namespace hexmembrane
