// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/membrane/MembraneTension.hpp"

#include "kernels/membrane/RadialForce.hpp"

namespace hexmembrane {

std::vector<Vec3> bondForces(const BondForce& bonds, const BondState& state)
{
	const HexStencil& tube = bonds.lattice();
	std::vector<Vec3> onFirst(tube.bondCount(), Vec3::Zero());
	for (int family = 0; family < 3; ++family)
		for (int k = 0; k < tube.familyRows(family); ++k) {
			const auto far = HexStencil::farEnd(family, k);
			for (int i = 0; i < tube.perRing; ++i) {
				const int b = tube.familyStart(family) + k * tube.perRing + i;
				const Vec3 branch = bonds.position.get(k + far[0], i + far[1]) - bonds.position.get(k, i);
				const double length = branch.norm();
				if (length > 0) onFirst[b] = bonds.normalForce(state, b) / length * branch;
				if (!state.shear.empty()) onFirst[b] += state.shear[b];
			}
		}
	return onFirst;
}

std::vector<double> axialTension(const HexStencil& tube, const std::vector<Vec3>& x, const std::vector<Vec3>& onFirst, const std::vector<double>& heights)
{
	std::vector<double> sums(heights.size(), 0);
	for (int family = 0; family < 3; ++family)
		for (int k = 0; k < tube.familyRows(family); ++k) {
			const auto far = HexStencil::farEnd(family, k);
			for (int i = 0; i < tube.perRing; ++i) {
				const double first = x[tube.at(k, i)][2], second = x[tube.at(k + far[0], i + far[1])][2];
				const double up = onFirst[tube.familyStart(family) + k * tube.perRing + i][2];
				for (size_t h = 0; h < heights.size(); ++h) {
					const bool firstBelow = first < heights[h], secondBelow = second < heights[h];
					if (firstBelow != secondBelow) sums[h] += firstBelow ? up : -up;
				}
			}
		}
	return sums;
}

std::vector<double> axialPull(const std::vector<Vec3>& x, const std::vector<Vec3>& f, const std::vector<double>& heights)
{
	std::vector<double> sums(heights.size(), 0);
	for (size_t i = 0; i < x.size(); ++i)
		for (size_t h = 0; h < heights.size(); ++h)
			if (!(x[i][2] < heights[h])) sums[h] -= f[i][2];
	return sums;
}

std::vector<RingLoad> ringLoads(const HexStencil& tube, const std::vector<Vec3>& x, const std::vector<Vec3>& f, double sphereRadius)
{
	std::vector<RingLoad> loads;
	for (int k = 0; k < tube.rings; ++k) {
		const Vec3 centre = ringShape(tube, x, k).centre;
		RingLoad load{0, tube.perRing * particleArea(tube, x, k, sphereRadius, AreaRule::tributary)};
		for (int i = 0; i < tube.perRing; ++i) load.force += f[tube.at(k, i)].dot(towardAxis(x[tube.at(k, i)], centre));
		loads.push_back(load);
	}
	return loads;
}

} // namespace hexmembrane
