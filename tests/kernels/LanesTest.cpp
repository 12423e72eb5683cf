// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "Support.hpp"
#include "kernels/base/Lanes.hpp"
#include "kernels/base/Vec3.hpp"

using namespace hexmembrane;

namespace {

/// Four vectors as lanes, and one of the four back.
Lanes3 four(const std::vector<Vec3>& v)
{
	return {Lanes{v[0][0], v[1][0], v[2][0], v[3][0]}, Lanes{v[0][1], v[1][1], v[2][1], v[3][1]}, Lanes{v[0][2], v[1][2], v[2][2], v[3][2]}};
}

Vec3 one(const Lanes3& v, int k) { return {v.x[k], v.y[k], v.z[k]}; }

} // namespace

TEST(Lanes, loadsAndStoresAnyFourNumbers)
{
	const double numbers[6] = {1, 2, 3, 4, 5, 6};
	double out[6] = {};
	store4(out + 1, load4(numbers + 1)); // of no special alignment
	for (int i = 0; i < 6; ++i) EXPECT_EQ(out[i], i >= 1 && i < 5 ? numbers[i] : 0);
	double half[3] = {};
	store2(half + 1, load2(numbers + 3));
	EXPECT_EQ(half[0], 0);
	EXPECT_EQ(half[1], 4);
	EXPECT_EQ(half[2], 5);
	const Lanes all = load4(numbers), again = joined(lowHalf(all), highHalf(all)), swapped = joined(highHalf(all), lowHalf(all));
	for (int i = 0; i < 4; ++i) {
		EXPECT_EQ(again[i], all[i]);
		EXPECT_EQ(swapped[i], all[(i + 2) % 4]);
		EXPECT_EQ(lanes(7.5)[i], 7.5);
	}
}

TEST(Lanes, transposeTurnsRowsIntoColumns)
{
	double table[4][4];
	for (int i = 0; i < 16; ++i) table[i / 4][i % 4] = i;
	Lanes a = load4(table[0]), b = load4(table[1]), c = load4(table[2]), d = load4(table[3]);
	transpose(a, b, c, d);
	const Lanes columns[4] = {a, b, c, d};
	for (int i = 0; i < 4; ++i)
		for (int j = 0; j < 4; ++j) EXPECT_EQ(columns[i][j], table[j][i]);
	transpose(a, b, c, d);
	for (int j = 0; j < 4; ++j) EXPECT_EQ(c[j], table[2][j]) << "twice is nothing";
}

TEST(Lanes, eachLaneByItself)
{
	const Lanes v{0, 2, 1e-300, 9}, w{1, 1, 2e-300, 16};
	for (int i = 0; i < 4; ++i) {
		EXPECT_EQ(squareRoot(v)[i], std::sqrt(v[i]));
		EXPECT_EQ(larger(v, w)[i], std::max(v[i], w[i]));
		EXPECT_EQ(larger(w, v)[i], std::max(v[i], w[i]));
	}
}

TEST(Lanes, vectorsAreThoseOfEigen)
{
	const auto a = support::randomVectors(4, 1, 1), b = support::randomVectors(4, 1, 2);
	const Lanes3 va = four(a), vb = four(b);
	const Lanes factor{2, -3, 0.5, 0};
	for (int k = 0; k < 4; ++k) {
		EXPECT_EQ((one(va + vb, k) - (a[k] + b[k])).norm(), 0);
		EXPECT_EQ((one(va - vb, k) - (a[k] - b[k])).norm(), 0);
		EXPECT_EQ((one(factor * va, k) - factor[k] * a[k]).norm(), 0);
		EXPECT_NEAR(dot(va, vb)[k], a[k].dot(b[k]), 1e-15);
		EXPECT_LT((one(cross(va, vb), k) - a[k].cross(b[k])).norm(), 1e-15);
	}
}
