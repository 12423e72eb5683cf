// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/compact/ContactStore.hpp"

#include <algorithm>

/* One step of a list of contacts, whatever meets there. Those that touch are picked out first, without branches that the processor would have to guess, and are
 * then taken four at a time through four short loops; no iteration of such a loop depends on the one before, so that the processor overlaps them. Bonds, and the
 * last few of a list, are taken one at a time. All lanes run every branch of the law. */
namespace hexmembrane {

/// Four contacts on their way through a step.
struct FourPassing {
	Lanes3 normal;
	Lanes overlap;
	PairMotion<Lanes> motion;
	Lanes3 shear, moment; ///< what came of it
	Lanes normalForce;
};

/// Works of four lanes.
struct FourWorks {
	Lanes slip = lanes(0), roll = lanes(0);

	void addTo(ContactWorks& works) const
	{
		works.slip += (slip[0] + slip[1]) + (slip[2] + slip[3]);
		works.roll += (roll[0] + roll[1]) + (roll[2] + roll[3]);
	}
};

/// The law for four contacts of a store.
HEXMEMBRANE_INLINE void advanceFour(ContactStore& store, const int* index, FourPassing& four, double dt, FourWorks& works)
{
	const FourContacts at{index};
	StoredContact<Lanes> contact = at.contacts(store);
	carry<Lanes>(contact.memory, four.normal, four.motion.spinSum, lanes(dt));
	const Lanes3 slide = lanes(dt) * acrossNormal(four.motion.velocity, four.normal);
	const UnbondedStep<Lanes> step =
	        advanceUnbonded<Lanes>(lawOf(contact.springs, at.kinds(store)),
	                               contactMotion<Lanes>(four.overlap, slide, four.motion.spinDifference, four.normal, lanes(dt)), contact.memory);
	at.put(contact, store);
	works.slip += step.slip;
	works.roll += step.roll;
	four.shear = contact.memory.shear;
	four.moment = momentOf(contact.memory);
	four.normalForce = step.normal;
	unsigned char* const bits = store.bits.data();
	for (int k = 0; k < 4; ++k) bits[index[k]] = static_cast<unsigned char>(contactTouching + step.open[k]);
}

/// Contacts picked out of a stretch of the list, and what is left of the stretch before.
constexpr int sweepStretch = 64;

/// The contacts begin .. end - 1 of `store`. A Geometry says what they are between:
///   Batch                      arrays of picked contacts: `count`, `contact` (their places in the store), `fours`, move(from, to)
///   bool pick(p, end, batch)   picks those that touch, or did, and have no bond; whether there are bonds among them
///   void measure(batch, f)     normal and overlap of four f        void follow(batch, f)   how its bodies move
///   void act(batch, f)         loads of four f on the bodies       Meeting meet(p)         of one contact
///   void act(p, meeting, step, contact)                            loads of one contact that has not opened
template <class Geometry>
HEXMEMBRANE_INLINE void sweepContacts(Geometry& geometry, ContactStore& store, int begin, int end, double dt, SweepSums& sums)
{
	const auto one = [&](int p) {
		const Meeting meeting = geometry.meet(p);
		Contact contact = store.get(p);
		const ContactStep step = advanceContact(contact, meeting, dt);
		store.put(p, contact);
		sums.add(step);
		if (!step.open) geometry.act(p, meeting, step, contact);
	};
	typename Geometry::Batch batch;
	FourWorks works;
	for (int p = begin; p < end; p += sweepStretch) {
		const int border = std::min(end, p + sweepStretch);
		if (geometry.pick(p, border, batch))
			for (int b = p; b < border; ++b)
				if (store.bits[b] & contactBonded) one(b);
		const int fours = batch.count / 4, rest = batch.count - 4 * fours;
		for (int f = 0; f < fours; ++f) geometry.measure(batch, f);
		for (int f = 0; f < fours; ++f) geometry.follow(batch, f);
		for (int f = 0; f < fours; ++f) advanceFour(store, batch.contact + 4 * f, batch.fours[f], dt, works);
		for (int f = 0; f < fours; ++f) geometry.act(batch, f);
		// what is left of the last four goes first next time
		for (int k = 0; k < rest; ++k) batch.move(4 * fours + k, k);
		batch.count = rest;
	}
	for (int k = 0; k < batch.count; ++k) one(batch.contact[k]);
	works.addTo(sums.works);
}

} // namespace hexmembrane
