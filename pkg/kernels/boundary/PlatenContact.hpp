// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/boundary/BoundaryShape.hpp"

#include <cmath>

namespace hexmembrane {

/// A solid cylinder with flat ends: centre of the solid (m), unit vector along its axis, radius (m), half of its height (m). A rotation about the axis does
/// not change it, so the axis is all that is kept of the orientation. Its sizes are taken as given: positive and finite, the axis a unit vector.
struct SolidCylinder {
	Vec3 centre;
	Vec3 axis;
	double radius;
	double halfHeight;
};

/// Which part of the cylinder's surface is nearest.
enum class PlatenRegion { face, side, rim };

/// Nearest point of the surface. `normal` is the unit vector out of the solid through that point, towards the point asked about when that is outside.
/// `distance` (m) is signed, negative inside the solid.
struct PlatenSurfacePoint {
	Vec3 point;
	Vec3 normal;
	double distance;
	PlatenRegion region;
};

/// Contact of the cylinder with a sphere. `normal` points from the cylinder to the sphere; `penetration` (m) is positive when they overlap, negative for
/// a gap; `point` lies on the line along the normal through the sphere's centre, half way through the overlap (or the gap).
struct PlatenContact {
	Vec3 normal;
	double penetration;
	Vec3 point;
	PlatenRegion region;
};

/// A unit vector at right angles to the unit vector `axis`, the same one for the same axis: the coordinate axis that is furthest from it, straightened.
inline Vec3 anyPerpendicular(const Vec3& axis)
{
	int least = 0;
	for (int i = 1; i < 3; i++)
		if (std::abs(axis[i]) < std::abs(axis[least])) least = i;
	const Vec3 straight = Vec3::Unit(least) - axis[least] * axis;
	return straight / straight.norm();
}

/// Closest point of the cylinder's surface to the point x. With z the coordinate of x along the axis, rho the distance from it, R the radius, H the half
/// height, a = rho - R and b = |z| - H:
///   a <= 0, b > 0            face   distance b
///   a > 0,  b <= 0           side   distance a
///   a > 0,  b > 0            rim    distance sqrt(a^2 + b^2)
///   a <= 0, b <= 0 (inside)  face or side, whichever is nearer: distance max(a, b)
/// The distance is continuous everywhere and, outside the solid, the normal is so too. Inside, the normal jumps where two surfaces are equally near, and
/// the choice there is fixed: face before side, the end of positive z before the other, and on the axis anyPerpendicular().
inline PlatenSurfacePoint closestOnPlaten(const SolidCylinder& solid, const Vec3& x)
{
	const Vec3 arm = x - solid.centre;
	const double z = arm.dot(solid.axis);
	const Vec3 radial = arm - z * solid.axis;
	const double rho = radial.norm();
	const double a = rho - solid.radius;
	const double b = std::abs(z) - solid.halfHeight;
	const Vec3 end = z >= 0 ? solid.axis : Vec3(-solid.axis);

	if (a <= 0 && (b > 0 || b >= a)) return {x - b * end, end, b, PlatenRegion::face};
	const Vec3 outward = rho > 0 ? Vec3(radial / rho) : anyPerpendicular(solid.axis);
	if (b <= 0) return {x - a * outward, outward, a, PlatenRegion::side};
	const double distance = std::sqrt(a * a + b * b);
	const Vec3 normal = (a * outward + b * end) / distance;
	return {x - distance * normal, normal, distance, PlatenRegion::rim};
}

/// Contact with the sphere of radius `sphereRadius` (m) at x: penetration = sphereRadius - distance, see closestOnPlaten(). A sphere whose centre has
/// gone into the solid is pushed out through the nearest surface.
inline PlatenContact platenContact(const SolidCylinder& solid, const Vec3& x, double sphereRadius)
{
	const PlatenSurfacePoint nearest = closestOnPlaten(solid, x);
	const double penetration = sphereRadius - nearest.distance;
	return {nearest.normal, penetration, x - (sphereRadius - 0.5 * penetration) * nearest.normal, nearest.region};
}

/// Half edges (m) of the smallest box with edges along x, y, z that holds the cylinder: R sqrt(1 - a_i^2) + H |a_i| for the axis a.
inline Vec3 platenHalfExtent(const SolidCylinder& solid)
{
	Vec3 half;
	for (int i = 0; i < 3; i++) {
		const double along = std::abs(solid.axis[i]);
		// 1 - a^2 as a product: exact zero for an axis along i, never negative by rounding beyond it.
		const double across = std::sqrt(std::fmax(0., (1 - along) * (1 + along)));
		half[i] = solid.radius * across + solid.halfHeight * along;
	}
	return half;
}

/// A platen as a boundary of the compact tier.
struct PlatenBoundary {
	SolidCylinder solid;

	BoundaryTouch touch(const Place& sphere) const
	{
		const PlatenContact found = platenContact(solid, sphere.centre, sphere.radius);
		return {found.penetration, found.normal, found.point};
	}
	bool near(const Place& sphere, double gap) const { return platenContact(solid, sphere.centre, sphere.radius + gap).penetration >= 0; }
	/// Way of the centre, and of the rim as the axis tilts and sizes change.
	double wayFrom(const PlatenBoundary& then) const
	{
		return (solid.centre - then.solid.centre).norm() + (solid.axis - then.solid.axis).norm() * std::hypot(solid.radius, solid.halfHeight) +
		       std::abs(solid.radius - then.solid.radius) + std::abs(solid.halfHeight - then.solid.halfHeight);
	}
};

} // namespace hexmembrane
