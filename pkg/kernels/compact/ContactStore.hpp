// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/compact/SphereArrays.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace hexmembrane {

/// Friction and rolling friction of a pair of materials (-): the only parameters of a law that have few values in a scene.
struct Frictions {
	double sliding, rolling;
};

/// The parameters of a contact's law, and the kind of pair it is: an index into a table of frictions.
struct LawOfKind {
	ContactLaw law;
	int kind;
};

/// A contact as it is stored, one and a half cache lines: a sweep over many contacts waits for memory, so what can be had otherwise is not in it.
struct alignas(32) PackedContact {
	Vec3 shear, moment, normal; ///< as in ContactMemory
	double kn, ks;
	double lever; ///< Rbar (m): kr = ks Rbar^2, limit of the moment mu_r Rbar N; 0 without rolling friction
};
static_assert(sizeof(PackedContact) == 96, "the layout that the loops are made for");

/// Contacts of a list: what they remember, in the list's order.
class ContactStore {
public:
	/// Room for so many contacts that remember nothing; setLaw() for each of them follows. \param table frictions by kind
	void start(std::size_t count, const std::vector<Frictions>& table);
	void setLaw(int p, const LawOfKind& law)
	{
		contacts[p].kn = law.law.kn;
		contacts[p].ks = law.law.ks;
		contacts[p].lever = law.law.rollingArm > 0 ? law.law.rollingArm / frictions[law.kind].rolling : 0;
		kinds[p] = static_cast<std::uint16_t>(law.kind);
	}
	/// History and bond; the law's parameters stay those of setLaw().
	void put(int p, const ContactMemory& memory, unsigned char bit);
	ContactMemory get(int p) const;

	std::size_t size() const { return contacts.size(); }

	std::vector<PackedContact> contacts;
	std::vector<unsigned char> bits;
	std::vector<std::uint16_t> kinds;
	std::vector<Frictions> frictions;

private:
	std::vector<std::array<double, 2>> strengths; ///< of bonds, tension and shear (N); empty: there has been no bond
};

} // namespace hexmembrane
