// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "Support.hpp"
#include "kernels/base/Lanes.hpp"
#include "kernels/base/Vec3.hpp"

using namespace hexmembrane;

namespace {

template <class V>
class LanesOfAnyNumber : public testing::Test {
public:
	static constexpr int count = laneCount<V>;

	static V numbers(double first, double step)
	{
		V v{};
		for (int k = 0; k < count; ++k) v[k] = first + k * step;
		return v;
	}
	static Lanes3<V> together(const std::vector<Vec3>& v)
	{
		Lanes3<V> all{};
		for (int k = 0; k < count; ++k) {
			all.x[k] = v[k][0];
			all.y[k] = v[k][1];
			all.z[k] = v[k][2];
		}
		return all;
	}
	static Vec3 one(const Lanes3<V>& v, int k) { return {v.x[k], v.y[k], v.z[k]}; }
};
using Numbers = testing::Types<Lanes<2>, Lanes<4>, Lanes<8>>;
TYPED_TEST_SUITE(LanesOfAnyNumber, Numbers);

/// Rows of four numbers, all different.
struct Table {
	double rows[8][4];
	explicit Table(double first)
	{
		for (int i = 0; i < 32; ++i) rows[i / 4][i % 4] = first + i;
	}
	template <class V>
	Rows<V> loaded() const
	{
		return Rows<V>::loaded([&](int k) { return rows[k]; });
	}
};

} // namespace

TYPED_TEST(LanesOfAnyNumber, areLoadedAndStoredFromAnywhere)
{
	constexpr int count = laneCount<TypeParam>;
	double numbers[10], out[10] = {};
	for (int i = 0; i < 10; ++i) numbers[i] = i + 1;
	store(out + 1, load<TypeParam>(numbers + 1)); // of no special alignment
	for (int i = 0; i < 10; ++i) EXPECT_EQ(out[i], i >= 1 && i <= count ? numbers[i] : 0);
	for (int k = 0; k < count; ++k) EXPECT_EQ(lanes<TypeParam>(7.5)[k], 7.5);
	EXPECT_EQ(total(load<TypeParam>(numbers)), count * (count + 1) / 2);
}

TEST(Lanes, halvesMakeAWhole)
{
	const Lanes<8> all{1, 2, 3, 4, 5, 6, 7, 8}, again = joined(lowHalf(all), highHalf(all));
	const Four swapped = joined(highHalf(lowHalf(all)), lowHalf(lowHalf(all)));
	for (int k = 0; k < 8; ++k) EXPECT_EQ(again[k], all[k]);
	for (int k = 0; k < 4; ++k) EXPECT_EQ(swapped[k], all[(k + 2) % 4]);
}

TYPED_TEST(LanesOfAnyNumber, rowsAndColumns)
{
	constexpr int count = laneCount<TypeParam>;
	const Table table(1), other(101);
	const Rows<TypeParam> rows = table.loaded<TypeParam>(), others = other.loaded<TypeParam>();
	TypeParam columns[4];
	rows.columns(columns[0], columns[1], columns[2], columns[3]);
	const auto again = Rows<TypeParam>::ofColumns(columns[0], columns[1], columns[2], columns[3]);
	double out[8][4] = {};
	again.stored([&](int k) { return out[k]; });
	const Rows<TypeParam> fourth = rows.withFourth(others), firstTwo = rows.withFirstTwo(others), sum = rows + others, difference = others - rows;
	for (int k = 0; k < 8; ++k)
		for (int i = 0; i < 4; ++i) {
			const double here = table.rows[k][i];
			EXPECT_EQ(out[k][i], k < count ? here : 0);
			if (k >= count) continue;
			EXPECT_EQ(columns[i][k], here);
			EXPECT_EQ(rows.row(k)[i], here);
			EXPECT_EQ(fourth.row(k)[i], i < 3 ? here : other.rows[k][3]);
			EXPECT_EQ(firstTwo.row(k)[i], i < 2 ? here : other.rows[k][i - 2]);
			EXPECT_EQ(sum.row(k)[i], here + other.rows[k][i]);
			EXPECT_EQ(difference.row(k)[i], 100);
		}
}

TYPED_TEST(LanesOfAnyNumber, eachByItself)
{
	TypeParam v = TestFixture::numbers(0, 2), w = TestFixture::numbers(1, 1);
	v[1] = 1e-300;
	for (int k = 0; k < laneCount<TypeParam>; ++k) {
		EXPECT_EQ(squareRoot(v)[k], std::sqrt(v[k]));
		EXPECT_EQ(larger(v, w)[k], std::max(v[k], w[k]));
		EXPECT_EQ(larger(w, v)[k], std::max(v[k], w[k]));
	}
}

TYPED_TEST(LanesOfAnyNumber, vectorsAreThoseOfEigen)
{
	const auto a = support::randomVectors(8, 1, 1), b = support::randomVectors(8, 1, 2);
	const Lanes3<TypeParam> va = this->together(a), vb = this->together(b);
	const TypeParam factor = this->numbers(2, -1.5);
	for (int k = 0; k < laneCount<TypeParam>; ++k) {
		EXPECT_EQ((this->one(va + vb, k) - (a[k] + b[k])).norm(), 0);
		EXPECT_EQ((this->one(va - vb, k) - (a[k] - b[k])).norm(), 0);
		EXPECT_EQ((this->one(factor * va, k) - factor[k] * a[k]).norm(), 0);
		EXPECT_NEAR(dot(va, vb)[k], a[k].dot(b[k]), 1e-15);
		EXPECT_LT((this->one(cross(va, vb), k) - a[k].cross(b[k])).norm(), 1e-15);
	}
}
