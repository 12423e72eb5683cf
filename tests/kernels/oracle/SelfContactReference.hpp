// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/base/Vec3.hpp"

#include <algorithm>
#include <array>
#include <vector>

namespace hexmembrane {
namespace reference {

/// Contacts of all pairs of particles that no bond joins, tried one after the other.
struct SelfContacts {
	std::vector<Vec3> force;               ///< N
	double energy = 0;                     ///< J
	std::vector<std::array<int, 2>> pairs; ///< touching
};

inline SelfContacts selfContacts(const std::vector<std::array<int, 2>>& bonds, double radius, double kn, const std::vector<Vec3>& x)
{
	std::vector<std::array<int, 2>> bonded;
	for (const auto& bond : bonds) bonded.push_back({std::min(bond[0], bond[1]), std::max(bond[0], bond[1])});
	std::sort(bonded.begin(), bonded.end());
	SelfContacts found;
	found.force.assign(x.size(), Vec3::Zero());
	for (int i = 0; i < int(x.size()); ++i)
		for (int j = i + 1; j < int(x.size()); ++j) {
			const double d = (x[j] - x[i]).norm(), overlap = 2 * radius - d;
			if (!(overlap > 0) || std::binary_search(bonded.begin(), bonded.end(), std::array<int, 2>{i, j})) continue;
			found.pairs.push_back({i, j});
			found.energy += 0.5 * kn * overlap * overlap;
			const Vec3 push = kn * overlap * (x[j] - x[i]) / d;
			found.force[i] -= push;
			found.force[j] += push;
		}
	return found;
}

} // namespace reference
} // namespace hexmembrane
