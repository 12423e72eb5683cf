// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "Support.hpp"
#include "kernels/base/Random.hpp"
#include "kernels/packing/SpherePacking.hpp"
#include "kernels/packing/SphereRelaxation.hpp"

#include <algorithm>
#include <numeric>

using namespace hexmembrane;

namespace {

constexpr double R = 0.02, H = 0.04;

/// Sizes from 1 to 2.5, more small ones than large ones.
std::vector<double> graded(int count, std::uint64_t seed = 3)
{
	Random random(seed);
	std::vector<double> radii;
	for (int i = 0; i < count; ++i) radii.push_back(1e-3 / (1 - 0.6 * random.uniform()));
	return radii;
}

SpherePackingSpec spec(int count, double porosity, std::uint64_t seed = 1) { return {R, H, graded(count), porosity, seed}; }

/// The oracle: every pair and every wall, without a grid.
double bruteForceOverlap(const std::vector<Vec3>& x, const std::vector<double>& r, double radius, double height)
{
	double worst = 0;
	for (std::size_t i = 0; i < x.size(); ++i) {
		worst = std::max({worst, std::hypot(x[i][0], x[i][1]) + r[i] - radius, r[i] - x[i][2], x[i][2] + r[i] - height});
		for (std::size_t j = i + 1; j < x.size(); ++j) worst = std::max(worst, r[i] + r[j] - (x[i] - x[j]).norm());
	}
	return worst;
}

double meanOf(const std::vector<double>& v) { return std::accumulate(v.begin(), v.end(), 0.0) / double(v.size()); }

} // namespace

TEST(SpherePacking, meetsThePorosityWithoutOverlaps)
{
	for (const double porosity : {0.60, 0.50, 0.43}) {
		const SpherePacking p = packSpheres(spec(500, porosity));
		ASSERT_EQ(p.centres.size(), 500u);
		EXPECT_NEAR(p.porosity, porosity, 1e-12);
		EXPECT_NEAR(packingPorosity(p.radii, R, H), porosity, 1e-12);
		EXPECT_EQ(bruteForceOverlap(p.centres, p.radii, R, H), 0) << porosity;
		EXPECT_EQ(p.maxOverlap, 0);
		for (int i = 0; i < 500; ++i) EXPECT_DOUBLE_EQ(p.radii[i], graded(500)[i] * p.scale);
	}
}

TEST(SpherePacking, keepsTheRadiiWithoutAPorosity)
{
	SpherePackingSpec s = spec(300, NAN);
	const double k = scaleForPorosity(s.radii, R, H, 0.47);
	for (double& r : s.radii) r *= k;
	const SpherePacking p = packSpheres(s);
	EXPECT_EQ(p.radii, s.radii);
	EXPECT_EQ(p.scale, 1);
	EXPECT_NEAR(p.porosity, 0.47, 1e-12);
	EXPECT_EQ(bruteForceOverlap(p.centres, p.radii, R, H), 0);
}

TEST(SpherePacking, sameSeedSameBitsOtherSeedOtherPacking)
{
	const SpherePacking a = packSpheres(spec(300, 0.44, 9)), b = packSpheres(spec(300, 0.44, 9)), c = packSpheres(spec(300, 0.44, 10));
	for (int i = 0; i < 300; ++i)
		for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(a.centres[i][axis], b.centres[i][axis]);
	EXPECT_GT((a.centres[0] - c.centres[0]).norm() + (a.centres[1] - c.centres[1]).norm(), 1e-4);
}

TEST(SpherePacking, isTheSameInEveryUnitOfLength)
{
	SpherePackingSpec big = spec(200, 0.45);
	const SpherePacking m = packSpheres(big);
	// a power of two changes no digit of the arithmetic
	big.radius *= 1024;
	big.height *= 1024;
	for (double& r : big.radii) r *= 1024;
	const SpherePacking km = packSpheres(big);
	for (int i = 0; i < 200; ++i) EXPECT_LT((km.centres[i] / 1024 - m.centres[i]).norm(), 1e-9 * R);
}

TEST(SpherePacking, sizesAreMixedAndTheMassIsCentred)
{
	// over several packings, the correlation of size with height and with distance from the axis (compared with grains of the same reach)
	double height = 0, heightSquares = 0, massHeight = 0, mass = 0, below = 0;
	int count = 0;
	for (int seed = 1; seed <= 4; ++seed) {
		const SpherePacking p = packSpheres(spec(500, 0.45, seed));
		const double mean = meanOf(p.radii);
		for (int i = 0; i < 500; ++i) {
			const double z = (p.centres[i][2] - H / 2) / H, size = (p.radii[i] - mean) / mean, m = std::pow(p.radii[i] / mean, 3);
			height += z * size;
			heightSquares += z * z * size * size;
			massHeight += m * z;
			mass += m;
			if (z < 0) below += m;
			++count;
		}
	}
	EXPECT_LT(std::abs(height), 4 * std::sqrt(heightSquares)) << "size goes with height";
	EXPECT_LT(std::abs(massHeight / mass), 0.01);
	EXPECT_NEAR(below / mass, 0.5, 0.015);
	EXPECT_EQ(count, 2000);
}

TEST(SpherePacking, nearContactsPointEverywhere)
{
	Eigen::Matrix3d fabric = Eigen::Matrix3d::Zero();
	double near = 0;
	for (int seed = 1; seed <= 4; ++seed) {
		const SpherePacking p = packSpheres(spec(500, 0.43, seed));
		for (int i = 0; i < 500; ++i)
			for (int j = i + 1; j < 500; ++j) {
				const Vec3 d = p.centres[i] - p.centres[j];
				const double dist = d.norm();
				if (dist > 1.05 * (p.radii[i] + p.radii[j])) continue;
				fabric += d * d.transpose() / (dist * dist);
				++near;
			}
	}
	fabric /= near;
	EXPECT_GT(near, 4000);
	// a component of an isotropic fabric scatters by sqrt(4/45/near) = 0.005; walls add a little
	for (int a = 0; a < 3; ++a)
		for (int b = 0; b < 3; ++b) EXPECT_NEAR(fabric(a, b), a == b ? 1. / 3 : 0, 0.02) << a << b;
}

TEST(SpherePacking, spreadGrainsKeepClear)
{
	// smallest gap of any two grains over the mean radius: touching when not spread, a few percent when spread
	const auto smallestGap = [](double even) {
		SpherePackingSpec s = spec(300, 0.55);
		s.even = even;
		const SpherePacking p = packSpheres(s);
		double gap = 1;
		for (int i = 0; i < 300; ++i)
			for (int j = 0; j < i; ++j) gap = std::min(gap, (p.centres[i] - p.centres[j]).norm() - p.radii[i] - p.radii[j]);
		return gap / meanOf(p.radii);
	};
	EXPECT_LT(smallestGap(0), 0.005);
	EXPECT_GT(smallestGap(0.58), 0.05);
}

TEST(SpherePacking, saysWhatCanBeReached)
{
	SpherePackingSpec s = spec(300, 0.30);
	try {
		packSpheres(s);
		FAIL() << "0.30 is denser than random packings are";
	} catch (const std::runtime_error& e) {
		const std::string text = e.what(), mark = "a porosity of at least ";
		EXPECT_NE(text.find("porosity = 0.3"), std::string::npos) << text;
		const std::size_t at = text.find(mark);
		ASSERT_NE(at, std::string::npos) << text;
		s.porosity = std::stod(text.substr(at + mark.size()));
	}
	EXPECT_GT(s.porosity, 0.36);
	EXPECT_LT(s.porosity, 0.43);
	const SpherePacking p = packSpheres(s);
	EXPECT_EQ(bruteForceOverlap(p.centres, p.radii, R, H), 0);
}

TEST(SpherePacking, aFewSpheresWork)
{
	for (int count : {1, 2, 5}) {
		const SpherePacking p = packSpheres({1., 3., std::vector<double>(count, 0.2), NAN, 4});
		EXPECT_EQ(bruteForceOverlap(p.centres, p.radii, 1., 3.), 0);
	}
}

TEST(SpherePacking, refusesBadInput)
{
	const auto with = [](auto change) {
		SpherePackingSpec s = spec(50, 0.5);
		change(s);
		packSpheres(s);
	};
	EXPECT_COMPLAINT(with([](auto& s) { s.radius = -1; }), "radius = -1");
	EXPECT_COMPLAINT(with([](auto& s) { s.height = NAN; }), "height = nan");
	EXPECT_COMPLAINT(with([](auto& s) { s.radii.clear(); }), "radii");
	EXPECT_COMPLAINT(with([](auto& s) { s.radii[7] = 0; }), "radii[7] = 0");
	EXPECT_COMPLAINT(with([](auto& s) { s.radii[7] = NAN; }), "radii[7] = nan");
	EXPECT_COMPLAINT(with([](auto& s) { s.porosity = 1; }), "porosity = 1");
	EXPECT_COMPLAINT(with([](auto& s) { s.porosity = -0.1; }), "porosity = -0.1");
	EXPECT_COMPLAINT(with([](auto& s) { s.tolerance = 0; }), "tolerance = 0");
	EXPECT_COMPLAINT(with([](auto& s) { s.tolerance = 0.1; }), "tolerance = 0.1");
	EXPECT_COMPLAINT(with([](auto& s) { s.even = 0.7; }), "even = 0.7");
	EXPECT_COMPLAINT(with([](auto& s) { s.even = -1; }), "even = -1");
	EXPECT_COMPLAINT(with([](auto& s) { s.shakes = -1; }), "shakes = -1");
	EXPECT_COMPLAINT(with([](auto& s) { s.radii = {1.}, s.porosity = 0.2; }), "does not go into the cylinder");
	EXPECT_COMPLAINT(with([](auto& s) { s.radii.assign(2000, 2e-3), s.porosity = NAN; }), "the porosity that these radii make");
}

TEST(LargestOverlap, equalsBruteForce)
{
	Random random(8);
	std::vector<Vec3> x;
	std::vector<double> r = graded(200);
	for (int i = 0; i < 200; ++i) x.emplace_back(random.uniform(-R, R), random.uniform(-R, R), random.uniform(0, H));
	EXPECT_DOUBLE_EQ(largestOverlap(x, r, R, H), bruteForceOverlap(x, r, R, H));
	EXPECT_GT(largestOverlap(x, r, R, H), 1e-3);
	EXPECT_EQ(largestOverlap({Vec3(0, 0, 0.5)}, {0.5}, 0.5, 1), 0);
	EXPECT_DOUBLE_EQ(largestOverlap({Vec3(0.25, 0, 0.5)}, {0.5}, 0.5, 1), 0.25);
}

TEST(SphereRelaxation, partsTwoSpheresAlongTheirLine)
{
	SphereRelaxation pair({Vec3(0, 0, 1), Vec3(0.1, 0, 1)}, {0.2, 0.2}, 1, 2);
	EXPECT_EQ(pair.relax(1, 1e-6, 1000), SphereRelaxation::Outcome::separated);
	// at least in contact; what they have of speed at that moment carries them a little apart
	EXPECT_GE((pair.centres()[0] - pair.centres()[1]).norm(), 0.4 - 1e-6);
	EXPECT_LT((pair.centres()[0] - pair.centres()[1]).norm(), 0.5);
	EXPECT_NEAR(pair.centres()[0][0] + pair.centres()[1][0], 0.1, 1e-12);
	EXPECT_EQ(pair.centres()[0][1], 0);
	EXPECT_EQ(pair.centres()[0][2], 1);
}

TEST(SphereRelaxation, coincidentCentresPart)
{
	SphereRelaxation pair({Vec3(0, 0, 1), Vec3(0, 0, 1)}, {0.2, 0.2}, 1, 2);
	EXPECT_EQ(pair.relax(1, 1e-6, 1000), SphereRelaxation::Outcome::separated);
	EXPECT_GE((pair.centres()[0] - pair.centres()[1]).norm(), 0.4 - 1e-6);
}

TEST(SphereRelaxation, knowsJammedFromUnfinished)
{
	// two spheres of radius 0.3 in a tube of that radius and height 1: each overlap is (1.2 - 1)/3
	SphereRelaxation jammed({Vec3(0, 0, 0.3), Vec3(0, 0, 0.6)}, {0.3, 0.3}, 0.3, 1);
	EXPECT_EQ(jammed.relax(1, 1e-6, 100000), SphereRelaxation::Outcome::jammed);
	EXPECT_NEAR(jammed.largestOverlap(), 0.2 / 3, 1e-3);
	EXPECT_EQ(jammed.contactCount(), 3);
	EXPECT_NEAR(jammed.meanOverlap(), 0.2 / 3, 1e-3);
	SphereRelaxation hasty({Vec3(0, 0, 0.3), Vec3(0, 0, 0.6)}, {0.3, 0.3}, 0.3, 1);
	EXPECT_EQ(hasty.relax(1, 1e-6, 2), SphereRelaxation::Outcome::exhausted);
}

TEST(SphereRelaxation, shakenSpheresStayInside)
{
	SphereRelaxation spheres({Vec3(0.6, 0, 0.4), Vec3(0, -0.6, 1.6)}, {0.3, 0.3}, 1, 2);
	Random random(2);
	spheres.relax(1, 1e-6, 1);
	for (int i = 0; i < 200; ++i) {
		spheres.shake(0.5, random);
		EXPECT_LE(bruteForceOverlap({spheres.centres()[0]}, {0.3}, 1, 2), 1e-12);
		EXPECT_LE(bruteForceOverlap({spheres.centres()[1]}, {0.3}, 1, 2), 1e-12);
	}
}
