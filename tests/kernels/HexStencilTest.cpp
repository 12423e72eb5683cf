// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/base/Vec3.hpp"
#include "kernels/membrane/HexStencil.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

using namespace hexmembrane;

namespace {

/// Touching spheres of diameter 1 on a tube, ring by ring, odd rings half a spacing on: what the indices stand for.
std::vector<Vec3> touchingSpheres(int perRing, int rings)
{
	const double radius = 0.5 / std::sin(M_PI / perRing), half = M_PI / perRing;
	// a neighbour above is half a spacing aside on the circle and at distance 1
	const double rise = std::sqrt(1 - std::pow(2 * radius * std::sin(0.5 * half), 2));
	std::vector<Vec3> x;
	for (int k = 0; k < rings; ++k)
		for (int i = 0; i < perRing; ++i) {
			const double angle = 2 * half * i + (k % 2 ? half : 0);
			x.emplace_back(radius * std::cos(angle), radius * std::sin(angle), rise * k);
		}
	return x;
}

} // namespace

TEST(HexStencil, bondsAreAllPairsThatTouch)
{
	for (const int n : {6, 7, 12})
		for (const int rings : {1, 2, 5}) {
			const HexStencil tube{n, rings};
			const auto x = touchingSpheres(n, rings);
			std::set<std::set<int>> touching, bonds;
			for (int p = 0; p < tube.particles(); ++p)
				for (int q = 0; q < p; ++q)
					if ((x[p] - x[q]).norm() < 1 + 1e-9) touching.insert({p, q});
			int count = 0;
			for (int family = 0; family < 3; ++family) {
				EXPECT_EQ(tube.familyStart(family), count) << "a family follows the one before";
				for (int k = 0; k < tube.familyRows(family); ++k)
					for (int i = 0; i < n; ++i, ++count) {
						const auto far = HexStencil::farEnd(family, k);
						bonds.insert({tube.at(k, i), tube.at(k + far[0], i + far[1])});
					}
			}
			EXPECT_EQ(bonds, touching) << n << " x " << rings;
			EXPECT_EQ(count, tube.bondCount());
			EXPECT_EQ(std::size_t(count), bonds.size()) << "each once";
		}
}

TEST(HexStencil, indicesRunOverByOneTurn)
{
	const HexStencil tube{7, 3};
	EXPECT_EQ(tube.particles(), 21);
	EXPECT_EQ(tube.at(2, 7), 14);
	EXPECT_EQ(tube.at(2, -1), 20);
	EXPECT_EQ(tube.at(1, 3), 10);
}

TEST(HexStencil, rightIsLeftOfTheNextOne)
{
	for (int k = 0; k < 4; ++k) EXPECT_EQ(HexStencil::right(k), HexStencil::left(k) + 1);
	EXPECT_EQ(HexStencil::left(0), -1);
	EXPECT_EQ(HexStencil::left(1), 0);
}
