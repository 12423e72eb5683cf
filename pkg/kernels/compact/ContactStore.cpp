// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/compact/ContactStore.hpp"

namespace hexmembrane {

void ContactStore::start(std::size_t count, const std::vector<Frictions>& table)
{
	contacts.resize(count);
	for (PackedContact& contact : contacts) contact = {Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), 0, 0, 0};
	bits.assign(count, 0);
	kinds.assign(count, 0);
	frictions = table;
	strengths.clear();
}

void ContactStore::put(int p, const ContactMemory& memory, unsigned char bit)
{
	contacts[p].shear = memory.shear;
	contacts[p].moment = memory.moment;
	contacts[p].normal = memory.normal;
	bits[p] = bit;
	if (!(bit & contactBonded)) return;
	if (strengths.empty()) strengths.resize(size());
	strengths[p] = {memory.law.tensileStrength, memory.law.shearStrength};
}

ContactMemory ContactStore::get(int p) const
{
	const PackedContact& c = contacts[p];
	const Frictions& f = frictions[kinds[p]];
	ContactMemory memory{c.shear, c.moment, c.normal, {c.kn, c.ks, f.sliding, c.ks * c.lever * c.lever, f.rolling * c.lever, 0, 0}};
	if (!strengths.empty()) {
		memory.law.tensileStrength = strengths[p][0];
		memory.law.shearStrength = strengths[p][1];
	}
	return memory;
}

} // namespace hexmembrane
