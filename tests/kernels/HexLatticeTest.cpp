// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "Support.hpp"
#include "kernels/membrane/SurfaceMeasure.hpp"

#include <set>

using namespace hexmembrane;

namespace {
constexpr double exact = 1e-12; // closed forms in double precision

HexLatticeSpec study() { return {0.020, 0.080, 0.001, Placement::centred, 2, 2}; }
} // namespace

TEST(HexLattice, studyCaseHasTheStudysNumbers)
{
	const HexLattice l = makeHexLattice(study());
	EXPECT_EQ(l.perRing, 63);
	EXPECT_EQ(l.rings, 46 + 4);
	EXPECT_NEAR(l.centreRadius, 0.001 / std::sin(M_PI / 63), exact * 0.02);
	const double height = (l.rings - 1) * l.ringSpacing + 2 * l.sphereRadius;
	EXPECT_LE(std::abs(height - 0.087), l.ringSpacing / 2);
	EXPECT_NEAR(l.positions.front()[2] + l.positions.back()[2], 0.080, exact * 0.08) << "centred at mid-height";
}

TEST(HexLattice, everyBondIsOneDiameterLong)
{
	for (const auto placement : {Placement::outside, Placement::centred})
		for (const double R : {0.00025, 0.001, 0.0033, 0.008}) {
			const HexLattice l = makeHexLattice({0.020, 0.080, R, placement, 2, 1});
			ASSERT_EQ(static_cast<int>(l.bonds.size()), l.bondCount());
			for (const auto& b : l.bonds)
				ASSERT_NEAR((l.positions[b[0]] - l.positions[b[1]]).norm(), 2 * l.sphereRadius, exact * 2 * R) << "R = " << R;
		}
}

TEST(HexLattice, outsideTouchesTheSpecimenExactly)
{
	const HexLattice l = makeHexLattice({0.020, 0.080, 0.001, Placement::outside, 2, 2});
	const double s = std::sin(M_PI / l.perRing);
	EXPECT_NEAR(l.innerRadius, 0.020, exact * 0.02);
	EXPECT_NEAR(l.sphereRadius, 0.020 * s / (1 - s), exact * 0.001);
	EXPECT_LT(std::abs(l.sphereRadius / 0.001 - 1), 1. / (2 * l.perRing));
}

TEST(HexLattice, ringSpacingTendsToRootThree)
{
	const HexLattice l = makeHexLattice({0.020, 0.004, 0.00001, Placement::centred, 0, 0});
	EXPECT_NEAR(l.ringSpacing / (std::sqrt(3.) * l.sphereRadius), 1, 1e-6);
}

TEST(HexLattice, trianglesCoverTheTubeAndFaceOutwards)
{
	const HexLattice l = makeHexLattice(study());
	EXPECT_EQ(static_cast<int>(l.triangles.size()), 2 * l.perRing * (l.rings - 1));
	std::set<std::pair<int, int>> edges;
	for (const auto& t : l.triangles) {
		const Vec3 &a = l.positions[t[0]], &b = l.positions[t[1]], &c = l.positions[t[2]];
		Vec3 out = (a + b + c) / 3;
		out[2] = 0;
		ASSERT_GT((b - a).cross(c - a).dot(out), 0);
		for (int e = 0; e < 3; ++e) ASSERT_TRUE(edges.insert({t[e], t[(e + 1) % 3]}).second) << "an edge is run through twice in one direction";
	}
	// every bond is an edge, inner ones of two triangles
	for (const auto& b : l.bonds) ASSERT_TRUE(edges.count({b[0], b[1]}) || edges.count({b[1], b[0]}));
	EXPECT_EQ(edges.size(), 2 * l.bonds.size() - 2 * l.perRing);
}

TEST(HexLattice, groupsFromTheEnds)
{
	const HexLattice l = makeHexLattice({0.020, 0.080, 0.001, Placement::centred, 2, 3});
	for (int k = 0; k < l.rings; ++k) {
		const int fromEnd = std::min(k, l.rings - 1 - k);
		EXPECT_EQ(l.groups[l.at(k, 0)], fromEnd < 2 ? 1 : fromEnd < 5 ? 2 : 3) << k;
	}
	EXPECT_LT(l.positions[l.at(1, 0)][2], 0) << "O-ring rows lie beyond the specimen's end";
	EXPECT_GT(l.positions[l.at(2, 0)][2], 0);
}

TEST(HexLattice, largestRadiusOfEquationOne)
{
	// three touching circles of radius R leave a hole of radius R (2/sqrt(3) - 1): the same statement, derived from the centroid
	EXPECT_NEAR(largestMembraneRadius(1.) * (2 / std::sqrt(3.) - 1), 1, exact);
	EXPECT_NEAR(largestMembraneRadius(1.), 6.464, 1e-3);
}

TEST(HexLattice, badInputIsNamed)
{
	const double nan = std::nan("");
	const auto with = [](double rs, double h, double r, int o = 2, int p = 2) { makeHexLattice({rs, h, r, Placement::outside, o, p}); };
	EXPECT_COMPLAINT(with(nan, 0.08, 0.001), "specimenRadius");
	EXPECT_COMPLAINT(with(0.02, -0.08, 0.001), "specimenHeight = -0.08");
	EXPECT_COMPLAINT(with(0.02, 0.08, 0), "particleRadius");
	EXPECT_COMPLAINT(with(0.02, 0.08, 0.05), "too coarse");
	EXPECT_COMPLAINT(with(0.02, 0.001, 0.001), "no ring fits");
	EXPECT_COMPLAINT(with(0.02, 0.08, 0.001, -1), "oRingRows = -1");
	EXPECT_COMPLAINT(with(0.02, 0.08, 0.001, 2, 40), "overlap");
}
