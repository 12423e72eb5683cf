// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/contact/ContactLaw.hpp"

/* The bond of PFC's contact model "linearpbond": a disc of cement between two spheres, on the contact plane and centred at the contact point, as elastic springs
 * spread evenly over it. It acts beside the contact, across a gap too, and neither knows of the other. Signs as in ContactLaw.hpp. SI units.
 *
 * Loads grow with what moves after the bond was made; those in the contact plane turn with it by carried(). */
namespace hexmembrane {

/// A bond as it was made.
template <class V>
struct ParallelBond {
	V radius; ///< R of the disc (m), > 0; PFC: pb_rmul min(R1, R2)
	V kn;     ///< normal stiffness by area (N/m3), > 0; PFC: pb_kn
	V ks;     ///< shear stiffness by area (N/m3), >= 0; PFC: pb_ks
	V rest;   ///< distance of the centres at which it has no normal force (m)

	HEXMEMBRANE_INLINE V area() const { return M_PI * radius * radius; }
	/// Second moment of the area about a diameter (m4); the polar one, J, is twice it.
	HEXMEMBRANE_INLINE V inertia() const { return 0.25 * radius * radius * area(); }
};

/// Strengths of bonds, and how far moments count in them.
struct ParallelStrength {
	double tension;      ///< tensile strength (Pa), >= 0 or infinite; PFC: pb_ten
	double cohesion;     ///< shear strength without normal stress (Pa), >= 0 or infinite; PFC: pb_coh
	double friction;     ///< tan of the bond's friction angle (-), >= 0; PFC: tan pb_fa
	double momentFactor; ///< share of the moments in the stresses (-), 0 to 1; PFC: pb_mcf
};

/// What a bond does to body 2, and the normal that these loads belong to.
template <class V>
struct ParallelLoads {
	V normal;          ///< N (N), > 0 in compression
	V twist;           ///< moment about the normal (N m)
	Vector<V> shear;   ///< force in the contact plane (N)
	Vector<V> bending; ///< moment in the contact plane (N m)
	Vector<V> axis;    ///< unit normal
};

/// The largest stresses in the disc, at its edge (Pa), tension positive, and the mean normal stress.
template <class V>
struct ParallelStress {
	V tension, shear, mean;
};

template <class V>
HEXMEMBRANE_INLINE ParallelStress<V> stressOf(const ParallelBond<V>& bond, const ParallelLoads<V>& loads, double momentFactor)
{
	const V perArea = 1 / bond.area(), perModulus = momentFactor * bond.radius / bond.inertia(), mean = -perArea * loads.normal;
	const V twist = loads.twist < 0 ? -loads.twist : loads.twist;
	return {mean + perModulus * squareRoot(dot(loads.bending, loads.bending)),
	        perArea * squareRoot(dot(loads.shear, loads.shear)) + 0.5 * perModulus * twist, mean};
}

/// Shear strength (Pa) under a mean normal stress, tension positive.
template <class V>
HEXMEMBRANE_INLINE V shearStrength(const ParallelStrength& strength, V mean)
{
	return strength.cohesion - strength.friction * mean;
}

/// Which strength is exceeded, tension first.
inline BondBreak bondBreak(const ParallelStrength& strength, const ParallelStress<double>& stress)
{
	if (stress.tension > strength.tension) return BondBreak::tension;
	return stress.shear > shearStrength(strength, stress.mean) ? BondBreak::shear : BondBreak::none;
}

/// Elastic energy of a bond (J).
inline double bondEnergy(const ParallelBond<double>& bond, const ParallelLoads<double>& loads)
{
	const double area = bond.area(), inertia = bond.inertia();
	return springEnergy(loads.normal * loads.normal, bond.kn * area) + springEnergy(loads.shear.squaredNorm(), bond.ks * area) +
	       springEnergy(loads.bending.squaredNorm(), bond.kn * inertia) + springEnergy(loads.twist * loads.twist, 2 * bond.ks * inertia);
}

/// One elastic step: loads turn with the contact plane, then
///   N = kn A (rest - distance)     Fs -> Fs - ks A slide     Mb -> Mb - kn I bend     Mt -> Mt - ks J twist
/// \param distance of the centres now (m) \param normal now \param motion of the bodies in the step, the velocity that of the contact point
template <class V>
HEXMEMBRANE_INLINE void advanceParallel(const ParallelBond<V>& bond, V distance, const Vector<V>& normal, const PairMotion<V>& motion, V dt,
                                        ParallelLoads<V>& loads)
{
	const V area = bond.area(), inertia = bond.inertia(), spin = dot(motion.spinDifference, normal);
	const Vector<V> tilt = cross(loads.axis, normal), twist = (0.5 * dt * dot(loads.axis, motion.spinSum)) * loads.axis;
	loads.shear = carried(loads.shear, tilt, twist) - (dt * bond.ks * area) * acrossNormal(motion.velocity, normal);
	loads.bending = carried(loads.bending, tilt, twist) - (dt * bond.kn * inertia) * (motion.spinDifference - spin * normal);
	loads.twist = loads.twist - 2 * dt * bond.ks * inertia * spin;
	loads.normal = bond.kn * area * (bond.rest - distance);
	loads.axis = normal;
}

} // namespace hexmembrane
