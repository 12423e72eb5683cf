// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/compact/SphereArrays.hpp"

#include <cstdint>
#include <utility>
#include <vector>

namespace hexmembrane {

/// A contact as it is stored, one and a half cache lines, or several of them as lanes: a sweep over many contacts waits for memory, so what can be had otherwise
/// (the parameters of its kind) is not in it. The alignment fills it up to whole rows of four numbers.
template <class V>
struct alignas(4 * sizeof(V)) StoredContact {
	ContactMemory<V> memory;
	PairSprings<V> springs;
};
constexpr int rowsOfContact = sizeof(StoredContact<double>) / (4 * sizeof(double));
static_assert(sizeof(StoredContact<Four>) == 4 * rowsOfContact * sizeof(Four), "four contacts are read as lanes in the same order");

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

/// Where as many contacts of a store stand as V has lanes. Their records become lanes, and back, row by row and number by number, straight into the members: a
/// copy of the whole through memory would wait for its own stores.
template <class V>
struct ContactsAt {
	const int* index;

	HEXMEMBRANE_INLINE StoredContact<V> contacts(const ContactStore& store) const
	{
		StoredContact<V> several;
		load(store.contacts.data(), reinterpret_cast<V*>(&several), std::make_integer_sequence<int, rowsOfContact>());
		return several;
	}
	HEXMEMBRANE_INLINE void put(const StoredContact<V>& several, ContactStore& store) const
	{
		save(reinterpret_cast<const V*>(&several), store.contacts.data(), std::make_integer_sequence<int, rowsOfContact>());
	}
	HEXMEMBRANE_INLINE PairKind<V> kinds(const ContactStore& store) const
	{
		PairKind<V> several;
		gather(store, reinterpret_cast<V*>(&several), std::make_integer_sequence<int, int(sizeof(several) / sizeof(V))>());
		return several;
	}

private:
	static_assert(sizeof(PairKind<V>) == laneCount<V> * sizeof(PairKind<double>), "a kind is its numbers");

	template <int row>
	HEXMEMBRANE_INLINE double* at(const StoredContact<double>* all, int k) const
	{
		return const_cast<double*>(reinterpret_cast<const double*>(all + index[k])) + 4 * row;
	}
	template <int... row>
	HEXMEMBRANE_INLINE void load(const StoredContact<double>* all, V* numbers, std::integer_sequence<int, row...>) const
	{
		(Rows<V>::loaded([&](int k) __attribute__((always_inline)) {
			 return at<row>(all, k);
		 }).columns(numbers[4 * row], numbers[4 * row + 1], numbers[4 * row + 2], numbers[4 * row + 3]),
		 ...);
	}
	template <int... row>
	HEXMEMBRANE_INLINE void save(const V* numbers, StoredContact<double>* all, std::integer_sequence<int, row...>) const
	{
		(Rows<V>::ofColumns(numbers[4 * row], numbers[4 * row + 1], numbers[4 * row + 2], numbers[4 * row + 3])
		         .stored([&](int k) __attribute__((always_inline)) { return at<row>(all, k); }),
		 ...);
	}
	template <int... number>
	HEXMEMBRANE_INLINE void gather(const ContactStore& store, V* numbers, std::integer_sequence<int, number...>) const
	{
		const PairKind<double>* const table = store.table.data();
		const std::uint16_t* const kinds = store.kinds.data();
		for (int k = 0; k < laneCount<V>; ++k) {
			const auto* kind = reinterpret_cast<const double*>(table + kinds[index[k]]);
			((numbers[number][k] = kind[number]), ...);
		}
	}
};

} // namespace hexmembrane
