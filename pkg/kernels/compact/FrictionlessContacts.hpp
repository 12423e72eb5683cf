// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/compact/SphereArrays.hpp"

#include <functional>
#include <vector>

namespace hexmembrane {

/// Frictionless contacts of grains with the membrane's particles: kn u along the line of centres, nothing remembered, nothing turned.
///
/// The list stands by grains and, a second time as indices, by particles. Forces of the pairs are stored and then gathered by particle: the same to the
/// last bit for any number of threads. A grain's pairs are taken four at a time, whether they touch or not; what is missing to four are pairs without stiffness.
class FrictionlessContacts {
public:
	struct Pair {
		int grain, particle; ///< particle: its index among all spheres
	};
	/// Takes over the pairs, sorted by particle and then by grain.
	/// \param grains number of grains; the particles' indices follow them \param particles number of particles
	void rebuild(const std::vector<Pair>& found, int grains, int particles, const std::function<double(int, int)>& stiffness);

	/// Adds what the particles do to the grains from .. to - 1 to `loads`.
	void sweep(int from, int to, const std::vector<Place>& places, std::vector<Load>& loads);
	/// Writes what the grains do to the particles from .. to - 1 (their indices among all spheres) to `onParticle`, when all grains are swept.
	void gather(int from, int to, std::vector<PaddedForce>& onParticle) const;

	double energy(const std::vector<Place>& places) const;
	/// Calls visit(grain, particle, kn, overlap, normal) for every touching pair; normal from grain to particle.
	template <typename Visit>
	void forEachTouching(const std::vector<Place>& places, Visit&& visit) const
	{
		for (std::size_t i = 0; i < length.size(); ++i)
			for (int p = start[i]; p < start[i] + length[i]; ++p) {
				const Vec3 branch = places[other[p]].centre - places[i].centre;
				const double distance = branch.norm(), u = places[i].radius + places[other[p]].radius - distance;
				if (u >= 0) visit(int(i), other[p], kn[p], u, Vec3(branch / distance));
			}
	}
	/// Listed pairs.
	int size() const { return int(place.size()); }

private:
	void sweepRows(int from, int to, const Place* places, Load* loads);
	void gatherRows(int from, int to, PaddedForce* onParticle) const;

	int firstParticle = 0;
	std::vector<int> start, length, other; ///< by grain, each row filled up to fours
	std::vector<double> kn;
	std::vector<PaddedForce> forces;       ///< on the particle
	std::vector<int> particleStart, place; ///< by particle: where its pairs stand
};

} // namespace hexmembrane
