// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "BoundaryContacts.hpp"

#include "BoundarySweep.hpp"

#include <algorithm>

namespace hexmembrane {

bool BoundaryContacts::restore(int sphere, const ContactMemory& memory, unsigned char bit)
{
	const auto found = std::lower_bound(spheres.begin(), spheres.end(), sphere);
	if (found == spheres.end() || *found != sphere) return false;
	memories[found - spheres.begin()] = memory;
	bits[found - spheres.begin()] = bit;
	return true;
}

void BoundaryContacts::renewLaws(const LawOfSphere& law)
{
	for (std::size_t c = 0; c < spheres.size(); ++c) {
		const ContactLaw before = memories[c].law;
		memories[c].law = law(spheres[c]);
		memories[c].law.tensileStrength = before.tensileStrength;
		memories[c].law.shearStrength = before.shearStrength;
	}
}

void BoundaryContacts::rebuild(std::vector<int> near, const std::vector<int>& newIndex, const LawOfSphere& law)
{
	BoundaryContacts old;
	old.spheres.swap(spheres);
	old.memories.swap(memories);
	old.bits.swap(bits);

	spheres = std::move(near);
	bits.assign(spheres.size(), 0);
	memories.resize(spheres.size());
	for (std::size_t c = 0; c < spheres.size(); ++c) memories[c] = {Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), law(spheres[c])};
	old.forEachTouching([&](int i, const ContactMemory& memory, unsigned char bit) { restore(newIndex[i], memory, bit); });
}

void BoundaryContacts::sweep(int from, int to, const FlatBoundary& boundary, const std::vector<Place>& places, const std::vector<Motion>& motions,
                             std::vector<Load>& loads, double dt, BoundaryLoad& received)
{
	const auto first = std::lower_bound(spheres.begin(), spheres.end(), from), last = std::lower_bound(first, spheres.end(), to);
	sweepBoundary({boundary, spheres.data(), memories.data(), bits.data(), places.data(), motions.data(), loads.data(), int(first - spheres.begin()),
	               int(last - spheres.begin()), dt},
	              received);
}

double BoundaryContacts::stiffness(const Vec3& along) const
{
	double sum = 0;
	forEachTouching([&](int, const ContactMemory& memory, unsigned char) {
		const double cosine = memory.normal.dot(along), square = cosine * cosine;
		sum += memory.law.kn * square + memory.law.ks * (1 - square);
	});
	return sum;
}

double BoundaryContacts::energy(const FlatBoundary& boundary, const std::vector<Place>& places) const
{
	double sum = 0;
	forEachTouching([&](int i, const ContactMemory& memory, unsigned char) {
		sum += contactEnergy(memory.law, memory.law.kn * boundary.touch(places[i]).u, memory.shear, memory.moment);
	});
	return sum;
}

} // namespace hexmembrane
