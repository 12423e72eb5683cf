// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/base/IntegralController.hpp"

#include <gtest/gtest.h>

#include <cmath>

using namespace hexmembrane;

// A plant that answers at once, measured = share factor target: the error shrinks by 1 - gain share a correction, whatever the target.
TEST(IntegralController, errorOfAProportionalPlantShrinksGeometrically)
{
	for (const double target : {1e5, 3.0, -2e4})
		for (const double share : {0.5, 1.0, 1.6}) {
			const double gain = 0.3;
			double factor = 1;
			const double first = 1 - share;
			for (int k = 1; k <= 40; ++k) {
				bool saturated = true;
				factor = correctedFactor(factor, gain, target, share * factor * target, 0, 10, saturated);
				EXPECT_NEAR(1 - share * factor, first * std::pow(1 - gain * share, k), 1e-14) << k;
				EXPECT_FALSE(saturated);
			}
		}
}

TEST(IntegralController, staysWithinItsLimitsAndSaysSo)
{
	bool saturated = false;
	EXPECT_EQ(correctedFactor(1.4, 0.5, 100, 0, 0.5, 1.5, saturated), 1.5);
	EXPECT_TRUE(saturated);
	EXPECT_EQ(correctedFactor(0.6, 0.5, 100, 300, 0.5, 1.5, saturated), 0.5);
	EXPECT_TRUE(saturated);
	EXPECT_EQ(correctedFactor(1, 0.5, 100, 100, 0.5, 1.5, saturated), 1);
	EXPECT_FALSE(saturated);
}

TEST(IntegralController, noTargetNoCorrection)
{
	bool saturated = false;
	EXPECT_EQ(correctedFactor(1.2, 0.5, 0, 7, 0.5, 1.5, saturated), 1.2);
	EXPECT_FALSE(saturated);
}
