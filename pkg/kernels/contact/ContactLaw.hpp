// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/base/Lanes.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

/* Linear contact laws of PFC (Itasca, PFC documentation, contact models "linear", "rrlinear", "linearcbond"), one step at a time. What
 * has a parameter V is written once for one contact (V = double) and for several (V = Lanes): YADE's law, the sweeps of the compact tier and the packer use it.
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

/// Parameters of an unbonded contact. Nothing is checked: who makes contacts checks.
template <class V>
struct LinearLaw {
	V kn;         ///< normal stiffness (N/m), > 0
	V ks;         ///< shear stiffness (N/m), >= 0
	V friction;   ///< coefficient mu (-), >= 0
	V kr;         ///< rolling stiffness (N m/rad), >= 0; PFC: ks Rbar^2
	V rollingArm; ///< mu_r Rbar (m), >= 0: limit of the moment over the normal force
};

/// The same of one contact, with the strengths of its bond.
struct ContactLaw : LinearLaw<double> {
	double tensileStrength; ///< of a bond (N), >= 0 or infinite; PFC: cb_tenf
	double shearStrength;   ///< of a bond (N), >= 0 or infinite; PFC: cb_shearf
};

/// What a contact remembers from step to step.
template <class V>
struct ContactMemory {
	Vector<V> shear;  ///< shear force on body 2 (N)
	Vector<V> moment; ///< bending moment on it (N m)
	Vector<V> normal; ///< of the last step
	/// Names of the members above, in their order: what a saved state is read by.
	static constexpr const char* fields = "shear moment normal";

	/// Calls visit(load) for each load that turns with the contact plane.
	template <class Visit>
	HEXMEMBRANE_INLINE void forEachTurning(Visit&& visit)
	{
		visit(shear);
		visit(moment);
	}
	/// The same seen from the other body.
	ContactMemory swapped() const { return {-shear, -moment, -normal}; }
};
inline ContactMemory<double> noMemory() { return {Vec3::Zero(), Vec3::Zero(), Vec3::Zero()}; }

/// The moment that the contact transmits besides those of its forces, on body 2 (N m).
template <class V>
HEXMEMBRANE_INLINE Vector<V> momentOf(const ContactMemory<V>& memory)
{
	return memory.moment;
}

/// How the two bodies of a contact moved.
template <class V>
struct ContactMotion {
	V overlap;       ///< u (m) now
	Vector<V> slide; ///< displacement in the contact plane during the step (m)
	Vector<V> bend;  ///< rotation about axes in the contact plane during the step (rad)
};

/// The same from the spin of body 2 against body 1 (rad/s) and the present normal.
template <class V>
HEXMEMBRANE_INLINE ContactMotion<V> contactMotion(V overlap, const Vector<V>& slide, const Vector<V>& spinDifference, const Vector<V>& normal, V dt)
{
	return {overlap, slide, dt * acrossNormal(spinDifference, normal)};
}

enum class BondBreak { none, tension, shear };

/// Energies (J) that left the contacts: by sliding, by rolling, by breaking bonds. Those of sliding and rolling are by the trapezoidal rule, by which leapfrog's
/// kinetic energy changes too: gain in elastic energy + works = sum of (load before + load after)/2 . displacement, to rounding, whatever the path.
struct ContactWorks {
	double slip = 0; ///< dissipated by sliding, and what shear still held when the contact opened
	double roll = 0; ///< the same of rolling
	double bond = 0; ///< elastic energy set free by the break of a bond

	/// Calls visit(name, value) for each; the names are those of YADE's energies.
	template <class Self, class Visit>
	static void forEach(Self& works, Visit&& visit)
	{
		visit("plastDissip", works.slip);
		visit("rollDissip", works.roll);
		visit("bondDissip", works.bond);
	}
	ContactWorks& operator+=(const ContactWorks& o)
	{
		slip += o.slip;
		roll += o.roll;
		bond += o.bond;
		return *this;
	}
};

/// What a step brought, apart from shear force and moment themselves.
struct ContactStep {
	double normal;  ///< N (N)
	bool open;      ///< nothing is transmitted any more, nothing is remembered
	BondBreak bond; ///< what broke in this step
	ContactWorks works;
};

/// Velocity of body 2 relative to body 1 at the contact point; arms point from the centres to it (for spheres (R1-u/2) n and -(R2-u/2) n).
inline Vec3 relativeVelocity(const Vec3& velocity1, const Vec3& spin1, const Vec3& arm1, const Vec3& velocity2, const Vec3& spin2, const Vec3& arm2)
{
	return velocity2 + spin2.cross(arm2) - velocity1 - spin1.cross(arm1);
}

/// A remembered load turned with its contact, v + tilt x v, then v + twist x v: `tilt` is the rotation of the normal (rad), previous normal x normal, `twist` that
/// about the previous normal, by the mean spin of the two bodies. First order: a step that turns by the angle a makes the load longer by a^2/2 at most and leaves
/// a part a^2 of it along the normal. The same formula as YADE's ScGeom::rotate, so that a contact is the same in both tiers.
template <class W>
HEXMEMBRANE_INLINE W carried(const W& load, const W& tilt, const W& twist)
{
	const W tilted = load - cross(load, tilt);
	return tilted - cross(tilted, twist);
}

/// v, or v shortened to the length `limit` when it is longer.
inline Vec3 cutTo(const Vec3& v, double limit)
{
	const double square = v.squaredNorm();
	return square > limit * limit ? Vec3(limit / std::sqrt(square) * v) : v;
}

/// Elastic energy of a load, |load|^2/(2 stiffness) (J); nothing for a spring that is not there.
inline double springEnergy(double squaredLoad, double stiffness) { return stiffness > 0 ? 0.5 * squaredLoad / stiffness : 0; }

/// Elastic energy of a contact (J).
inline double contactEnergy(const ContactLaw& law, double normal, const ContactMemory<double>& memory)
{
	return springEnergy(normal * normal, law.kn) + springEnergy(memory.shear.squaredNorm(), law.ks) + springEnergy(memory.moment.squaredNorm(), law.kr);
}

/// Whether the step of an unbonded contact depends on how its bodies turn, apart from the slide that this makes.
inline bool feelsSpin(const ContactLaw& law) { return law.kr > 0; }

/// Springs of normal and shear alone.
inline LinearLaw<double> springsAlone(double kn, double ks) { return {kn, ks, 0, 0, 0}; }

/// Moment by which the springs of a contact that sticks answer a rotation of body 2 against body 1 (N m), on body 1.
inline Vec3 answerTo(const Vec3& turn, const LinearLaw<double>& law, const Vec3& normal) { return law.kr * acrossNormal(turn, normal); }

/// The springs of a contact that sticks, as the critical time step counts them: one that friction can hold nothing of is none.
inline LinearLaw<double> stickingSprings(const ContactLaw& law)
{
	return {law.kn, law.friction > 0 ? law.ks : 0, law.friction, law.rollingArm > 0 ? law.kr : 0, law.rollingArm};
}

/// PFC's two rules, tension first: tension above tensileStrength, shear force above shearStrength.
inline BondBreak bondBreak(const ContactLaw& law, double normal, const Vec3& shear)
{
	if (-normal > law.tensileStrength) return BondBreak::tension;
	return shear.squaredNorm() > law.shearStrength * law.shearStrength ? BondBreak::shear : BondBreak::none;
}

/// Step of a bonded contact: N = kn u of either sign, shear elastic without slip, no moment (what rolling left from before is let go). A break in tension takes
/// all forces; one in shear leaves them in compression, as far as friction holds (from then on the contact is an unbonded one), and takes them in tension.
inline ContactStep advanceBond(const ContactLaw& law, const ContactMotion<double>& motion, ContactMemory<double>& memory, bool& bonded)
{
	Vec3 &shear = memory.shear, &moment = memory.moment;
	ContactStep step{law.kn * motion.overlap, false, BondBreak::none, {}};
	step.works.roll = springEnergy(moment.squaredNorm(), law.kr);
	moment = Vec3::Zero();
	shear -= law.ks * motion.slide;
	step.bond = bondBreak(law, step.normal, shear);
	if (step.bond == BondBreak::none) return step;
	bonded = false;
	step.works.bond = springEnergy(shear.squaredNorm(), law.ks);
	if (step.normal < 0) {
		step.works.bond += springEnergy(step.normal * step.normal, law.kn);
		step.normal = 0;
		step.open = true;
		shear = Vec3::Zero();
		return step;
	}
	shear = cutTo(shear, law.friction * step.normal);
	step.works.bond -= springEnergy(shear.squaredNorm(), law.ks);
	return step;
}

/// A step of the spring of shear or of rolling, first half: the trial load, and whether it is above its limit.
template <class V>
struct SpringTrial {
	Vector<V> before, trial;
	V square, limit;
	Mask<V> open, cut;

	HEXMEMBRANE_INLINE SpringTrial(const Vector<V>& load, const Vector<V>& displacement, V stiffness, V most, Mask<V> opened)
	    : before(load), trial(load - stiffness * displacement), square(dot(trial, trial)), limit(most), open(opened), cut(square > most * most)
	{
	}
	/// The second half. A contact that opens holds nothing. \param perSize 1/|trial| \param perStiffness 1/stiffness; of no consequence for a spring without load
	/// \return work dissipated, (before + kept)/2 . (trial - kept)/stiffness: what is done on the spring by the trapezoidal rule less its gain in elastic
	/// energy (PFC's definition); of one that opens, what it held.
	HEXMEMBRANE_INLINE V keep(V perSize, V perStiffness, Vector<V>& load) const
	{
		const V nothing = constant<V>(0), share = open ? nothing : (cut ? limit * perSize : constant<V>(1));
		load = share * trial;
		const Vector<V> sum = before + load, lost = trial - load;
		return 0.5 * perStiffness * (open ? dot(before, before) : (cut ? dot(sum, lost) : nothing));
	}
	/// Of one contact: trial and limit are all there is to it.
	bool elastic() const { return !cut && (!open || square == 0); }
};

/// 1/a and 1/b by one quotient: it takes as long as ten products. Both are taken as 1e-100 at least.
template <class V>
HEXMEMBRANE_INLINE void invert(V& a, V& b)
{
	a = larger(a, constant<V>(1e-100));
	b = larger(b, constant<V>(1e-100));
	const V both = 1 / (a * b), ofA = both * b;
	b = both * a;
	a = ofA;
}

/// What a step of an unbonded contact brought.
template <class V>
struct UnbondedStep {
	V normal; ///< N (N)
	Mask<V> open;
	V slip, roll; ///< as in ContactWorks (J)
};

/// One step of an unbonded contact. What it remembers comes already carried() into the present contact plane, without loads on springs that are not there (see
/// withoutLostSprings()), and goes out advanced:
///   N = kn u, no tension: u < 0 opens the contact
///   shear  -> shear - ks slide,   cut to mu N
///   moment -> moment - kr bend,   cut to mu_r Rbar N
template <class V>
HEXMEMBRANE_INLINE UnbondedStep<V> advanceUnbonded(const LinearLaw<V>& law, const ContactMotion<V>& motion, ContactMemory<V>& memory)
{
	const V nothing = constant<V>(0);
	const Mask<V> open = motion.overlap < 0;
	UnbondedStep<V> step{open ? nothing : law.kn * motion.overlap, open, nothing, nothing};
	const SpringTrial<V> slip(memory.shear, motion.slide, law.ks, law.friction * step.normal, open);
	const SpringTrial<V> roll(memory.moment, motion.bend, law.kr, law.rollingArm * step.normal, open);
	if constexpr (std::is_same<V, double>::value) // roots and quotients are for the few that slide
		if (slip.elastic() && roll.elastic()) {
			memory.shear = slip.trial;
			memory.moment = roll.trial;
			return step;
		}
	V perShear = squareRoot(slip.square), perMoment = squareRoot(roll.square), perKs = law.ks, perKr = law.kr;
	invert(perShear, perMoment);
	invert(perKs, perKr);
	step.slip = slip.keep(perShear, perKs, memory.shear);
	step.roll = roll.keep(perMoment, perKr, memory.moment);
	return step;
}

/// What is left when springs were taken away: a spring without stiffness holds nothing.
inline ContactMemory<double> withoutLostSprings(ContactMemory<double> memory, const LinearLaw<double>& law)
{
	if (!(law.ks > 0)) memory.shear = Vec3::Zero();
	if (!(law.kr > 0)) memory.moment = Vec3::Zero();
	return memory;
}

/// One step of a contact, as advanceUnbonded(), or as advanceBond() when it is bonded; `bonded` is cleared when a bond breaks.
inline ContactStep advanceContact(const ContactLaw& law, const ContactMotion<double>& motion, ContactMemory<double>& memory, bool& bonded)
{
	memory = withoutLostSprings(memory, law); // a script may take a spring away while it holds something
	if (bonded) return advanceBond(law, motion, memory, bonded);
	const UnbondedStep<double> step = advanceUnbonded<double>(law, motion, memory);
	return {step.normal, step.open, BondBreak::none, {step.slip, step.roll, 0}};
}

/// What the springs held that withoutLostSprings() takes away (J), by the law that they had.
inline ContactWorks worksOfLostSprings(const ContactMemory<double>& memory, const LinearLaw<double>& before, const LinearLaw<double>& now)
{
	ContactWorks works;
	if (!(now.ks > 0)) works.slip = springEnergy(memory.shear.squaredNorm(), before.ks);
	if (!(now.kr > 0)) works.roll = springEnergy(memory.moment.squaredNorm(), before.kr);
	return works;
}

/// How the two bodies of a contact move.
template <class V>
struct PairMotion {
	Vector<V> velocity;                ///< of body 2 against body 1 at the contact point (m/s)
	Vector<V> spinSum, spinDifference; ///< of both spins, and of body 2 against body 1 (rad/s)
};

/// Carries what the contact remembers to its present normal.
template <class V>
HEXMEMBRANE_INLINE void carry(ContactMemory<V>& memory, const Vector<V>& normal, const Vector<V>& spinSum, V dt)
{
	const Vector<V> tilt = cross(memory.normal, normal), twist = (0.5 * dt * dot(memory.normal, spinSum)) * memory.normal;
	memory.forEachTurning([&](Vector<V>& load) __attribute__((always_inline)) { load = carried(load, tilt, twist); });
	memory.normal = normal;
}

} // namespace hexmembrane
