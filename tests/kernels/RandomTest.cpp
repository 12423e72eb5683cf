// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/base/Random.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

using namespace hexmembrane;

// The published sequence of SplitMix64 for this seed (Rosetta Code, "Pseudo-random numbers/Splitmix64").
TEST(Random, isSplitMix64)
{
	Random random(1234567);
	for (const std::uint64_t value : {6457827717110365317u, 3203168211198807973u, 9817491932198370423u, 4593380528125082431u, 16408922859458223821u})
		EXPECT_EQ(random.bits(), value);
}

// The same source's second check: how often each fifth of [0, 1) is hit in 100,000 numbers.
TEST(Random, uniformNumbersHitTheFifthsAsPublished)
{
	Random random(987654321);
	std::array<int, 5> hits{};
	for (int i = 0; i < 100000; ++i) ++hits[std::size_t(random.uniform() * 5)];
	EXPECT_EQ(hits, (std::array<int, 5>{20027, 19892, 20073, 19978, 20030}));
}

TEST(Random, rangeIsHalfOpenAndEvenlyFilled)
{
	Random random(1);
	double least = 1, most = 0, sum = 0, squares = 0;
	constexpr int count = 100000;
	for (int i = 0; i < count; ++i) {
		const double u = (random.uniform(-3, 5) + 3) / 8;
		least = std::min(least, u);
		most = std::max(most, u);
		sum += u;
		squares += u * u;
	}
	EXPECT_GE(least, 0);
	EXPECT_LT(least, 1e-4);
	EXPECT_LT(most, 1);
	EXPECT_GT(most, 1 - 1e-4);
	// mean 1/2 and variance 1/12 within five standard deviations of their chance
	EXPECT_NEAR(sum / count, 0.5, 5 * std::sqrt(1. / 12 / count));
	EXPECT_NEAR(squares / count, 1. / 3, 5 * std::sqrt(4. / 45 / count));
}
