// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/boundary/BoundaryShape.hpp"

#include <cmath>

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

/// The inside of an upright cylinder with two ends, as a boundary of either tier: a sphere beyond an end, or on the axis, meets nothing.
struct CylinderBoundary {
	Vec3 centre;
	double radius, halfHeight; ///< (m)

	BoundaryTouch touch(const Place& sphere) const
	{
		const CylinderContact found = cylinderContact(centre, radius, sphere.centre, sphere.radius);
		const bool beside = std::abs(sphere.centre[2] - centre[2]) <= halfHeight && found.normal != Vec3::Zero();
		return {beside ? found.penetration : -sphere.radius, found.normal, found.point};
	}
	bool near(const Place& sphere, double gap) const
	{
		return cylinderContact(centre, radius, sphere.centre, sphere.radius + gap).penetration >= 0 &&
		       std::abs(sphere.centre[2] - centre[2]) <= halfHeight + gap;
	}
	double wayFrom(const CylinderBoundary& then) const
	{
		return (centre - then.centre).norm() + std::abs(radius - then.radius) + std::abs(halfHeight - then.halfHeight);
	}
};

} // namespace hexmembrane
