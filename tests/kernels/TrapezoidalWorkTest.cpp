// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "Support.hpp"
#include "kernels/base/TrapezoidalWork.hpp"

using namespace hexmembrane;

namespace {

/// A meter with its memory, on springs of stiffness 1 about the origin.
struct Springs {
	long lastStep = -2;
	std::vector<Vec3> lastForce, lastPosition;

	double at(long step, const std::vector<Vec3>& x)
	{
		std::vector<Vec3> force, position = x;
		for (const Vec3& p : x) force.push_back(-p);
		return TrapezoidalRecord{lastStep, lastForce, lastPosition}.record(step, force, position);
	}
};

double energy(const std::vector<Vec3>& x)
{
	double sum = 0;
	for (const Vec3& p : x) sum += 0.5 * p.squaredNorm();
	return sum;
}

} // namespace

TEST(TrapezoidalRecord, isTheEnergyThatLinearSpringsLose)
{
	Springs springs;
	double work = 0;
	std::vector<Vec3> x;
	for (long step = 100; step < 110; ++step) {
		x = support::randomVectors(7, 1, unsigned(step));
		const double done = springs.at(step, x);
		EXPECT_EQ(done == 0, step == 100) << "of the step before the first one nothing is known";
		work += done;
	}
	EXPECT_NEAR(work, energy(support::randomVectors(7, 1, 100)) - energy(x), 1e-14);
}

TEST(TrapezoidalRecord, aGapIsNobodysWork)
{
	Springs springs;
	const auto a = support::randomVectors(7, 1, 1), b = support::randomVectors(7, 1, 2), c = support::randomVectors(7, 1, 3);
	springs.at(0, a);
	EXPECT_NEAR(springs.at(1, b), energy(a) - energy(b), 1e-14);
	EXPECT_EQ(springs.at(3, c), 0) << "step 2 is missing";
	EXPECT_NEAR(springs.at(4, a), energy(c) - energy(a), 1e-14) << "it goes on from the step after the gap";
	EXPECT_EQ(springs.at(4, b), 0) << "the same step again";
	EXPECT_EQ(springs.at(0, c), 0) << "back to the start";
}

TEST(TrapezoidalRecord, otherPointsStartAnew)
{
	Springs springs;
	springs.at(0, support::randomVectors(7, 1, 1));
	EXPECT_EQ(springs.at(1, support::randomVectors(8, 1, 2)), 0);
	EXPECT_NE(springs.at(2, support::randomVectors(8, 1, 3)), 0);
}
