// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/compact/ContactStore.hpp"

namespace hexmembrane {

void ContactStore::start(std::size_t count, const std::vector<PairKind<double>>& kindTable)
{
	contacts.assign(count, {noMemory(), {}});
	bits.assign(count, 0);
	kinds.assign(count, 0);
	table = kindTable;
	strengths.clear();
}

void ContactStore::put(int p, const Contact& contact)
{
	contacts[p].memory = withoutLostSprings(contact.memory, law(p));
	bits[p] = contact.bits;
	if (!contact.bonded()) return;
	if (strengths.empty()) strengths.resize(size(), {0, 0});
	strengths[p] = contact.strengths();
}

Contact ContactStore::get(int p) const
{
	const BondStrengths bond = strengths.empty() ? BondStrengths{0, 0} : strengths[p];
	return {contacts[p].memory, {law(p), bond.tension, bond.shear}, bits[p]};
}

} // namespace hexmembrane
