// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/compact/SphereArrays.hpp"

#include <cstdint>
#include <utility>
#include <vector>

namespace hexmembrane {

/// A contact as it is stored, one and a half cache lines, or four of them as lanes: a sweep over many contacts waits for memory, so what can be had otherwise
/// (the parameters of its kind) is not in it. The alignment fills it up to whole rows of four numbers.
template <class V>
struct alignas(4 * sizeof(V)) StoredContact {
	ContactMemory<V> memory;
	PairSprings<V> springs;
};
constexpr int rowsOfContact = sizeof(StoredContact<double>) / (4 * sizeof(double));
static_assert(sizeof(StoredContact<Lanes>) == 4 * rowsOfContact * sizeof(Lanes), "four contacts are read as lanes in the same order");

/// Springs of a pair, and the kind of pair that it is: an index into a table of kinds.
struct SpringsOfKind {
	PairSprings<double> springs;
	int kind;
};

/// Contacts of a list: what they remember, in the list's order.
class ContactStore {
public:
	/// Room for so many contacts that remember nothing; setSprings() for each of them follows. \param table parameters by kind
	void start(std::size_t count, const std::vector<PairKind<double>>& table);
	void setSprings(int p, const SpringsOfKind& pair)
	{
		contacts[p].springs = pair.springs;
		kinds[p] = static_cast<std::uint16_t>(pair.kind);
	}
	/// Memory, bits and strengths of a bond; the other parameters stay those of setSprings(), and what they have no spring for is not kept.
	void put(int p, const Contact& contact);
	Contact get(int p) const;
	LinearLaw<double> law(int p) const { return lawOf(contacts[p].springs, table[kinds[p]]); }

	std::size_t size() const { return contacts.size(); }

	std::vector<StoredContact<double>> contacts;
	std::vector<unsigned char> bits;
	std::vector<std::uint16_t> kinds;
	std::vector<PairKind<double>> table;

private:
	std::vector<BondStrengths> strengths; ///< of bonds; empty: there has been no bond
};

/// Where four contacts of a store stand. Their records become lanes, and back, row by row and number by number, straight into the members: a copy of the whole
/// through memory would wait for its own stores.
struct FourContacts {
	const int* index;

	HEXMEMBRANE_INLINE StoredContact<Lanes> contacts(const ContactStore& store) const
	{
		StoredContact<Lanes> four;
		load(store.contacts.data(), reinterpret_cast<Lanes*>(&four), std::make_integer_sequence<int, rowsOfContact>());
		return four;
	}
	HEXMEMBRANE_INLINE void put(const StoredContact<Lanes>& four, ContactStore& store) const
	{
		save(reinterpret_cast<const Lanes*>(&four), store.contacts.data(), std::make_integer_sequence<int, rowsOfContact>());
	}
	HEXMEMBRANE_INLINE PairKind<Lanes> kinds(const ContactStore& store) const
	{
		PairKind<Lanes> four;
		gather(store, reinterpret_cast<Lanes*>(&four), std::make_integer_sequence<int, int(sizeof(four) / sizeof(Lanes))>());
		return four;
	}

private:
	static_assert(sizeof(PairKind<Lanes>) == 4 * sizeof(PairKind<double>), "a kind is its numbers");

	template <int row>
	HEXMEMBRANE_INLINE double* at(const StoredContact<double>* all, int k) const
	{
		return const_cast<double*>(reinterpret_cast<const double*>(all + index[k])) + 4 * row;
	}
	template <int... row>
	HEXMEMBRANE_INLINE void load(const StoredContact<double>* all, Lanes* lanes, std::integer_sequence<int, row...>) const
	{
		(loadRow(load4(at<row>(all, 0)), load4(at<row>(all, 1)), load4(at<row>(all, 2)), load4(at<row>(all, 3)), lanes + 4 * row), ...);
	}
	static HEXMEMBRANE_INLINE void loadRow(Lanes a, Lanes b, Lanes c, Lanes d, Lanes* lanes)
	{
		transpose(a, b, c, d);
		lanes[0] = a;
		lanes[1] = b;
		lanes[2] = c;
		lanes[3] = d;
	}
	template <int... row>
	HEXMEMBRANE_INLINE void save(const Lanes* lanes, StoredContact<double>* all, std::integer_sequence<int, row...>) const
	{
		(saveRow(lanes[4 * row], lanes[4 * row + 1], lanes[4 * row + 2], lanes[4 * row + 3], at<row>(all, 0), at<row>(all, 1), at<row>(all, 2),
		         at<row>(all, 3)),
		 ...);
	}
	static HEXMEMBRANE_INLINE void saveRow(Lanes a, Lanes b, Lanes c, Lanes d, double* toA, double* toB, double* toC, double* toD)
	{
		transpose(a, b, c, d);
		store4(toA, a);
		store4(toB, b);
		store4(toC, c);
		store4(toD, d);
	}
	template <int... number>
	HEXMEMBRANE_INLINE void gather(const ContactStore& store, Lanes* lanes, std::integer_sequence<int, number...>) const
	{
		const PairKind<double>* const table = store.table.data();
		const std::uint16_t* const kinds = store.kinds.data();
		const auto *a = reinterpret_cast<const double*>(table + kinds[index[0]]), *b = reinterpret_cast<const double*>(table + kinds[index[1]]),
		           *c = reinterpret_cast<const double*>(table + kinds[index[2]]), *d = reinterpret_cast<const double*>(table + kinds[index[3]]);
		((lanes[number] = Lanes{a[number], b[number], c[number], d[number]}), ...);
	}
};

} // namespace hexmembrane
