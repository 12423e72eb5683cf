// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "Support.hpp"
#include "kernels/membrane/PaddedRings.hpp"

using namespace hexmembrane;

TEST(PaddedRings, keepsEveryVectorByItself)
{
	const int n = 5, rows = 3;
	const auto values = support::randomVectors(n * rows, 1, 3);
	PaddedRings field(n, rows);
	for (int k = 0; k < rows; ++k)
		for (int i = 0; i < n; ++i) field.set(k, i, values[k * n + i]);
	for (int k = 0; k < rows; ++k)
		for (int i = 0; i < n; ++i) {
			EXPECT_EQ((field.get(k, i) - values[k * n + i]).norm(), 0);
			for (int a = 0; a < 3; ++a) EXPECT_EQ(field.row(a, k)[i], values[k * n + i][a]);
		}
}

TEST(PaddedRings, wrappedRowsHaveTheirNeighboursOnBothSides)
{
	const int n = 4, rows = 3;
	const auto values = support::randomVectors(n * rows, 1, 4);
	PaddedRings field(n, rows);
	for (int k = 0; k < rows; ++k)
		for (int i = 0; i < n; ++i) field.set(k, i, values[k * n + i]);
	for (int k = 0; k < rows; ++k) field.wrap(k);
	for (int k = 0; k < rows; ++k)
		for (int i = -1; i <= n; ++i)
			for (int a = 0; a < 3; ++a) EXPECT_EQ(field.row(a, k)[i], values[k * n + (i + n) % n][a]) << k << " " << i;
}

TEST(PaddedRings, wrapLeavesOtherRowsAlone)
{
	PaddedRings field(3, 2);
	for (int i = 0; i < 3; ++i) field.set(0, i, Vec3(1, 2, 3));
	field.wrap(0);
	for (int a = 0; a < 3; ++a)
		for (int i = -1; i <= 3; ++i) EXPECT_EQ(field.row(a, 1)[i], 0) << "a new field is zero";
}

TEST(PaddedRings, knowsItsSize)
{
	EXPECT_TRUE(PaddedRings(5, 3).fits(5, 3));
	EXPECT_FALSE(PaddedRings(5, 3).fits(3, 5));
	EXPECT_FALSE(PaddedRings(5, 3).fits(5, 4));
	EXPECT_FALSE(PaddedRings().fits(5, 3));
}
