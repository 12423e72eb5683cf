// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/base/Random.hpp"
#include "kernels/base/WeightedMedian.hpp"

#include <gtest/gtest.h>

#include <cmath>

using namespace hexmembrane;

// By its definition: what is at most the median has half of the weight, what is below it has not.
TEST(WeightedMedian, halvesTheWeight)
{
	Random random(4);
	for (int n = 1; n < 40; ++n) {
		std::vector<std::pair<double, double>> valued;
		double total = 0, below = 0, upTo = 0;
		for (int i = 0; i < n; ++i) {
			valued.emplace_back(std::floor(random.uniform(0, 8)), random.uniform());
			total += valued.back().second;
		}
		const double median = weightedMedian(valued);
		for (const auto& [value, weight] : valued) {
			below += value < median ? weight : 0;
			upTo += value <= median ? weight : 0;
		}
		EXPECT_GE(upTo, 0.5 * total);
		EXPECT_LT(below, 0.5 * total);
	}
}

TEST(WeightedMedian, theGreaterHalfDecidesAlone)
{
	EXPECT_EQ(weightedMedian({{2650, 3}, {1e9, 1}, {1e-9, 1.9}}), 2650);
	EXPECT_EQ(weightedMedian({{1, 0}, {2, 1}}), 2) << "nothing weighs nothing";
}

TEST(WeightedMedian, ofNothingIsNoNumber)
{
	EXPECT_TRUE(std::isnan(weightedMedian({})));
	EXPECT_TRUE(std::isnan(weightedMedian({{1, 0}})));
}
