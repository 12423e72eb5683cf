// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/compact/BoundaryContacts.hpp"

#include "kernels/compact/BoundarySweep.hpp"

#include <algorithm>

namespace hexmembrane {

bool BoundaryContacts::restore(int sphere, const Contact& contact)
{
	const auto found = std::lower_bound(spheres.begin(), spheres.end(), sphere);
	if (found == spheres.end() || *found != sphere) return false;
	store.put(int(found - spheres.begin()), contact);
	return true;
}

ContactWorks BoundaryContacts::rebuild(std::vector<int> near, const std::vector<int>& newIndex, const std::vector<PairKind<double>>& kinds,
                                       const OfSphere& springs)
{
	BoundaryContacts old;
	old.spheres.swap(spheres);
	std::swap(old.store, store);

	spheres = std::move(near);
	store.start(spheres.size(), kinds);
	for (std::size_t c = 0; c < spheres.size(); ++c) store.setSprings(int(c), springs(spheres[c]));
	ContactWorks lost;
	old.forEachTouching([&](int i, const Contact& contact) {
		const auto at = std::lower_bound(spheres.begin(), spheres.end(), newIndex[i]);
		if (at != spheres.end() && *at == newIndex[i]) lost += worksOfLostSprings(contact.memory, contact.law, store.law(int(at - spheres.begin())));
		restore(newIndex[i], contact);
	});
	return lost;
}

void BoundaryContacts::sweep(int from, int to, const Boundary& boundary, const std::vector<Place>& places, const std::vector<Motion>& motions,
                             std::vector<Load>& loads, double dt, BoundaryLoad& received)
{
	const auto first = std::lower_bound(spheres.begin(), spheres.end(), from), last = std::lower_bound(first, spheres.end(), to);
	sweepBoundary(
	        {boundary, spheres.data(), &store, places.data(), motions.data(), loads.data(), int(first - spheres.begin()), int(last - spheres.begin()), dt},
	        received);
}

double BoundaryContacts::stiffness(const Vec3& along) const
{
	double sum = 0;
	for (std::size_t c = 0; c < spheres.size(); ++c) {
		if (!store.bits[c]) continue;
		const StoredContact<double>& contact = store.contacts[c];
		const double cosine = contact.memory.normal.dot(along), square = cosine * cosine;
		sum += contact.springs.kn * square + contact.springs.ks * (1 - square);
	}
	return sum;
}

double BoundaryContacts::energy(const Boundary& boundary, const std::vector<Place>& places) const
{
	double sum = 0;
	forEachTouching([&](int i, const Contact& contact) {
		sum += contactEnergy(contact.law, contact.law.kn * boundary.shape->touch(places[i]).overlap, contact.memory);
	});
	return sum;
}

} // namespace hexmembrane
