// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "Support.hpp"
#include "kernels/membrane/RadialForce.hpp"

using namespace hexmembrane;

TEST(RadialForce, tributaryAreaOfAFlatLatticeIsTwoRootThreeRSquared)
{
	const HexLattice l = makeHexLattice({1., 0.05, 0.002, Placement::outside, 2, 2});
	const double area = particleArea(l, l.positions, 5, l.sphereRadius, AreaRule::tributary);
	// nearly flat: the inner surface is R/Rc shorter, the ring's polygon (pi/n)^2/6
	EXPECT_NEAR(area / (2 * std::sqrt(3.) * l.sphereRadius * l.sphereRadius) * l.centreRadius / l.innerRadius, 1, 1e-5);
}

TEST(RadialForce, cubeIsTheStudysRule)
{
	const HexLattice l = makeHexLattice({1., 0.05, 0.002, Placement::centred, 2, 2});
	const double cube = particleArea(l, l.positions, 5, l.sphereRadius, AreaRule::cube);
	EXPECT_DOUBLE_EQ(cube, 4 * 0.002 * 0.002);
	EXPECT_NEAR(cube / (2 * std::sqrt(3.) * 0.002 * 0.002), 1.1547, 1e-4);
}

TEST(RadialForce, ringShapeFollowsAShiftedRing)
{
	HexLattice l = support::smallTube();
	for (int i = 0; i < l.perRing; ++i) l.positions[l.at(2, i)] += Vec3(0.003, -0.001, 0.0005);
	const RingShape shape = ringShape(l, l.positions, 2);
	EXPECT_NEAR(shape.radius, l.centreRadius, 1e-14);
	EXPECT_NEAR(shape.centre[0], 0.003, 1e-14);
	EXPECT_NEAR(shape.centre[1], -0.001, 1e-14);
}

TEST(RadialForce, everyRingOfTheTubeAddsUpToItsSurface)
{
	const HexLattice l = support::smallTube();
	double sum = 0;
	for (int k = 0; k < l.rings; ++k) sum += l.perRing * particleArea(l, l.positions, k, l.sphereRadius, AreaRule::tributary);
	EXPECT_NEAR(sum / (2 * M_PI * l.innerRadius * l.rings * l.ringSpacing), 1, 1e-12);
}

TEST(RadialForce, directionIsHorizontalUnitAndSafeOnTheAxis)
{
	const Vec3 n = towardAxis({3, 4, 7}, {0, 0, 1});
	EXPECT_NEAR((n - Vec3(-0.6, -0.8, 0)).norm(), 0, 1e-15);
	EXPECT_EQ(towardAxis({1, 1, 5}, {1, 1, 0}).norm(), 0);
}
