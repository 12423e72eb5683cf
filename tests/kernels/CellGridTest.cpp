// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "Support.hpp"
#include "kernels/base/CellGrid.hpp"
#include "kernels/base/Random.hpp"

#include <algorithm>
#include <set>

using namespace hexmembrane;

namespace {

using Pair = std::pair<int, int>;

const Vec3 low(-1, -2, 0), high(1, 2, 3);

/// Points in the box and, a few of them, well outside it.
std::vector<Vec3> scatter(int count, std::uint64_t seed)
{
	Random random(seed);
	std::vector<Vec3> points;
	for (int i = 0; i < count; ++i) {
		const double reach = i % 10 == 0 ? 1.3 : 1.0;
		points.emplace_back(random.uniform(-reach, reach), random.uniform(-2 * reach, 2 * reach), random.uniform(0, 3 * reach));
	}
	return points;
}

Pair ordered(int i, int j) { return {std::min(i, j), std::max(i, j)}; }

} // namespace

TEST(CellGrid, meetsEveryNearPairOnce)
{
	for (const double size : {0.11, 0.3, 0.9, 5.0}) {
		const auto points = scatter(300, 7);
		CellGrid grid(low, high, size);
		grid.fill(points);
		std::multiset<Pair> met;
		grid.forEachPair([&](int i, int j) { met.insert(ordered(i, j)); });
		int near = 0;
		for (int i = 0; i < 300; ++i)
			for (int j = i + 1; j < 300; ++j) {
				EXPECT_LE(met.count({i, j}), 1u) << size;
				if ((points[i] - points[j]).norm() < size) {
					++near;
					EXPECT_EQ(met.count({i, j}), 1u) << size;
				}
			}
		EXPECT_GT(near, 5) << size;
		EXPECT_EQ(met.count({5, 5}), 0u);
	}
}

TEST(CellGrid, meetsEveryPointWithinAReachOnce)
{
	const auto points = scatter(500, 5);
	Random random(2);
	for (const double size : {0.11, 0.3, 5.0}) {
		CellGrid grid(low, high, size);
		grid.fill(points);
		long visits = 0;
		for (int k = 0; k < 200; ++k) {
			// on borders of cells too, where a distance to a cell is a rounding
			const Vec3 place = k % 4 ? Vec3(random.uniform(-1.5, 1.5), random.uniform(-3, 3), random.uniform(-1, 4)) : points[k];
			const double reach = k % 3 ? random.uniform(0, 0.8) : (points[k + 1] - place).norm();
			std::multiset<int> met;
			grid.forEachWithin(place, reach, [&](int i) { met.insert(i); });
			visits += long(met.size());
			for (int i = 0; i < 500; ++i) EXPECT_LE(std::size_t((points[i] - place).norm() <= reach), met.count(i));
			for (const int i : met) EXPECT_EQ(met.count(i), 1u);
		}
		if (size < 0.2) {
			EXPECT_LT(visits, 200 * 500 / 4);
		}
		grid.forEachWithin(Vec3(NAN, 0, 0), 1, [](int) { ADD_FAILURE(); });
		grid.forEachWithin(Vec3(0, 0, 0), NAN, [](int) { ADD_FAILURE(); });
	}
}

TEST(CellGrid, skipsWhatIsFarAway)
{
	CellGrid grid(low, high, 0.3);
	grid.fill(scatter(1000, 3));
	long visits = 0;
	grid.forEachPair([&](int, int) { ++visits; });
	EXPECT_LT(visits, 1000l * 999 / 2 / 20);
	EXPECT_EQ(grid.cells(), (std::array<int, 3>{6, 13, 10}));
}

TEST(CellGrid, findsAllPointsNearAPlace)
{
	const auto points = scatter(500, 11);
	CellGrid grid(low, high, 0.4);
	grid.fill(points);
	for (const Vec3& place : scatter(40, 12)) {
		std::multiset<int> met;
		grid.forEachNear(place, [&](int i) { met.insert(i); });
		for (int i = 0; i < 500; ++i) {
			EXPECT_LE(met.count(i), 1u);
			EXPECT_TRUE(met.count(i) == 1 || (points[i] - place).norm() >= 0.4) << i;
		}
	}
}

TEST(CellGrid, nothingIsNearAPlaceThatIsNoPlace)
{
	CellGrid grid(low, high, 0.4), flat(low, Vec3(high[0], high[1], low[2]), 0.4);
	grid.fill(scatter(500, 11));
	flat.fill(scatter(500, 11));
	for (const double wrong : {double(NAN), double(INFINITY), -double(INFINITY)})
		for (int axis = 0; axis < 3; ++axis) {
			Vec3 place = 0.5 * (low + high);
			place[axis] = wrong;
			int visits = 0;
			grid.forEachNear(place, [&](int) { ++visits; });
			flat.forEachNear(place, [&](int) { ++visits; });
			EXPECT_EQ(visits, 0) << wrong << " on axis " << axis;
		}
}

TEST(CellGrid, ordersEveryPointOnceAndForgetsThoseOfBefore)
{
	CellGrid grid(low, high, 0.5);
	grid.fill(scatter(200, 1));
	grid.fill(scatter(50, 2));
	std::vector<int> order = grid.order();
	std::sort(order.begin(), order.end());
	ASSERT_EQ(order.size(), 50u);
	for (int i = 0; i < 50; ++i) EXPECT_EQ(order[i], i);
}

TEST(CellGrid, emptyAndFlatBoxesWork)
{
	CellGrid empty(low, high, 0.5);
	int visits = 0;
	empty.forEachNear(Vec3(0, 0, 0), [&](int) { ++visits; });
	empty.fill({});
	empty.forEachPair([&](int, int) { ++visits; });
	EXPECT_EQ(visits, 0);
	CellGrid flat(Vec3(0, 0, 1), Vec3(1, 1, 1), 0.5);
	flat.fill({Vec3(0.1, 0.1, 1), Vec3(0.2, 0.1, 1)});
	flat.forEachPair([&](int, int) { ++visits; });
	EXPECT_EQ(visits, 1);
}

TEST(CellGrid, refusesBadInput)
{
	EXPECT_COMPLAINT(CellGrid(low, high, 0), "cellSize = 0");
	EXPECT_COMPLAINT(CellGrid(low, high, NAN), "cellSize");
	EXPECT_COMPLAINT(CellGrid(high, low, 0.1), "high");
	EXPECT_COMPLAINT(CellGrid(low, Vec3(1, NAN, 1), 0.1), "high");
	EXPECT_COMPLAINT(CellGrid(low, high, 1e-4), "cells");
	CellGrid grid(low, high, 0.5);
	EXPECT_COMPLAINT(grid.fill({Vec3(0, 0, 0), Vec3(0, NAN, 0)}), "points[1] = nan");
	EXPECT_COMPLAINT(grid.fill({Vec3(0, 0, INFINITY)}), "points[0] = inf");
}

TEST(NearPairs, equalsBruteForceAndIsSorted)
{
	const auto points = scatter(400, 21);
	Random random(5);
	std::vector<double> radii;
	for (int i = 0; i < 400; ++i) radii.push_back(random.uniform(0.02, 0.2));
	for (const double gap : {0.0, 0.05}) {
		const NearPairs found = findNearPairs(points, radii, gap, low, high);
		ASSERT_EQ(found.start.size(), 401u);
		std::size_t k = 0;
		for (int i = 0; i < 400; ++i) {
			EXPECT_EQ(found.start[i], int(k));
			for (int j = i + 1; j < 400; ++j)
				if ((points[i] - points[j]).norm() < radii[i] + radii[j] + gap) {
					ASSERT_LT(k, found.other.size());
					EXPECT_EQ(found.other[k++], j);
				}
		}
		EXPECT_EQ(k, found.other.size());
		EXPECT_GT(k, 100u);
	}
}

TEST(NearPairs, smallSpheresInALargeBoxCostNoMemory)
{
	const Vec3 big(1, 1, 1);
	EXPECT_EQ(findNearPairs({Vec3(0.5, 0.5, 0.5), Vec3(0.5, 0.5, 0.5 + 1.5e-9)}, {1e-9, 1e-9}, 0, Vec3::Zero(), big).other.size(), 1u);
}

TEST(NearPairs, refusesBadInput)
{
	EXPECT_COMPLAINT(findNearPairs({Vec3::Zero()}, {1., 2.}, 0, low, high), "radii");
	EXPECT_COMPLAINT(findNearPairs({Vec3::Zero()}, {-1.}, 0, low, high), "radii[0] = -1");
	EXPECT_COMPLAINT(findNearPairs({Vec3::Zero()}, {1.}, -1, low, high), "gap = -1");
}
