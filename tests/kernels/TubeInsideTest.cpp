// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "Support.hpp"
#include "kernels/membrane/TubeInside.hpp"

#include <random>

using namespace hexmembrane;

namespace {

/// Rings of given radius and height, two triangles between each two neighbours.
HexLattice ringsOf(int perRing, const std::vector<std::array<double, 2>>& profile)
{
	HexLattice tube;
	tube.perRing = perRing;
	for (const auto& [r, z] : profile)
		for (int i = 0; i < perRing; ++i) tube.positions.emplace_back(r * std::cos(2 * M_PI * i / perRing), r * std::sin(2 * M_PI * i / perRing), z);
	for (int k = 0; k + 1 < static_cast<int>(profile.size()); ++k)
		for (int i = 0; i < perRing; ++i) {
			const int j = (i + 1) % perRing, low = k * perRing, high = low + perRing;
			tube.triangles.push_back({low + i, low + j, high + i});
			tube.triangles.push_back({low + j, high + j, high + i});
		}
	return tube;
}

/// A tube with a collar that overhangs itself.
HexLattice collar() { return ringsOf(40, {{1, 0}, {1, 1}, {2, 0.8}, {2, 1.5}, {1, 1.2}, {1, 2}}); }

std::vector<Vec3> randomPoints(double reach, double low, double high, int count)
{
	std::mt19937 random(3);
	std::uniform_real_distribution<double> across(-reach, reach), up(low, high);
	std::vector<Vec3> points;
	for (int i = 0; i < count; ++i) points.emplace_back(across(random), across(random), up(random));
	return points;
}

} // namespace

TEST(TubeInside, solidAngleOfAFoldedTube)
{
	const HexLattice tube = collar();
	const TubeInside measure(tube.perRing, tube.triangles, tube.positions);
	for (const Vec3& p : {Vec3(0, 0, 0.1), Vec3(0.9, 0, 0.5), Vec3(0, -1.9, 1.0), Vec3(1.5, 0.2, 1.2), Vec3(0, 0, 1.9)})
		EXPECT_TRUE(measure.bySolidAngle(p)) << p.transpose();
	for (const Vec3& p : {Vec3(1.1, 0, 0.5), Vec3(1.5, 0, 0.85), Vec3(0, 1.9, 1.5), Vec3(0, 0, -0.1), Vec3(0, 0, 2.1), Vec3(5, 5, 1)})
		EXPECT_FALSE(measure.bySolidAngle(p)) << p.transpose();
}

TEST(TubeInside, nearTheAxisIsInside)
{
	const HexLattice tube = collar();
	const TubeInside measure(tube.perRing, tube.triangles, tube.positions);
	int near = 0, inside = 0;
	for (const Vec3& p : randomPoints(2.2, 0.01, 1.99, 400)) {
		near += measure.nearAxis(p);
		inside += measure.bySolidAngle(p);
		EXPECT_TRUE(!measure.nearAxis(p) || measure.bySolidAngle(p)) << p.transpose();
	}
	EXPECT_GT(near, 0.3 * inside);
	EXPECT_LT(near, inside);
}

TEST(TubeInside, longEdgesCutTheCorner)
{
	const HexLattice tube = ringsOf(3, {{1, 0}, {1, 1}});
	const TubeInside measure(3, tube.triangles, tube.positions);
	EXPECT_FALSE(measure.nearAxis({-0.6, 0, 0.5})); // every corner is further out than the point, which is outside
	EXPECT_FALSE(measure.bySolidAngle({-0.6, 0, 0.5}));
	EXPECT_FALSE(measure.inside({-0.6, 0, 0.5}));
	EXPECT_TRUE(measure.inside({0, 0, 0.5}));
}

TEST(TubeInside, crumpledTubeAgreesWithSolidAngles)
{
	HexLattice tube = support::smallTube();
	const double radius = tube.positions[0].head<2>().norm(), top = tube.positions.back()[2];
	support::shake(tube.positions, 5e-4, 4);
	const TubeInside measure(tube.perRing, tube.triangles, tube.positions);
	int outside = 0;
	for (const Vec3& p : randomPoints(1.1 * radius, 0.1 * top, 0.9 * top, 2000)) {
		const bool truly = measure.bySolidAngle(p);
		outside += !truly;
		EXPECT_EQ(measure.inside(p), truly) << p.transpose();
	}
	EXPECT_GT(outside, 400);
	EXPECT_LT(outside, 1600);
}
