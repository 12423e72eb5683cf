// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "Support.hpp"
#include "kernels/membrane/SurfaceMeasure.hpp"

using namespace hexmembrane;

namespace {

const double inf = std::numeric_limits<double>::infinity();

/// An upright prism of n sides as a tube of two triangles a side.
HexLattice prism(int n, double radius, double height)
{
	HexLattice p;
	for (const double z : {0., height})
		for (int i = 0; i < n; ++i) p.positions.emplace_back(radius * std::cos(2 * M_PI * i / n), radius * std::sin(2 * M_PI * i / n), z);
	for (int i = 0; i < n; ++i) {
		const int j = (i + 1) % n;
		p.triangles.push_back({i, j, n + i});
		p.triangles.push_back({j, n + j, n + i});
	}
	return p;
}

} // namespace

TEST(SurfaceMeasure, prismByClosedForm)
{
	const int n = 17;
	const double r = 0.02, h = 0.08, section = 0.5 * n * r * r * std::sin(2 * M_PI / n), side = 2 * r * std::sin(M_PI / n);
	const auto p = prism(n, r, h);
	const auto whole = measureTube(p.triangles, p.positions, {-inf, inf})[0];
	EXPECT_NEAR(whole.volume / (section * h), 1, 1e-12);
	EXPECT_NEAR(whole.area / (n * side * h), 1, 1e-12);
	const auto part = measureTube(p.triangles, p.positions, {0.013, 0.047})[0];
	EXPECT_NEAR(part.volume / (section * 0.034), 1, 1e-12);
	EXPECT_NEAR(part.area / (n * side * 0.034), 1, 1e-12);
}

TEST(SurfaceMeasure, shiftedTubeHasTheSameVolume)
{
	auto p = prism(17, 0.02, 0.08);
	const auto before = measureTube(p.triangles, p.positions, {0.01, 0.07})[0];
	for (auto& x : p.positions) x += Vec3(0.5, -0.3, 0);
	EXPECT_NEAR(measureTube(p.triangles, p.positions, {0.01, 0.07})[0].volume / before.volume, 1, 1e-12);
}

TEST(SurfaceMeasure, slabsAddUp)
{
	HexLattice tube = support::smallTube();
	support::shake(tube.positions, 5e-4, 4);
	const double volume = measureTube(tube.triangles, tube.positions, {0.002, 0.028})[0].volume;
	std::vector<double> heights;
	for (int i = 0; i <= 13; ++i) heights.push_back(0.002 + i * 0.002);
	const auto slabs = measureTube(tube.triangles, tube.positions, heights);
	ASSERT_EQ(slabs.size(), 13u);
	double sum = 0;
	for (int i = 0; i < 13; ++i) {
		sum += slabs[i].volume;
		const auto alone = measureTube(tube.triangles, tube.positions, {heights[i], heights[i + 1]})[0];
		EXPECT_EQ(slabs[i].volume, alone.volume);
		EXPECT_EQ(slabs[i].area, alone.area);
	}
	EXPECT_NEAR(sum / volume, 1, 1e-12);
}

TEST(SurfaceMeasure, tubeWithPlaneEndsEqualsTheClosedSurface)
{
	HexLattice tube = support::smallTube();
	// shake all but the end rings, whose plane is what closes the tube
	auto inside = std::vector<Vec3>(tube.positions.begin() + tube.perRing, tube.positions.end() - tube.perRing);
	support::shake(inside, 5e-4, 8);
	std::copy(inside.begin(), inside.end(), tube.positions.begin() + tube.perRing);
	const double open = measureTube(tube.triangles, tube.positions, {-inf, inf})[0].volume;
	support::closeTube(tube);
	EXPECT_NEAR(open / closedVolume(tube.triangles, tube.positions), 1, 1e-12);
}

TEST(SurfaceMeasure, wrongOrderOfPlanesIsNamed)
{
	const auto p = prism(6, 1, 1);
	EXPECT_COMPLAINT(measureTube(p.triangles, p.positions, std::vector<double>({1, 0})), "zBottom");
	EXPECT_COMPLAINT(measureTube(p.triangles, p.positions, std::vector<double>({0, 1, std::nan("")})), "zBottom");
}
