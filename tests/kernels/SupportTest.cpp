// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
// The helpers that other tests trust.
#include "Support.hpp"

using namespace hexmembrane;
using support::relativeDifference;

TEST(Support, equalListsDifferByNothing)
{
	const auto a = support::randomVectors(5, 1, 1);
	EXPECT_EQ(relativeDifference(a, a), 0);
}

TEST(Support, aChangeOfTwoTolerancesIsSeen)
{
	auto a = support::randomVectors(5, 1, 1), b = a;
	b[3][1] += 2e-12 * 2;
	EXPECT_GT(relativeDifference(a, b), 1e-12);
}

TEST(Support, nanAndLengthMismatchNeverPass)
{
	auto a = support::randomVectors(5, 1, 1), b = a;
	b[2][0] = std::nan("");
	EXPECT_FALSE(relativeDifference(a, b) < 1e300);
	EXPECT_FALSE(relativeDifference(b, a) < 1e300);
	b.pop_back();
	EXPECT_FALSE(relativeDifference(a, b) < 1e300);
}

TEST(Support, complaintIsEmptyWithoutException)
{
	EXPECT_EQ(support::complaint([] {}), "");
}
