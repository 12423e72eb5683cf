// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/compact/FrictionlessContacts.hpp"

#include "kernels/base/Lanes.hpp"

#include <algorithm>
#include <cmath>

namespace hexmembrane {

void FrictionlessContacts::rebuild(const std::vector<Pair>& found, int grains, int particles, const std::function<double(int, int)>& stiffness)
{
	firstParticle = grains;
	length.assign(grains, 0);
	start.assign(grains + 1, 0);
	particleStart.assign(particles + 1, 0);
	for (const Pair& pair : found) {
		++length[pair.grain];
		++particleStart[pair.particle - grains + 1];
	}
	for (int i = 0; i < grains; ++i) start[i + 1] = start[i] + (length[i] + 3) / 4 * 4;
	for (int m = 0; m < particles; ++m) particleStart[m + 1] += particleStart[m];
	other.resize(start[grains]);
	kn.resize(start[grains]);
	forces.resize(start[grains]);
	place.resize(found.size());
	std::vector<int> next(start.begin(), start.end() - 1);
	for (std::size_t q = 0; q < found.size(); ++q) { // they come by particle
		const int p = next[found[q].grain]++;
		other[p] = found[q].particle;
		place[q] = p;
	}
	for (int i = 0; i < grains; ++i)
		for (int p = next[i]; p < start[i + 1]; ++p) {
			other[p] = other[next[i] - 1];
			kn[p] = 0;
		}
	for (std::size_t i = 0; i < length.size(); ++i)
		for (int p = start[i]; p < start[i] + length[i]; ++p) kn[p] = stiffness(int(i), other[p]);
}

HEXMEMBRANE_WIDEST void FrictionlessContacts::sweepRows(int from, int to, const Place* places, Load* loads)
{
	for (int i = from; i < to; ++i) {
		if (start[i] == start[i + 1]) continue;
		const Place& a = places[i];
		const Lanes3 centre{lanes(a.centre[0]), lanes(a.centre[1]), lanes(a.centre[2])};
		Lanes3 sum{lanes(0), lanes(0), lanes(0)};
		for (int p = start[i]; p < start[i + 1]; p += 4) {
			const auto particle = [&](int k) __attribute__((always_inline)) { return load4(places[other[p + k]].centre.data()); };
			Lanes3 particles{particle(0), particle(1), particle(2)};
			Lanes reach = particle(3);
			transpose(particles.x, particles.y, particles.z, reach);
			reach += a.radius;
			const Lanes3 branch = particles - centre;
			const Lanes square = dot(branch, branch), distance = squareRoot(square);
			const Lanes share = square > reach * reach ? lanes(0) : load4(&kn[p]) * (reach - distance) / distance;
			Lanes3 force = share * branch;
			sum = sum + force;
			Lanes unused = lanes(0);
			transpose(force.x, force.y, force.z, unused);
			store4(forces[p].force.data(), force.x);
			store4(forces[p + 1].force.data(), force.y);
			store4(forces[p + 2].force.data(), force.z);
			store4(forces[p + 3].force.data(), unused);
		}
		const auto total = [](Lanes v) __attribute__((always_inline)) { return (v[0] + v[1]) + (v[2] + v[3]); };
		loads[i].force -= Vec3(total(sum.x), total(sum.y), total(sum.z));
	}
}

void FrictionlessContacts::sweep(int from, int to, const std::vector<Place>& places, std::vector<Load>& loads)
{
	sweepRows(from, std::min(to, firstParticle), places.data(), loads.data());
}

HEXMEMBRANE_WIDEST void FrictionlessContacts::gatherRows(int from, int to, PaddedForce* onParticle) const
{
	const int* const at = place.data();
	const PaddedForce* const pushes = forces.data();
	for (int m = from; m < to; ++m) {
		Lanes sum = lanes(0);
		for (int q = particleStart[m]; q < particleStart[m + 1]; ++q) sum += load4(pushes[at[q]].force.data());
		store4(onParticle[m].force.data(), sum);
	}
}

void FrictionlessContacts::gather(int from, int to, std::vector<PaddedForce>& onParticle) const
{
	gatherRows(std::max(from, firstParticle) - firstParticle, to - firstParticle, onParticle.data());
}

double FrictionlessContacts::energy(const std::vector<Place>& places) const
{
	double sum = 0;
	forEachTouching(places, [&](int, int, double k, double u, const Vec3&) { sum += 0.5 * k * u * u; });
	return sum;
}

} // namespace hexmembrane
