// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "NormalList.hpp"

#include <algorithm>
#include <cmath>

namespace hexmembrane {

void NormalList::rebuild(const std::vector<Pair>& found, int grains, int particles, const std::function<double(int, int)>& stiffness)
{
	firstParticle = grains;
	start.assign(grains + 1, 0);
	particleStart.assign(particles + 1, 0);
	for (const Pair& pair : found) {
		++start[pair.grain + 1];
		++particleStart[pair.particle - grains + 1];
	}
	for (int i = 0; i < grains; ++i) start[i + 1] += start[i];
	for (int m = 0; m < particles; ++m) particleStart[m + 1] += particleStart[m];
	other.resize(found.size());
	kn.resize(found.size());
	force.resize(found.size());
	place.resize(found.size());
	std::vector<int> next(start.begin(), start.end() - 1);
	for (std::size_t q = 0; q < found.size(); ++q) { // they come by particle
		const int p = next[found[q].grain]++;
		other[p] = found[q].particle;
		place[q] = p;
	}
	renewStiffness(stiffness);
}

void NormalList::renewStiffness(const std::function<double(int, int)>& stiffness)
{
	for (std::size_t i = 0; i + 1 < start.size(); ++i)
		for (int p = start[i]; p < start[i + 1]; ++p) kn[p] = stiffness(int(i), other[p]);
}

void NormalList::sweep(int from, int to, const std::vector<Place>& places, std::vector<Load>& loads)
{
	for (int i = from; i < std::min(to, firstParticle); ++i) {
		if (start[i] == start[i + 1]) continue;
		const Place a = places[i];
		Vec3 sum = Vec3::Zero();
		for (int p = start[i]; p < start[i + 1]; ++p) {
			const Place& b = places[other[p]];
			const Vec3 branch = b.centre - a.centre;
			const double square = branch.squaredNorm(), reach = a.radius + b.radius;
			if (square > reach * reach) {
				force[p] = Vec3::Zero();
				continue;
			}
			const double distance = std::sqrt(square);
			force[p] = kn[p] * (reach - distance) / distance * branch;
			sum += force[p];
		}
		loads[i].force -= sum;
	}
}

void NormalList::gather(int from, int to, std::vector<Vec3>& onParticle) const
{
	for (int m = std::max(from, firstParticle) - firstParticle; m < to - firstParticle; ++m) {
		Vec3 sum = Vec3::Zero();
		for (int q = particleStart[m]; q < particleStart[m + 1]; ++q) sum += force[place[q]];
		onParticle[m] = sum;
	}
}

double NormalList::energy(const std::vector<Place>& places) const
{
	double sum = 0;
	forEachTouching(places, [&](int, int, double k, double u, const Vec3&) { sum += 0.5 * k * u * u; });
	return sum;
}

} // namespace hexmembrane
