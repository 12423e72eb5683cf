// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/contact/ContactLaw.hpp"

/* The arrays of the compact tier. Spheres are numbered grains first, in an order of space, then the membrane's particles ring by ring; what a contact reads of
 * a sphere lies together and on as few cache lines as can be. SI units. */
namespace hexmembrane {

/// Where a sphere is: half a cache line.
struct alignas(32) Place {
	Vec3 centre;
	double radius;
};

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
struct alignas(32) Push {
	Vec3 force;
	double unused;
};

inline Load noLoad() { return {Vec3::Zero(), Vec3::Zero()}; }

/// What a contact remembers, and its parameters.
struct ContactMemory {
	Vec3 shear;  ///< shear force on the second body (N)
	Vec3 moment; ///< bending moment on it (N m)
	Vec3 normal; ///< of the last step
	ContactLaw law;
};

static_assert(sizeof(Place) == 32 && sizeof(Push) == 32 && sizeof(Motion) == 64 && sizeof(Load) == 64, "the layout that the loops are made for");

/// Bits of a contact.
enum ContactBits : unsigned char { contactTouching = 1, contactBonded = 2 };

/// What a sweep over contacts brought besides loads: energies (J) in the sense of ContactStep, counts of broken bonds.
struct SweepSums {
	double slip = 0, roll = 0, bond = 0;
	int tensileBreaks = 0, shearBreaks = 0;

	SweepSums& operator+=(const SweepSums& other)
	{
		slip += other.slip;
		roll += other.roll;
		bond += other.bond;
		tensileBreaks += other.tensileBreaks;
		shearBreaks += other.shearBreaks;
		return *this;
	}
	void add(const ContactStep& step)
	{
		slip += step.slipWork;
		roll += step.rollWork;
		bond += step.bondEnergy;
		tensileBreaks += step.bond == BondBreak::tension;
		shearBreaks += step.bond == BondBreak::shear;
	}
};

/// One step of the contact of body 2 with body 1: geometry and motion in, memory advanced, force on body 2 out.
/// \param arm1, arm2 from the bodies' centres to the contact point \param u overlap \return false when the contact has opened; `memory` is empty then
inline bool advanceMemory(ContactMemory& memory, unsigned char& bits, double u, const Vec3& normal, const Motion& body1, const Vec3& arm1, const Motion& body2,
                          const Vec3& arm2, double dt, Vec3& force, SweepSums& sums)
{
	const ContactLaw& law = memory.law;
	ContactMotion motion{u, Vec3::Zero(), Vec3::Zero()};
	const Vec3 relative = relativeVelocity(body1.velocity, body1.spin, arm1, body2.velocity, body2.spin, arm2);
	motion.slide = dt * acrossNormal(relative, normal);
	bool bonded = bits & contactBonded;
	if (bits & contactTouching) {
		const ContactTurn turn = contactTurn(memory.normal, normal, body1.spin, body2.spin, dt);
		memory.shear = carried(memory.shear, turn);
		if (law.kr > 0) memory.moment = carried(memory.moment, turn);
	}
	if (law.kr > 0 && !bonded) motion.bend = dt * acrossNormal(body2.spin - body1.spin, normal);
	const ContactStep step = advanceContact(law, motion, memory.shear, memory.moment, bonded);
	sums.add(step);
	memory.normal = normal;
	bits = (step.open ? 0 : contactTouching) | (bonded ? contactBonded : 0);
	force = step.normal * normal + memory.shear;
	return !step.open;
}

} // namespace hexmembrane
