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
		const Lanes3<Four> centre{lanes<Four>(a.centre[0]), lanes<Four>(a.centre[1]), lanes<Four>(a.centre[2])};
		Lanes3<Four> sum{};
		for (int p = start[i]; p < start[i + 1]; p += 4) {
			Lanes3<Four> particles;
			Four reach;
			Rows<Four>::loaded([&](int k) __attribute__((always_inline)) {
				return places[other[p + k]].centre.data();
			}).columns(particles.x, particles.y, particles.z, reach);
			reach += a.radius;
			const Lanes3<Four> branch = particles - centre;
			const Four square = dot(branch, branch), distance = squareRoot(square);
			const Four share = square > reach * reach ? Four{} : load<Four>(&kn[p]) * (reach - distance) / distance;
			const Lanes3<Four> force = share * branch;
			sum = sum + force;
			Rows<Four>::ofColumns(force.x, force.y, force.z, Four{}).stored([&](int k) __attribute__((always_inline)) {
				return forces[p + k].force.data();
			});
		}
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
		Four sum{};
		for (int q = particleStart[m]; q < particleStart[m + 1]; ++q) sum += load<Four>(pushes[at[q]].force.data());
		store(onParticle[m].force.data(), sum);
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
