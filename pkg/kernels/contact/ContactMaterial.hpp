// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/contact/ContactLaw.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hexmembrane {

/// What a body brings to its contacts. Stiffness either as emod and kratio or as kn and ks, the other two NaN; nothing is checked here.
struct ContactMaterial {
	double kn = std::numeric_limits<double>::quiet_NaN();     ///< normal stiffness of the body's own spring (N/m)
	double ks = std::numeric_limits<double>::quiet_NaN();     ///< shear stiffness of it (N/m)
	double emod = std::numeric_limits<double>::quiet_NaN();   ///< PFC's effective modulus (Pa)
	double kratio = std::numeric_limits<double>::quiet_NaN(); ///< kn/ks
	double friction = 0;                                      ///< coefficient mu
	double rollingFriction = 0;                               ///< coefficient mu_r

	/// The body's spring in a contact of this shape (m), see contactShape().
	Springs springs(double shape) const { return std::isnan(emod) ? Springs{kn, ks} : springsByModulus(emod, kratio, shape); }
	bool operator==(const ContactMaterial& o) const
	{
		const auto same = [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); };
		return same(kn, o.kn) && same(ks, o.ks) && same(emod, o.emod) && same(kratio, o.kratio) && friction == o.friction &&
		       rollingFriction == o.rollingFriction;
	}
};

/// Law of a contact of the given shape and lever Rbar (m): springs in series, the smaller friction of both, kr = ks Rbar^2 where there is rolling friction.
/// No bond.
inline ContactLaw lawOfShape(const ContactMaterial& a, const ContactMaterial& b, double shape, double lever)
{
	const Springs springs = inSeries(a.springs(shape), b.springs(shape));
	const double arm = std::min(a.rollingFriction, b.rollingFriction) * lever;
	return {springs.kn, springs.ks, std::min(a.friction, b.friction), arm > 0 ? springs.ks * lever * lever : 0, arm, 0, 0};
}

/// Of two spheres of radii r1 and r2 (m).
inline ContactLaw sphereLaw(const ContactMaterial& a, const ContactMaterial& b, double r1, double r2)
{
	return lawOfShape(a, b, contactShape(r1, r2), rollingRadius(r1, r2));
}

/// Of a sphere of radius r (m) on a boundary.
inline ContactLaw boundaryLaw(const ContactMaterial& a, const ContactMaterial& b, double r) { return lawOfShape(a, b, contactShape(r), r); }

/// Nothing but a normal force: no friction and no rolling resistance.
inline bool normalOnly(const ContactLaw& law) { return !(law.friction > 0) && !(law.rollingArm > 0); }

} // namespace hexmembrane
