// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/boundary/OverlappingRamps.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

using namespace hexmembrane;

namespace {

constexpr double dt = 1e-3, duration = 0.2;

/// Values of the middles of `steps` steps that follow target(time), as PlatenDrive does.
std::vector<double> follow(int steps, const std::function<double(double)>& target, double ramp = duration)
{
	std::vector<Ramp> ramps;
	std::vector<double> values;
	double last = 0;
	for (int k = 0; k < steps; ++k) {
		const double wanted = target(k * dt);
		if (wanted != last) addRamp(ramps, wanted - last, ramp);
		last = wanted;
		values.push_back(wanted - stillToCome(ramps, 0.5 * dt));
		advanceRamps(ramps, dt);
	}
	return values;
}

} // namespace

TEST(OverlappingRamps, aSingleChangeIsOneCosine)
{
	const auto values = follow(300, [](double) { return 3; });
	for (int k = 0; k < 300; ++k) {
		const double t = (k + 0.5) * dt;
		ASSERT_NEAR(values[k], t < duration ? 1.5 * (1 - std::cos(M_PI * t / duration)) : 3, 1e-13) << k;
	}
	EXPECT_EQ(values[200], 3) << "to the last bit once it is over";
}

TEST(OverlappingRamps, twoChangesAddUp)
{
	// the second one while the first one runs: each alone is known
	const auto both = follow(500, [](double t) { return t < 0.0995 ? 1 : -2; });
	const auto first = follow(500, [](double) { return 1; }), second = follow(400, [](double) { return -3; });
	for (int k = 0; k < 500; ++k) ASSERT_NEAR(both[k], first[k] + (k < 100 ? 0 : second[k - 100]), 1e-13) << k;
}

// Convolution of a straight line with a symmetric window is the line half the window later.
TEST(OverlappingRamps, aTargetThatMovesInEveryStepIsFollowedHalfADurationBehind)
{
	const auto values = follow(1000, [](double t) { return 5 * t; });
	for (int k = 250; k < 1000; ++k) ASSERT_NEAR(values[k], 5 * ((k + 0.5) * dt - 0.5 * duration), 5 * dt) << k;
	// and smoothly: no step changes the value by more than the line's slope
	for (int k = 1; k < 1000; ++k) ASSERT_LE(values[k] - values[k - 1], 5 * dt * (1 + 1e-9)) << k;
}

TEST(OverlappingRamps, manyChangesMakeNoMoreThanAThousandRamps)
{
	std::vector<Ramp> ramps;
	const int perRamp = 20000;
	double target = 0, before = 0;
	for (int k = 0; k < 3 * perRamp; ++k) {
		addRamp(ramps, 1e-3, 1);
		target += 1e-3;
		const double now = target - stillToCome(ramps, 0.5 / perRamp);
		ASSERT_LE(now - before, 1.001e-3) << k;
		before = now;
		advanceRamps(ramps, 1. / perRamp);
		ASSERT_LE(ramps.size(), 1001u);
	}
	EXPECT_NEAR(before, target - 0.5 * perRamp * 1e-3, 0.01) << "half a duration behind, and half of a thousandth";
}

TEST(OverlappingRamps, withoutADurationAtOnce)
{
	for (double value : follow(5, [](double) { return 7; }, 0)) EXPECT_EQ(value, 7);
	std::vector<Ramp> ramps;
	addRamp(ramps, 1, 0);
	EXPECT_TRUE(ramps.empty());
}

TEST(OverlappingRamps, aChangeOfTheDurationHoldsForNewRampsOnly)
{
	std::vector<Ramp> ramps;
	addRamp(ramps, 1, 1);
	addRamp(ramps, 2, 4);
	EXPECT_EQ(stillToCome(ramps, 0), 3);
	advanceRamps(ramps, 1);
	ASSERT_EQ(ramps.size(), 1u);
	EXPECT_NEAR(stillToCome(ramps, 0), 2 * (1 - 0.5 * (1 - std::cos(M_PI / 4))), 1e-15);
}
