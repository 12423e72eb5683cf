// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "ContactList.hpp"

#include <algorithm>
#include <cmath>

namespace hexmembrane {

int ContactList::find(int i, int j) const
{
	const auto from = pairs.other.begin() + pairs.start[i], to = pairs.other.begin() + pairs.start[i + 1];
	const auto found = std::lower_bound(from, to, j);
	return found != to && *found == j ? int(found - pairs.other.begin()) : -1;
}

bool ContactList::restore(int i, int j, const ContactMemory& memory, unsigned char bit)
{
	const bool swapped = i > j;
	const int p = swapped ? find(j, i) : find(i, j);
	if (p < 0) return false;
	memories[p] = memory;
	bits[p] = bit;
	if (swapped) { // what the second body feels is now what the first one felt
		memories[p].shear = -memory.shear;
		memories[p].moment = -memory.moment;
		memories[p].normal = -memory.normal;
	}
	return true;
}

void ContactList::renewLaws(const LawOfPair& law)
{
	for (std::size_t i = 0; i + 1 < pairs.start.size(); ++i)
		for (int p = pairs.start[i]; p < pairs.start[i + 1]; ++p) {
			const ContactLaw before = memories[p].law;
			memories[p].law = law(int(i), pairs.other[p]);
			memories[p].law.tensileStrength = before.tensileStrength;
			memories[p].law.shearStrength = before.shearStrength;
		}
}

void ContactList::rebuild(NearPairs found, const std::vector<int>& newIndex, const LawOfPair& law)
{
	ContactList old;
	std::swap(old.pairs, pairs);
	old.memories.swap(memories);
	old.bits.swap(bits);

	pairs = std::move(found);
	usedRows = int(pairs.start.size()) - 1;
	while (usedRows > 0 && pairs.start[usedRows - 1] == pairs.start[usedRows]) --usedRows;
	memories.resize(pairs.other.size());
	bits.assign(pairs.other.size(), 0);
	const long rows = long(pairs.start.size()) - 1;
#pragma omp parallel for schedule(static)
	for (long i = 0; i < rows; ++i)
		for (int p = pairs.start[i]; p < pairs.start[i + 1]; ++p) memories[p] = {Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), law(int(i), pairs.other[p])};
	old.forEachTouching([&](int i, int j, const ContactMemory& memory, unsigned char bit) { restore(newIndex[i], newIndex[j], memory, bit); });
}

SweepSums ContactList::sweepRun(int from, int to, int owned, const std::vector<Place>& places, const std::vector<Motion>& motions, Load* loads, Load* spill,
                                double dt)
{
	SweepSums sums;
	for (int i = from; i < to; ++i) {
		const Place a = places[i];
		const Motion& motion = motions[i];
		Load own = noLoad();
		for (int p = pairs.start[i]; p < pairs.start[i + 1]; ++p) {
			const int j = pairs.other[p];
			const Place& b = places[j];
			const Vec3 branch = b.centre - a.centre;
			const double square = branch.squaredNorm(), reach = a.radius + b.radius;
			if (square > reach * reach && !bits[p]) continue;

			const double distance = std::sqrt(square), u = reach - distance;
			const Vec3 normal = branch / distance;
			const double arm1 = a.radius - 0.5 * u, arm2 = b.radius - 0.5 * u;
			Vec3 force;
			if (!advanceMemory(memories[p], bits[p], u, normal, motion, arm1 * normal, motions[j], -arm2 * normal, dt, force, sums)) continue;
			const Vec3 turning = normal.cross(memories[p].shear);
			own.force -= force;
			own.torque -= arm1 * turning + memories[p].moment;
			Load& other = j < owned ? loads[j] : spill[j - owned];
			other.force += force;
			other.torque += memories[p].moment - arm2 * turning;
		}
		loads[i] += own;
	}
	return sums;
}

SweepSums ContactList::sweep(const std::vector<Place>& places, const std::vector<Motion>& motions, std::vector<Load>& loads, double dt, int threads)
{
	const int rows = usedRows, all = int(places.size());
	if (rows <= 0) return {};
	if (threads <= 1) return sweepRun(0, rows, all, places, motions, loads.data(), nullptr, dt);

	// runs of rows with about the same number of pairs
	std::vector<int> border(threads + 1, rows);
	border[0] = 0;
	for (int t = 1; t < threads; ++t)
		border[t] =
		        int(std::lower_bound(pairs.start.begin(), pairs.start.begin() + rows, long(pairs.other.size()) * t / threads) - pairs.start.begin());
	spills.resize(threads);
	std::vector<SweepSums> sums(threads);
#pragma omp parallel num_threads(threads)
	{
#pragma omp for schedule(static, 1)
		for (int t = 0; t < threads; ++t) {
			int last = border[t + 1];
			for (int p = pairs.start[border[t]]; p < pairs.start[border[t + 1]]; ++p) last = std::max(last, pairs.other[p] + 1);
			spills[t].assign(last - border[t + 1], noLoad());
			sums[t] = sweepRun(border[t], border[t + 1], border[t + 1], places, motions, loads.data(), spills[t].data(), dt);
		}
		// spills reach upwards only: the spheres of run t may have some from every run before it
#pragma omp for schedule(static, 1)
		for (int t = 1; t <= threads; ++t) {
			const int from = t < threads ? border[t] : rows, to = t < threads ? border[t + 1] : all;
			for (int s = 0; s < t; ++s) {
				const int spillStart = border[s + 1], spillEnd = spillStart + int(spills[s].size());
				for (int i = std::max(from, spillStart); i < std::min(to, spillEnd); ++i) loads[i] += spills[s][i - spillStart];
			}
		}
	}
	SweepSums sum;
	for (const auto& part : sums) sum += part;
	return sum;
}

double ContactList::energy(const std::vector<Place>& places) const
{
	double sum = 0;
	forEachTouching([&](int i, int j, const ContactMemory& memory, unsigned char) {
		const double u = places[i].radius + places[j].radius - (places[j].centre - places[i].centre).norm();
		sum += contactEnergy(memory.law, memory.law.kn * u, memory.shear, memory.moment);
	});
	return sum;
}

} // namespace hexmembrane
