// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/base/Vec3.hpp"

#include <array>
#include <vector>

namespace hexmembrane {
namespace reference {

/// x less the mean of its six neighbours for each particle of a list of bonds; zero for one that has not six.
inline std::vector<Vec3> departures(const std::vector<std::array<int, 2>>& bonds, const std::vector<Vec3>& x)
{
	std::vector<std::vector<int>> neighbours(x.size());
	for (const auto& bond : bonds) {
		neighbours[bond[0]].push_back(bond[1]);
		neighbours[bond[1]].push_back(bond[0]);
	}
	std::vector<Vec3> b(x.size(), Vec3::Zero());
	for (size_t i = 0; i < x.size(); ++i) {
		if (neighbours[i].size() != 6) continue;
		b[i] = x[i];
		for (const int j : neighbours[i]) b[i] -= x[j] / 6;
	}
	return b;
}

/// Bending energy k_b/2 sum |B x - B rest|^2 (J).
inline double bendingEnergy(const std::vector<std::array<int, 2>>& bonds, double spring, const std::vector<Vec3>& x, const std::vector<Vec3>& rest)
{
	const std::vector<Vec3> b = departures(bonds, x), b0 = departures(bonds, rest);
	double sum = 0;
	for (size_t i = 0; i < x.size(); ++i) sum += 0.5 * spring * (b[i] - b0[i]).squaredNorm();
	return sum;
}

/// Minus its gradient, one particle's share after the other (N).
inline std::vector<Vec3> bendingForces(const std::vector<std::array<int, 2>>& bonds, double spring, const std::vector<Vec3>& x, const std::vector<Vec3>& rest)
{
	const std::vector<Vec3> b = departures(bonds, x), b0 = departures(bonds, rest);
	std::vector<Vec3> force(x.size(), Vec3::Zero());
	for (size_t i = 0; i < x.size(); ++i) force[i] -= spring * (b[i] - b0[i]);
	for (const auto& bond : bonds) {
		force[bond[0]] += spring / 6 * (b[bond[1]] - b0[bond[1]]);
		force[bond[1]] += spring / 6 * (b[bond[0]] - b0[bond[0]]);
	}
	return force;
}

} // namespace reference
} // namespace hexmembrane
