// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "Support.hpp"
#include "kernels/base/Random.hpp"
#include "kernels/measure/SlabStress.hpp"

using namespace hexmembrane;

namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

/// The oracle: length of the part of an interval that lies in another one, over its own length.
double share(double a, double b, double low, double high)
{
	const double from = std::min(a, b), to = std::max(a, b);
	if (from == to) return low <= from && from < high;
	return std::max(0., std::min(to, high) - std::max(from, low)) / (to - from);
}

Vec3 any(Random& random, double size) { return size * Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)); }

} // namespace

TEST(SlabStress, aPartOfABranchCountsWhereItLies)
{
	Random random(7);
	const std::vector<double> edges{-0.5, -0.1, 0.2, 0.25, 0.9};
	SlabStress measure(edges);
	std::vector<Mat3> expected(4, Mat3::Zero());
	Mat3 whole = Mat3::Zero();
	for (int c = 0; c < 500; ++c) {
		const Vec3 start = any(random, 1), branch = any(random, c % 3 ? 1 : 0.1), force = any(random, 5);
		measure.add(start, branch, force);
		whole += force * branch.transpose();
		for (int s = 0; s < 4; ++s)
			expected[s] +=
			        share(start[2], start[2] + branch[2], s == 0 ? -inf : edges[s], s == 3 ? inf : edges[s + 1]) * force * branch.transpose();
	}
	for (int s = 0; s < 4; ++s) EXPECT_LT((measure.sums()[s] - expected[s]).norm(), 1e-12 * whole.norm() + 1e-12) << s;
	EXPECT_LT((measure.total() - whole).norm(), 1e-12 * whole.norm() + 1e-12);
}

TEST(SlabStress, aLevelBranchLiesInOneSlab)
{
	SlabStress measure({0, 1, 2});
	measure.add(Vec3(0, 0, 1), Vec3(0.1, 0, 0), Vec3(3, 0, 0)); // on the border: in the upper one
	measure.add(Vec3(0, 0, 0.5), Vec3(0.1, 0, 0), Vec3(2, 0, 0));
	EXPECT_DOUBLE_EQ(measure.sums()[0](0, 0), 0.2);
	EXPECT_DOUBLE_EQ(measure.sums()[1](0, 0), 0.3);
}

TEST(SlabStress, isTheStressThatPressesOnABlock)
{
	// a simple cubic block of spheres of diameter 1 between plates that press with p: each column carries p on 1 x 1, along each axis
	const int n = 4;
	const double p = 1e5;
	SlabStress measure({0, 1.3, 2.9, double(n)});
	for (int i = 0; i < n; ++i)
		for (int j = 0; j < n; ++j)
			for (int k = 0; k < n; ++k)
				for (int a = 0; a < 3; ++a) {
					const Vec3 x = Vec3(i, j, k) + Vec3::Constant(0.5), unit = Vec3::Unit(a);
					measure.add(x, (x[a] + 1 < n ? 1 : 0.5) * unit, p * unit); // the last one to the plate
					if (x[a] == 0.5) measure.add(x, -0.5 * unit, -p * unit);
				}
	EXPECT_LT((measure.total() / (n * n * n) - p * Mat3::Identity()).norm(), 1e-9 * p);
	const double heights[] = {1.3, 1.6, 1.1};
	for (int s = 0; s < 3; ++s) EXPECT_NEAR(measure.sums()[s](2, 2) / (n * n * heights[s]), p, 1e-9 * p) << "axial stress is the same at every height";
}

TEST(SlabStress, refusesBordersThatDoNotRise)
{
	EXPECT_COMPLAINT(SlabStress({0}), "edges = 1");
	EXPECT_COMPLAINT(SlabStress({0, 1, 1}), "edges[2] = 1");
	EXPECT_COMPLAINT(SlabStress({0, NAN}), "edges[1] = nan");
}
