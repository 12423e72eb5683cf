// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/contact/ContactLaw.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

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

/// What contacts of two materials have of their own, as PFC's contact model assignment table gives it to a pair of groups; NaN: what the two bodies bring.
/// Stiffness is that of the contact itself, kn and ks or emod and kratio. Nothing is checked here.
struct PairProperties {
	double kn = std::numeric_limits<double>::quiet_NaN();              ///< normal stiffness of the contact (N/m)
	double ks = std::numeric_limits<double>::quiet_NaN();              ///< shear stiffness of it (N/m)
	double emod = std::numeric_limits<double>::quiet_NaN();            ///< PFC's effective modulus (Pa)
	double kratio = std::numeric_limits<double>::quiet_NaN();          ///< kn/ks
	double friction = std::numeric_limits<double>::quiet_NaN();        ///< coefficient mu
	double rollingFriction = std::numeric_limits<double>::quiet_NaN(); ///< coefficient mu_r
	static constexpr int numbers = 6;

	bool operator==(const PairProperties& o) const
	{
		const auto same = [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); };
		return same(kn, o.kn) && same(ks, o.ks) && same(emod, o.emod) && same(kratio, o.kratio) && same(friction, o.friction) &&
		       same(rollingFriction, o.rollingFriction);
	}
};

/// Two materials as they act in contacts with each other.
struct MaterialPair {
	ContactMaterial a, b;
};

/// The two with what their contacts have of their own: each brings what gives just that by the rules below, twice a direct stiffness for its spring in series.
inline MaterialPair paired(ContactMaterial a, ContactMaterial b, const PairProperties& own)
{
	for (ContactMaterial* one : {&a, &b}) {
		if (!std::isnan(own.kn) || !std::isnan(own.emod))
			std::tie(one->kn, one->ks, one->emod, one->kratio) = std::make_tuple(2 * own.kn, 2 * own.ks, own.emod, own.kratio);
		if (!std::isnan(own.friction)) one->friction = own.friction;
		if (!std::isnan(own.rollingFriction)) one->rollingFriction = own.rollingFriction;
	}
	return {a, b};
}

/// Parameters of a pair of materials that do not depend on the bodies' sizes: they have few values in a scene.
template <class V>
struct PairKind {
	V friction, rollingFriction; ///< coefficients mu and mu_r (-)
};

/// The smaller friction of both.
inline PairKind<double> kindOf(const ContactMaterial& a, const ContactMaterial& b)
{
	return {std::min(a.friction, b.friction), std::min(a.rollingFriction, b.rollingFriction)};
}

/// Nothing but a normal force: no friction and no rolling resistance.
inline bool normalOnly(const PairKind<double>& kind) { return !(kind.friction > 0) && !(kind.rollingFriction > 0); }

/// Parameters of a pair of bodies that depend on their sizes.
template <class V>
struct PairSprings {
	V kn, ks;        ///< stiffnesses (N/m)
	V rollingRadius; ///< Rbar (m)
};

/// Springs in series of a contact of the given shape, see contactShape(), and rolling radius (m).
inline PairSprings<double> springsOfShape(const ContactMaterial& a, const ContactMaterial& b, double shape, double rollingRadius)
{
	const Springs springs = inSeries(a.springs(shape), b.springs(shape));
	return {springs.kn, springs.ks, rollingRadius};
}
/// Of two spheres of radii r1 and r2 (m).
inline PairSprings<double> sphereSprings(const ContactMaterial& a, const ContactMaterial& b, double r1, double r2)
{
	return springsOfShape(a, b, contactShape(r1, r2), rollingRadius(r1, r2));
}
/// Of a sphere of radius r (m) on a boundary.
inline PairSprings<double> boundarySprings(const ContactMaterial& a, const ContactMaterial& b, double r) { return springsOfShape(a, b, contactShape(r), r); }

/// The law of an unbonded contact: kr = ks Rbar^2, moment at most mu_r Rbar N.
template <class V>
HEXMEMBRANE_INLINE LinearLaw<V> lawOf(const PairSprings<V>& springs, const PairKind<V>& kind)
{
	return {springs.kn, springs.ks, kind.friction, springs.ks * springs.rollingRadius * springs.rollingRadius,
	        kind.rollingFriction * springs.rollingRadius};
}

/// Law of two spheres of radii r1 and r2 (m), without a bond.
inline ContactLaw sphereLaw(const ContactMaterial& a, const ContactMaterial& b, double r1, double r2)
{
	return {lawOf(sphereSprings(a, b, r1, r2), kindOf(a, b)), 0, 0};
}

/// Law of a sphere of radius r (m) on a boundary, without a bond.
inline ContactLaw boundaryLaw(const ContactMaterial& a, const ContactMaterial& b, double r) { return {lawOf(boundarySprings(a, b, r), kindOf(a, b)), 0, 0}; }

} // namespace hexmembrane
