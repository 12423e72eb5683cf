// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/compact/PairContacts.hpp"

#include "kernels/compact/PairSweep.hpp"

#include <algorithm>
#include <cmath>

namespace hexmembrane {

int PairContacts::find(int i, int j) const
{
	const auto from = pairs.other.begin() + pairs.start[i], to = pairs.other.begin() + pairs.start[i + 1];
	const auto found = std::lower_bound(from, to, j);
	return found != to && *found == j ? int(found - pairs.other.begin()) : -1;
}

bool PairContacts::restore(int i, int j, const Contact& contact)
{
	const bool swapped = i > j;
	const int p = swapped ? find(j, i) : find(i, j);
	if (p < 0) return false;
	store.put(p, swapped ? contact.swapped() : contact);
	return true;
}

ContactWorks PairContacts::rebuild(NearPairs found, const std::vector<int>& newIndex, const std::vector<PairKind<double>>& kinds, const OfPair& springs)
{
	PairContacts old;
	std::swap(old.pairs, pairs);
	std::swap(old.store, store);

	pairs = std::move(found);
	first.resize(pairs.other.size());
	store.start(pairs.other.size(), kinds);
	const long rows = long(pairs.start.size()) - 1;
#pragma omp parallel for schedule(static)
	for (long i = 0; i < rows; ++i)
		for (int p = pairs.start[i]; p < pairs.start[i + 1]; ++p) {
			first[p] = int(i);
			store.setSprings(p, springs(int(i), pairs.other[p]));
		}
	ContactWorks lost;
	old.forEachTouching([&](int i, int j, const Contact& contact) {
		const int p = find(std::min(newIndex[i], newIndex[j]), std::max(newIndex[i], newIndex[j]));
		if (p >= 0) lost += worksOfLostSprings(contact.memory, contact.law, store.law(p));
		restore(newIndex[i], newIndex[j], contact);
	});
	return lost;
}

void PairContacts::divide(const ThreadPartition& runs)
{
	spills.resize(runs.threads());
	for (int t = 0; t < runs.threads(); ++t) {
		const auto [from, to] = runs.rowsOf(t);
		int end = to;
		for (int p = pairs.start[from]; p < pairs.start[to]; ++p) end = std::max(end, pairs.other[p] + 1);
		spills[t].resize(end - to);
	}
}

SweepSums PairContacts::sweep(const ThreadPartition& runs, int t, const std::vector<Place>& places, const std::vector<Motion>& motions,
                              std::vector<Load>& loads, double dt)
{
	const auto [from, to] = runs.rowsOf(t);
	std::vector<Load>& spill = spills[t];
	std::fill(spill.begin(), spill.end(), noLoad());
	return sweepPairs({first.data(), pairs.other.data(), &store, places.data(), motions.data(), loads.data(), spill.data(), to, pairs.start[from],
	                   pairs.start[to], dt});
}

void PairContacts::addSpills(const ThreadPartition& runs, int t, std::vector<Load>& loads) const
{
	for (int s = 0; s < runs.threads(); ++s) {
		const int begin = runs.rowsOf(s).to, end = begin + int(spills[s].size());
		runs.forOwned(t, [&](int from, int to) {
			for (int i = std::max(from, begin); i < std::min(to, end); ++i) loads[i] += spills[s][i - begin];
		});
	}
}

double PairContacts::energy(const std::vector<Place>& places) const
{
	double sum = 0;
	forEachTouching([&](int i, int j, const Contact& contact) {
		const double u = places[i].radius + places[j].radius - (places[j].centre - places[i].centre).norm();
		sum += contactEnergy(contact.law, contact.law.kn * u, contact.memory);
	});
	return sum;
}

} // namespace hexmembrane
