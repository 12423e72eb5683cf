// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/compact/ContactStore.hpp"

#include <algorithm>

/* One step of a list of contacts, whatever meets there. Those that touch are picked out first, without branches that the processor would have to guess, and are
 * then taken in groups, as many at a time as a register has lanes, through four short loops; no iteration of such a loop depends on the one before, so that the processor overlaps them. Bonds, and the
 * last few of a list, are taken one at a time. All lanes run every branch of the law. */
namespace hexmembrane {

/// A group of contacts on its way through a step.
template <class V>
struct Passing {
	Lanes3<V> normal;
	V overlap;
	PairMotion<V> motion;
	Lanes3<V> shear, moment; ///< what came of it
	V normalForce;
};

/// Works by lane.
template <class V>
struct LaneWorks {
	V slip{}, roll{};

	HEXMEMBRANE_INLINE void addTo(ContactWorks& works) const
	{
		works.slip += total(slip);
		works.roll += total(roll);
	}
};

/// The law for a group of contacts of a store.
template <class V>
HEXMEMBRANE_INLINE void advanceGroup(ContactStore& store, const int* index, Passing<V>& group, double dt, LaneWorks<V>& works)
{
	const ContactsAt<V> at{index};
	StoredContact<V> contact = at.contacts(store);
	carry<V>(contact.memory, group.normal, group.motion.spinSum, lanes<V>(dt));
	const Lanes3<V> slide = lanes<V>(dt) * acrossNormal(group.motion.velocity, group.normal);
	const UnbondedStep<V> step =
	        advanceUnbonded<V>(lawOf(contact.springs, at.kinds(store)),
	                           contactMotion<V>(group.overlap, slide, group.motion.spinDifference, group.normal, lanes<V>(dt)), contact.memory);
	at.put(contact, store);
	works.slip += step.slip;
	works.roll += step.roll;
	group.shear = contact.memory.shear;
	group.moment = momentOf(contact.memory);
	group.normalForce = step.normal;
	unsigned char* const bits = store.bits.data();
	for (int k = 0; k < laneCount<V>; ++k) bits[index[k]] = static_cast<unsigned char>(contactTouching + step.open[k]);
}

/// Contacts picked out of a stretch of the list, and what is left of the stretch before.
constexpr int sweepStretch = 64;

/// The contacts begin .. end - 1 of `store`. A Geometry says what they are between:
///   Batch                      arrays of picked contacts: `count`, `contact` (their places in the store), `groups`, move(from, to)
///   bool pick(p, end, batch)   picks those that touch, or did, and have no bond; whether there are bonds among them
///   void measure(batch, f)     normal and overlap of group f       void follow(batch, f)   how its bodies move
///   void act(batch, f)         loads of group f on the bodies      Meeting meet(p)         of one contact
///   void act(p, meeting, step, contact)                            loads of one contact that has not opened
template <class V, class Geometry>
HEXMEMBRANE_INLINE void sweepContacts(Geometry& geometry, ContactStore& store, int begin, int end, double dt, SweepSums& sums)
{
	constexpr int width = laneCount<V>;
	const auto one = [&](int p) {
		const Meeting meeting = geometry.meet(p);
		Contact contact = store.get(p);
		const ContactStep step = advanceContact(contact, meeting, dt);
		store.put(p, contact);
		sums.add(step);
		if (!step.open) geometry.act(p, meeting, step, contact);
	};
	typename Geometry::Batch batch;
	LaneWorks<V> works;
	for (int p = begin; p < end; p += sweepStretch) {
		const int border = std::min(end, p + sweepStretch);
		if (geometry.pick(p, border, batch))
			for (int b = p; b < border; ++b)
				if (store.bits[b] & contactBonded) one(b);
		const int groups = batch.count / width, rest = batch.count - width * groups;
		for (int f = 0; f < groups; ++f) geometry.measure(batch, f);
		for (int f = 0; f < groups; ++f) geometry.follow(batch, f);
		for (int f = 0; f < groups; ++f) advanceGroup<V>(store, batch.contact + width * f, batch.groups[f], dt, works);
		for (int f = 0; f < groups; ++f) geometry.act(batch, f);
		// what makes no group goes first next time
		for (int k = 0; k < rest; ++k) batch.move(width * groups + k, k);
		batch.count = rest;
	}
	for (int k = 0; k < batch.count; ++k) one(batch.contact[k]);
	works.addTo(sums.works);
}

} // namespace hexmembrane
