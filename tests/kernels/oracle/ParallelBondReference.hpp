// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/base/Vec3.hpp"

#include <cmath>
#include <vector>

/* The oracle of ParallelBond.hpp: the disc as what it stands for, many small springs that are spread over it. They are summed one by one; no second moment of
 * an area is in it. */
namespace hexmembrane {
namespace reference {

/// A disc of radius R (m) about the contact point, across the unit normal n, between a rigid body 1 that stands and a rigid body 2 that is displaced.
struct SpringDisc {
	double radius, kn, ks; ///< stiffness by area (N/m3)
	Vec3 normal;

	struct Result {
		Vec3 force, moment;      ///< on body 2, about the contact point (N, N m)
		double tension = -1e300; ///< largest normal stress at the edge, tension positive (Pa)
		double energy = 0;       ///< of all springs (J)
	};
	/// \param displacement of body 2 at the contact point (m) \param turn its rotation (rad), small
	Result displaced(const Vec3& displacement, const Vec3& turn) const
	{
		const Vec3 e1 = normal.unitOrthogonal(), e2 = normal.cross(e1);
		Result sum{Vec3::Zero(), Vec3::Zero()};
		const auto spring = [&](double r, double angle) {
			const Vec3 arm = r * (std::cos(angle) * e1 + std::sin(angle) * e2), way = displacement + turn.cross(arm);
			const double along = way.dot(normal);
			return std::make_pair(arm, Vec3(-kn * along * normal - ks * (way - along * normal)));
		};
		// Gauss's rule along the radius, equal steps round the circle: exact for what is summed here
		const double root = std::sqrt(0.6), points[] = {0.5 * (1 - root), 0.5, 0.5 * (1 + root)}, weights[] = {5. / 18, 8. / 18, 5. / 18};
		constexpr int around = 16;
		for (int p = 0; p < 3; ++p)
			for (int a = 0; a < around; ++a) {
				const double r = radius * points[p], angle = 2 * M_PI * a / around, area = weights[p] * radius * r * 2 * M_PI / around;
				const auto [arm, stress] = spring(r, angle);
				sum.force += area * stress;
				sum.moment += area * arm.cross(stress);
				sum.energy -= 0.5 * area * stress.dot(displacement + turn.cross(arm));
			}
		for (int a = 0; a < 10000; ++a) sum.tension = std::max(sum.tension, -spring(radius, 2 * M_PI * a / 10000).second.dot(normal));
		return sum;
	}
};

} // namespace reference
} // namespace hexmembrane
