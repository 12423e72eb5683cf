// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/base/Place.hpp"
#include "kernels/contact/ContactMaterial.hpp"

/* The arrays of the compact tier. Spheres are numbered grains first, in an order of space, then the membrane's particles ring by ring; what a contact reads of
 * a sphere lies together and on as few cache lines as can be. SI units. */
namespace hexmembrane {

/// How it moves: one cache line.
struct alignas(64) Motion {
	Vec3 velocity;
	Vec3 spin;
};

/// What acts on it: one cache line.
struct alignas(64) Load {
	Vec3 force;
	Vec3 torque;

	Load& operator+=(const Load& other)
	{
		force += other.force;
		torque += other.torque;
		return *this;
	}
};

/// A force alone: half a cache line.
struct alignas(32) PaddedForce {
	Vec3 force;
	double unused;
};

inline Load noLoad() { return {Vec3::Zero(), Vec3::Zero()}; }

static_assert(sizeof(Place) == 32 && sizeof(PaddedForce) == 32 && sizeof(Motion) == 64 && sizeof(Load) == 64, "the layout that the loops are made for");

/// Bits of a contact.
enum ContactBits : unsigned char { contactTouching = 1, contactBonded = 2 };

/// Strengths of a bond (N).
struct BondStrengths {
	double tension, shear;
	static constexpr const char* fields = "tensileStrength shearStrength";
};

/// A contact as it is looked at: what it remembers, its law, its bits.
struct Contact {
	ContactMemory<double> memory;
	ContactLaw law;
	unsigned char bits;

	/// The same contact seen from the other body.
	Contact swapped() const { return {memory.swapped(), law, bits}; }
	BondStrengths strengths() const { return {law.tensileStrength, law.shearStrength}; }
	bool bonded() const { return bits & contactBonded; }
};

/// What a sweep over contacts brought besides loads.
struct SweepSums {
	ContactWorks works;
	int tensileBreaks = 0, shearBreaks = 0; ///< bonds that broke

	SweepSums& operator+=(const SweepSums& other)
	{
		works += other.works;
		tensileBreaks += other.tensileBreaks;
		shearBreaks += other.shearBreaks;
		return *this;
	}
	void add(const ContactStep& step)
	{
		works += step.works;
		tensileBreaks += step.bond == BondBreak::tension;
		shearBreaks += step.bond == BondBreak::shear;
	}
};

/// Two bodies where they meet: the unit normal points from body 1 to body 2, the arms from their centres to the contact point.
struct Meeting {
	Vec3 normal;
	double overlap;
	Motion body1, body2;
	Vec3 arm1, arm2;

	PairMotion<double> motion() const
	{
		return {relativeVelocity(body1.velocity, body1.spin, arm1, body2.velocity, body2.spin, arm2), body1.spin + body2.spin, body2.spin - body1.spin};
	}
};

/// One step of a contact, bonded or not: what it remembers is carried, then advanced, and its bits follow.
inline ContactStep advanceContact(Contact& contact, const Meeting& meeting, double dt)
{
	bool bonded = contact.bonded();
	const PairMotion<double> motion = meeting.motion();
	carry(contact.memory, meeting.normal, motion.spinSum, dt);
	const Vec3 slide = dt * acrossNormal(motion.velocity, meeting.normal);
	const ContactStep step =
	        advanceContact(contact.law, contactMotion<double>(meeting.overlap, slide, motion.spinDifference, meeting.normal, dt), contact.memory, bonded);
	contact.bits = (step.open ? 0 : contactTouching) | (bonded ? contactBonded : 0);
	return step;
}

} // namespace hexmembrane
