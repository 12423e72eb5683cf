// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/compact/ContactStore.hpp"
#include "kernels/compact/ThreadPartition.hpp"
#include "kernels/base/CellGrid.hpp"

#include <algorithm>
#include <functional>
#include <vector>

namespace hexmembrane {

/// Contacts of spheres with spheres by the full law, over a neighbour list that holds each pair once, with the first index the lower.
///
/// With one thread loads are added straight to both spheres. With several, what falls on spheres beyond a thread's rows goes to a spill of its own, and the
/// owner adds the spills in the order of the threads: the same bits for the same number of threads.
class PairContacts {
public:
	using OfPair = std::function<SpringsOfKind(int, int)>;

	/// Takes over a new list. Memories of contacts that touch in the old list go to their pairs in the new one (the others are dropped: a touching pair is
	/// always in a new list); `springs` makes the parameters of all pairs.
	/// \param kinds parameters by kind \param newIndex where each sphere of the old numbering stands in the new one
	/// \return what springs held that are not there any more (J)
	ContactWorks rebuild(NearPairs found, const std::vector<int>& newIndex, const std::vector<PairKind<double>>& kinds, const OfPair& springs);

	/// Where the pairs of each sphere begin, one more entry than spheres.
	const std::vector<int>& rowStart() const { return pairs.start; }
	/// Makes room for what the threads spill. Once for each list and division.
	void divide(const ThreadPartition& runs);
	/// One step of the pairs in thread t's rows; what it does to the spheres of other threads waits for addSpills().
	SweepSums sweep(const ThreadPartition& runs, int t, const std::vector<Place>& places, const std::vector<Motion>& motions, std::vector<Load>& loads,
	                double dt);
	/// What all threads spilled on the spheres of thread t, when all have swept.
	void addSpills(const ThreadPartition& runs, int t, std::vector<Load>& loads) const;

	/// Elastic energy of all contacts (J).
	double energy(const std::vector<Place>& places) const;
	/// Other parameters by kind, with friction and rolling resistance where they were.
	void setKinds(const std::vector<PairKind<double>>& kinds) { store.table = kinds; }

	/// Calls visit(i, j, contact) for every touching pair.
	template <typename Visit>
	void forEachTouching(Visit&& visit) const
	{
		for (std::size_t i = 0; i + 1 < pairs.start.size(); ++i)
			for (int p = pairs.start[i]; p < pairs.start[i + 1]; ++p)
				if (store.bits[p]) visit(int(i), pairs.other[p], store.get(p));
	}
	/// Calls visit(i, j) for every listed pair.
	template <typename Visit>
	void forEachPair(Visit&& visit) const
	{
		for (std::size_t p = 0; p < first.size(); ++p) visit(first[p], pairs.other[p]);
	}
	/// Puts a contact into the list; parameters but the strengths of its bond are those that the list has. \return false when the pair is not in it
	bool restore(int i, int j, const Contact& contact);
	bool has(int i, int j) const { return find(std::min(i, j), std::max(i, j)) >= 0; }

	int size() const { return int(pairs.other.size()); }

private:
	int find(int i, int j) const;
	NearPairs pairs;
	std::vector<int> first; ///< first sphere of each pair
	ContactStore store;
	std::vector<std::vector<Load>> spills; ///< one a thread, from the end of its rows upwards
};

} // namespace hexmembrane
