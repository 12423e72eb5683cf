// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/base/Vec3.hpp"

#include <algorithm>
#include <cmath>

/* Linear contact laws of PFC (Itasca, PFC documentation, contact models "linear", "rrlinear", "linearcbond"), one contact and one step at a time.
 *
 * Signs: the unit normal n points from body 1 to body 2; overlap u > 0 in contact, < 0 across a gap; displacement, rotation and velocity are those of body 2
 * relative to body 1; normal force N (> 0 in compression), shear force and moment act on body 2, their opposites on body 1. SI units.
 *
 * Everything is first order in the step: what belongs to step i are positions x_i and velocities v_(i-1/2), whose product with dt is the displacement from
 * x_(i-1) to x_i. Forces that depend on a path are incremental; loads that a contact remembers turn with it by carried(). */
namespace hexmembrane {

/// pi min(R1,R2)^2/(R1+R2) (m): area over length of PFC's deformability method, kn = E* shape, for two spheres.
inline double contactShape(double r1, double r2)
{
	const double r = std::min(r1, r2);
	return M_PI * r * r / (r1 + r2);
}

/// The same for a sphere of radius r on a boundary (platen, wall): PFC takes area pi r^2 and length r, so pi r (m).
inline double contactShape(double r) { return M_PI * r; }

/// Rbar = R1 R2/(R1+R2) (m), the lever of rolling resistance of two spheres; on a flat or rigid boundary it is the sphere's radius.
inline double rollingRadius(double r1, double r2) { return r1 * r2 / (r1 + r2); }

/// Normal and shear stiffness (N/m).
struct Springs {
	double kn;
	double ks;
};

/// What one body brings to a contact by PFC's deformability: kn = 2 E* shape, ks = kn/kratio, so that two equal bodies in series give E* shape.
inline Springs springsByModulus(double emod, double kratio, double shape) { return {2 * emod * shape, 2 * emod * shape / kratio}; }

/// Two springs one after the other, k1 k2/(k1+k2); without any stiffness in one of them there is none. PFC's rule for kn and ks given by body.
inline Springs inSeries(const Springs& a, const Springs& b)
{
	const auto series = [](double x, double y) { return x > 0 && y > 0 ? x * y / (x + y) : 0; };
	return {series(a.kn, b.kn), series(a.ks, b.ks)};
}

/// Parameters of a contact. Nothing is checked: who makes contacts checks.
struct ContactLaw {
	double kn;              ///< normal stiffness (N/m), > 0
	double ks;              ///< shear stiffness (N/m), >= 0
	double friction;        ///< coefficient mu (-), >= 0
	double kr;              ///< rolling stiffness (N m/rad), >= 0; PFC: ks Rbar^2
	double rollingArm;      ///< mu_r Rbar (m), >= 0: limit of the moment over the normal force
	double tensileStrength; ///< of a bond (N), >= 0 or infinite; PFC: cb_tenf
	double shearStrength;   ///< of a bond (N), >= 0 or infinite; PFC: cb_shearf
};

/// How the two bodies of a contact moved.
struct ContactMotion {
	double overlap; ///< u (m) now
	Vec3 slide;     ///< displacement in the contact plane during the step (m)
	Vec3 bend;      ///< rotation about axes in the contact plane during the step (rad)
};

enum class BondBreak { none, tension, shear };

/// What a step brought, apart from the loads themselves. Works (J) are those of the trapezoid rule, by which leapfrog's kinetic energy
/// changes too: gain in elastic energy + works = sum of (load before + load after)/2 . displacement, to rounding, whatever the path.
struct ContactStep {
	double normal;     ///< N (N)
	bool open;         ///< nothing is transmitted any more, nothing is remembered
	BondBreak bond;    ///< what broke in this step
	double slipWork;   ///< dissipated by sliding, and what shear still held when the contact opened
	double rollWork;   ///< the same of rolling
	double bondEnergy; ///< elastic energy set free by the break of a bond
};

/// Velocity of body 2 relative to body 1 at the contact point; arms point from the centres to it (for spheres (R1-u/2) n and -(R2-u/2) n).
inline Vec3 relativeVelocity(const Vec3& velocity1, const Vec3& spin1, const Vec3& arm1, const Vec3& velocity2, const Vec3& spin2, const Vec3& arm2)
{
	return velocity2 + spin2.cross(arm2) - velocity1 - spin1.cross(arm1);
}

/// The part of v in the contact plane.
inline Vec3 acrossNormal(const Vec3& v, const Vec3& normal) { return v - normal.dot(v) * normal; }

/// How a contact turned during a step: rotation vectors (rad) of its normal and about its normal (mean spin of the two bodies).
struct ContactTurn {
	Vec3 tilt;
	Vec3 twist;
};

inline ContactTurn contactTurn(const Vec3& previousNormal, const Vec3& normal, const Vec3& spin1, const Vec3& spin2, double dt)
{
	return {previousNormal.cross(normal), 0.5 * dt * previousNormal.dot(spin1 + spin2) * previousNormal};
}

/// A remembered load turned with its contact, v + tilt x v, then v + twist x v. First order: a step that turns by the angle a makes the load longer by a^2/2 at
/// most and leaves a part a^2 of it along the normal. The same formula as YADE's ScGeom::rotate, so that a contact is the same in both tiers.
inline Vec3 carried(const Vec3& load, const ContactTurn& turn)
{
	const Vec3 tilted = load - load.cross(turn.tilt);
	return tilted - tilted.cross(turn.twist);
}

/// Work that a spring of this stiffness loses when its trial load is cut down to `kept` while the load was `before` at the start of the step:
/// (before+kept)/2 . (trial-kept)/stiffness, which is the work done on it by the trapezoid rule less its gain in elastic energy. PFC's definition.
inline double cutWork(const Vec3& before, const Vec3& trial, const Vec3& kept, double stiffness) { return 0.5 * (before + kept).dot(trial - kept) / stiffness; }

/// v, or v shortened to the length `limit` when it is longer.
inline Vec3 cutTo(const Vec3& v, double limit)
{
	const double square = v.squaredNorm();
	return square > limit * limit ? Vec3(limit / std::sqrt(square) * v) : v;
}

/// Elastic step of a load, then cut to the limit: load -> cutTo(load - stiffness displacement, limit). Returns the work dissipated (J).
inline double loadAndCut(Vec3& load, const Vec3& displacement, double stiffness, double limit)
{
	const Vec3 trial = load - stiffness * displacement;
	if (trial.squaredNorm() <= limit * limit) {
		load = trial;
		return 0;
	}
	const Vec3 kept = cutTo(trial, limit);
	const double work = cutWork(load, trial, kept, stiffness);
	load = kept;
	return work;
}

/// Elastic energy of a load, |load|^2/(2 stiffness) (J); nothing for a spring that is not there.
inline double springEnergy(double squaredLoad, double stiffness) { return stiffness > 0 ? 0.5 * squaredLoad / stiffness : 0; }

/// Elastic energy of a contact (J).
inline double contactEnergy(const ContactLaw& law, double normal, const Vec3& shear, const Vec3& moment)
{
	return springEnergy(normal * normal, law.kn) + springEnergy(shear.squaredNorm(), law.ks) + springEnergy(moment.squaredNorm(), law.kr);
}

/// PFC's two rules, tension first: tension above tensileStrength, shear force above shearStrength.
inline BondBreak bondBreak(const ContactLaw& law, double normal, const Vec3& shear)
{
	if (-normal > law.tensileStrength) return BondBreak::tension;
	return shear.squaredNorm() > law.shearStrength * law.shearStrength ? BondBreak::shear : BondBreak::none;
}

/// Step of a bonded contact: N = kn u of either sign, shear elastic without slip, no moment (what rolling left from before is let go). A break in tension takes
/// all forces; one in shear leaves them in compression, as far as friction holds (from then on the contact is an unbonded one), and takes them in tension.
inline ContactStep advanceBond(const ContactLaw& law, const ContactMotion& motion, Vec3& shear, Vec3& moment, bool& bonded)
{
	ContactStep step{law.kn * motion.overlap, false, BondBreak::none, 0, 0, 0};
	step.rollWork = springEnergy(moment.squaredNorm(), law.kr);
	moment = Vec3::Zero();
	shear -= law.ks * motion.slide;
	step.bond = bondBreak(law, step.normal, shear);
	if (step.bond == BondBreak::none) return step;
	bonded = false;
	step.bondEnergy = springEnergy(shear.squaredNorm(), law.ks);
	if (step.normal < 0) {
		step.bondEnergy += springEnergy(step.normal * step.normal, law.kn);
		step.normal = 0;
		step.open = true;
		shear = Vec3::Zero();
		return step;
	}
	shear = cutTo(shear, law.friction * step.normal);
	step.bondEnergy -= springEnergy(shear.squaredNorm(), law.ks);
	return step;
}

/// One step of a contact. `shear` (N) and `moment` (N m) come already carried() into the present contact plane and go out advanced; `bonded` is cleared when a
/// bond breaks. Not bonded:
///   N = kn u, no tension: u < 0 opens the contact
///   shear  -> shear - ks slide,   cut to mu N
///   moment -> moment - kr bend,   cut to mu_r Rbar N
/// `bend` is not looked at without rolling resistance, nor `slide` without shear stiffness.
inline ContactStep advanceContact(const ContactLaw& law, const ContactMotion& motion, Vec3& shear, Vec3& moment, bool& bonded)
{
	if (bonded) return advanceBond(law, motion, shear, moment, bonded);
	ContactStep step{law.kn * motion.overlap, false, BondBreak::none, 0, 0, 0};
	if (motion.overlap < 0) {
		step.normal = 0;
		step.open = true;
		step.slipWork = springEnergy(shear.squaredNorm(), law.ks);
		step.rollWork = springEnergy(moment.squaredNorm(), law.kr);
		shear = moment = Vec3::Zero();
		return step;
	}
	if (law.ks > 0) step.slipWork = loadAndCut(shear, motion.slide, law.ks, law.friction * step.normal);
	if (law.kr > 0) step.rollWork = loadAndCut(moment, motion.bend, law.kr, law.rollingArm * step.normal);
	return step;
}

} // namespace hexmembrane
