// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/compact/SphereArrays.hpp"

#include <cstdint>
#include <vector>

namespace hexmembrane {

/// A contact as it is stored, one and a half cache lines, or four of them as lanes: a sweep over many contacts waits for memory, so what can be had otherwise
/// (the parameters of its kind) is not in it. Filled up to rows of four numbers.
template <class V> struct StoredContact {
	ContactMemory<V> memory;
	PairSprings<V> springs;

	static constexpr int numbers = 12, rows = numbers / 4;
};
static_assert(sizeof(StoredContact<double>) == StoredContact<double>::numbers * sizeof(double) && StoredContact<double>::numbers % 4 == 0,
              "a contact is read as rows of four doubles");
static_assert(sizeof(StoredContact<Lanes>) == StoredContact<double>::numbers * sizeof(Lanes), "four contacts are read as lanes in the same order");

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
	/// Memory, bits and strengths of a bond; the other parameters stay those of setSprings().
	void put(int p, const Contact& contact);
	Contact get(int p) const;

	std::size_t size() const { return contacts.size(); }

	std::vector<StoredContact<double>> contacts;
	std::vector<unsigned char> bits;
	std::vector<std::uint16_t> kinds;
	std::vector<PairKind<double>> table;

private:
	std::vector<BondStrengths> strengths; ///< of bonds; empty: there has been no bond
};

/// Where four contacts of a store stand.
struct FourContacts {
	const int* index;

	/// Four records of so many rows of doubles become lanes, and back.
	template <class Record> HEXMEMBRANE_INLINE void load(const Record* all, Lanes* lanes) const
	{
		const auto* const a = reinterpret_cast<const double*>(all + index[0]);
		const auto* const b = reinterpret_cast<const double*>(all + index[1]);
		const auto* const c = reinterpret_cast<const double*>(all + index[2]);
		const auto* const d = reinterpret_cast<const double*>(all + index[3]);
		for (int row = 0; row < Record::rows; ++row) {
			Lanes w = load4(a + 4 * row), x = load4(b + 4 * row), y = load4(c + 4 * row), z = load4(d + 4 * row);
			transpose(w, x, y, z);
			lanes[4 * row] = w;
			lanes[4 * row + 1] = x;
			lanes[4 * row + 2] = y;
			lanes[4 * row + 3] = z;
		}
	}
	template <class Record> HEXMEMBRANE_INLINE void store(const Lanes* lanes, Record* all) const
	{
		auto* const a = reinterpret_cast<double*>(all + index[0]);
		auto* const b = reinterpret_cast<double*>(all + index[1]);
		auto* const c = reinterpret_cast<double*>(all + index[2]);
		auto* const d = reinterpret_cast<double*>(all + index[3]);
		for (int row = 0; row < Record::rows; ++row) {
			Lanes w = lanes[4 * row], x = lanes[4 * row + 1], y = lanes[4 * row + 2], z = lanes[4 * row + 3];
			transpose(w, x, y, z);
			store4(a + 4 * row, w);
			store4(b + 4 * row, x);
			store4(c + 4 * row, y);
			store4(d + 4 * row, z);
		}
	}

	HEXMEMBRANE_INLINE StoredContact<Lanes> contacts(const ContactStore& store) const
	{
		Lanes lanes[StoredContact<double>::numbers];
		load(store.contacts.data(), lanes);
		StoredContact<Lanes> four;
		__builtin_memcpy(&four, lanes, sizeof four);
		return four;
	}
	HEXMEMBRANE_INLINE void put(const StoredContact<Lanes>& four, ContactStore& store) const
	{
		Lanes lanes[StoredContact<double>::numbers];
		__builtin_memcpy(lanes, &four, sizeof four);
		this->store(lanes, store.contacts.data());
	}
	HEXMEMBRANE_INLINE PairKind<Lanes> kinds(const ContactStore& store) const
	{
		static_assert(sizeof(PairKind<Lanes>) == 4 * sizeof(PairKind<double>), "a kind is its numbers");
		const double* all[4];
		for (int k = 0; k < 4; ++k) all[k] = reinterpret_cast<const double*>(store.table.data() + store.kinds[index[k]]);
		PairKind<Lanes> four;
		for (std::size_t n = 0; n < sizeof(PairKind<double>) / sizeof(double); ++n) {
			const Lanes value{all[0][n], all[1][n], all[2][n], all[3][n]};
			__builtin_memcpy(reinterpret_cast<Lanes*>(&four) + n, &value, sizeof value);
		}
		return four;
	}
};

} // namespace hexmembrane
