// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/compact/ContactStore.hpp"
#include "kernels/base/Lanes.hpp"

#include <cstddef>

/* Four contacts without bonds in one step: ContactLaw.hpp's formulas (the oracle, see tests/kernels/FourContactsTest.cpp), a contact a lane, without branches.
 * What a lane does not need costs nothing, since the lanes beside it do. */
namespace hexmembrane {

/// What four contacts remember, and the parameters of their laws.
struct FourMemories {
	Lanes3 shear, moment, normal;
	Lanes kn, ks, lever;             ///< as in PackedContact
	Lanes friction, rollingFriction; ///< by kind
};

/// How four contacts moved in a step.
struct ContactPath {
	Lanes3 slide, bend; ///< as in ContactMotion
	Lanes3 spin;        ///< mean rotation of the two bodies (rad)
};

/// What a step brought. Shear and moment stand in the memories; all loads of an open contact are 0.
struct FourSteps {
	Lanes normalForce;
	LaneMask open;
	Lanes slipWork, rollWork; ///< as in ContactStep
};

static_assert(offsetof(PackedContact, moment) == 3 * sizeof(double) && offsetof(PackedContact, kn) == 9 * sizeof(double),
              "a contact is read as three rows of four doubles");

HEXMEMBRANE_INLINE void loadRow(const PackedContact* const* contacts, int row, Lanes& a, Lanes& b, Lanes& c, Lanes& d)
{
	const auto part = [&](int k) __attribute__((always_inline)) { return load4(reinterpret_cast<const double*>(contacts[k]) + 4 * row); };
	a = part(0);
	b = part(1);
	c = part(2);
	d = part(3);
	transpose(a, b, c, d);
}

HEXMEMBRANE_INLINE void storeRow(PackedContact* const* contacts, int row, Lanes a, Lanes b, Lanes c, Lanes d)
{
	transpose(a, b, c, d);
	const auto part = [&](int k, Lanes v) __attribute__((always_inline)) { store4(reinterpret_cast<double*>(contacts[k]) + 4 * row, v); };
	part(0, a);
	part(1, b);
	part(2, c);
	part(3, d);
}

HEXMEMBRANE_INLINE FourMemories loadMemories(const PackedContact* const* contacts)
{
	FourMemories m;
	loadRow(contacts, 0, m.shear.x, m.shear.y, m.shear.z, m.moment.x);
	loadRow(contacts, 1, m.moment.y, m.moment.z, m.normal.x, m.normal.y);
	loadRow(contacts, 2, m.normal.z, m.kn, m.ks, m.lever);
	return m;
}

HEXMEMBRANE_INLINE void storeMemories(const FourMemories& m, PackedContact* const* contacts)
{
	storeRow(contacts, 0, m.shear.x, m.shear.y, m.shear.z, m.moment.x);
	storeRow(contacts, 1, m.moment.y, m.moment.z, m.normal.x, m.normal.y);
	storeRow(contacts, 2, m.normal.z, m.kn, m.ks, m.lever);
}

HEXMEMBRANE_INLINE Lanes3 acrossNormal(const Lanes3& v, const Lanes3& normal) { return v - dot(normal, v) * normal; }

HEXMEMBRANE_INLINE Lanes3 carried(const Lanes3& load, const Lanes3& tilt, const Lanes3& twist)
{
	const Lanes3 tilted = load - cross(load, tilt);
	return tilted - cross(tilted, twist);
}

/// The trial loads of shear and of moment, cut: loadAndCut() for contacts that are not open, springEnergy() of what open ones held.
struct FourCut {
	Lanes3 before, trial;
	Lanes square, limit, stiffness;
	LaneMask cut;

	HEXMEMBRANE_INLINE FourCut(const Lanes3& load, const Lanes3& displacement, Lanes k, Lanes most)
	    : before(load), trial(load - k * displacement), square(dot(trial, trial)), limit(most), stiffness(k), cut(square > most * most)
	{
	}
	/// What is kept, and what is lost times twice the stiffness. `inverse`: 1/|trial|
	HEXMEMBRANE_INLINE Lanes keep(LaneMask open, Lanes inverse, Lanes3& kept) const
	{
		const Lanes nothing = lanes(0), share = cut ? limit * inverse : lanes(1);
		kept = (open ? nothing : share) * trial;
		const Lanes cutWork = dot(before + kept, trial - kept);
		return open ? dot(before, before) : (cut ? cutWork : nothing);
	}
};

/// 1/a and 1/b by one quotient: it takes as long as ten products. Both at least `least`, whose square must not underflow.
HEXMEMBRANE_INLINE void invert(Lanes& a, Lanes& b, double least)
{
	a = larger(a, lanes(least));
	b = larger(b, lanes(least));
	const Lanes both = 1 / (a * b), ofA = both * b;
	b = both * a;
	a = ofA;
}

/// \param velocity at the contact point, spins: body 2 against body 1
HEXMEMBRANE_INLINE ContactPath contactPath(const Lanes3& normal, const Lanes3& velocity, const Lanes3& spinSum, const Lanes3& spinDifference, double dt)
{
	return {lanes(dt) * acrossNormal(velocity, normal), lanes(dt) * acrossNormal(spinDifference, normal), lanes(0.5 * dt) * spinSum};
}

/// One step of four contacts, as advanceMemory() does one that is not bonded.
HEXMEMBRANE_INLINE FourSteps advanceFour(FourMemories& m, const Lanes3& normal, Lanes overlap, const ContactPath& path)
{
	const Lanes3 tilt = cross(m.normal, normal), twist = dot(m.normal, path.spin) * m.normal;
	const Lanes kr = m.ks * m.lever * m.lever;
	FourSteps step;
	step.open = overlap < 0;
	step.normalForce = step.open ? lanes(0) : m.kn * overlap;
	m.shear = carried(m.shear, tilt, twist);
	m.moment = carried(m.moment, tilt, twist);
	const FourCut slip(m.shear, path.slide, m.ks, m.friction * step.normalForce);
	const FourCut roll(m.moment, path.bend, kr, m.rollingFriction * m.lever * step.normalForce);
	Lanes perShear = squareRoot(slip.square), perMoment = squareRoot(roll.square), perKs = m.ks, perKr = kr;
	invert(perShear, perMoment, 1e-100);
	invert(perKs, perKr, 1e-100);
	step.slipWork = 0.5 * perKs * slip.keep(step.open, perShear, m.shear);
	step.rollWork = 0.5 * perKr * roll.keep(step.open, perMoment, m.moment);
	m.normal = normal;
	return step;
}

/// Four contacts on their way through a step.
struct Four {
	Lanes3 normal;
	Lanes overlap;
	ContactPath path;     ///< how they moved
	Lanes3 shear, moment; ///< what came of it
	Lanes normalForce;
};

/// Sums of four lanes.
struct FourSums {
	Lanes slip = lanes(0), roll = lanes(0);

	void addTo(SweepSums& sums) const
	{
		sums.slip += (slip[0] + slip[1]) + (slip[2] + slip[3]);
		sums.roll += (roll[0] + roll[1]) + (roll[2] + roll[3]);
	}
};

/// The law for the four contacts at `index`.
HEXMEMBRANE_INLINE void advance(ContactStore& store, const int* index, Four& four, FourSums& sums)
{
	PackedContact* const all = store.contacts.data();
	PackedContact* const contacts[4] = {all + index[0], all + index[1], all + index[2], all + index[3]};
	const Frictions* const table = store.frictions.data();
	const std::uint16_t* const kinds = store.kinds.data();
	const Frictions &a = table[kinds[index[0]]], &b = table[kinds[index[1]]], &c = table[kinds[index[2]]], &d = table[kinds[index[3]]];
	FourMemories m = loadMemories(contacts);
	m.friction = Lanes{a.sliding, b.sliding, c.sliding, d.sliding};
	m.rollingFriction = Lanes{a.rolling, b.rolling, c.rolling, d.rolling};
	const FourSteps step = advanceFour(m, four.normal, four.overlap, four.path);
	storeMemories(m, contacts);
	sums.slip += step.slipWork;
	sums.roll += step.rollWork;
	four.shear = m.shear;
	four.moment = m.moment;
	four.normalForce = step.normalForce;
	unsigned char* const bits = store.bits.data();
	for (int k = 0; k < 4; ++k) bits[index[k]] = static_cast<unsigned char>(contactTouching + step.open[k]);
}

} // namespace hexmembrane
