// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/base/Random.hpp"
#include "kernels/compact/ThreadPartition.hpp"

#include <gtest/gtest.h>

#include <algorithm>

using namespace hexmembrane;

namespace {

/// Starts of rows with random numbers of pairs; of the particles behind the grains only when they have any.
std::vector<int> rowStarts(int grains, int particles, bool particlesHavePairs, unsigned seed)
{
	Random random(seed);
	std::vector<int> start{0};
	for (int i = 0; i < grains + particles; ++i) start.push_back(start.back() + (i < grains || particlesHavePairs ? int(random.uniform(0, 9)) : 0));
	return start;
}

} // namespace

TEST(ThreadPartition, everySphereHasOneOwner)
{
	unsigned seed = 1;
	for (const int grains : {0, 1, 2, 100, 503})
		for (const int particles : {0, 7, 200})
			for (const bool pairs : {false, true})
				for (const int threads : {1, 2, 3, 8}) {
					const auto start = rowStarts(grains, particles, pairs, seed++);
					ThreadPartition parts;
					parts.divide(threads, start, grains);
					ASSERT_EQ(parts.threads(), threads);
					std::vector<int> owners(grains + particles, 0), swept(grains + particles, 0);
					for (int t = 0; t < threads; ++t) {
						parts.forOwned(t, [&](int from, int to) {
							for (int i = from; i < to; ++i) ++owners[i];
						});
						for (int i = parts.rowsOf(t).from; i < parts.rowsOf(t).to; ++i) ++swept[i];
						EXPECT_EQ(parts.rowsOf(t).from, t > 0 ? parts.rowsOf(t - 1).to : 0) << "upwards";
					}
					EXPECT_EQ(std::count(owners.begin(), owners.end(), 1), grains + particles)
					        << grains << " " << particles << " " << threads;
					// whoever has pairs is in somebody's rows
					for (int i = 0; i < grains + particles; ++i) EXPECT_TRUE(swept[i] == 1 || start[i] == start[i + 1]) << i;
				}
}

TEST(ThreadPartition, workIsEvenToOneRow)
{
	const int grains = 1000, particles = 300;
	const auto start = rowStarts(grains, particles, false, 5);
	for (const int threads : {2, 3, 7}) {
		ThreadPartition parts;
		parts.divide(threads, start, grains);
		for (int t = 0; t < threads; ++t) {
			const auto [from, to] = parts.rowsOf(t);
			const double work = start[to] - start[from] + to - from, even = double(start[grains] + grains) / threads;
			EXPECT_NEAR(work, even, 10) << "a row has at most 8 pairs";
			const auto others = parts.othersOf(t);
			EXPECT_NEAR(others.to - others.from, double(particles) / threads, 1);
		}
	}
}

TEST(ThreadPartition, oneThreadSweepsAll)
{
	ThreadPartition parts;
	parts.divide(1, rowStarts(10, 5, false, 3), 10);
	EXPECT_EQ(parts.rowsOf(0).from, 0);
	EXPECT_EQ(parts.rowsOf(0).to, 15);
	EXPECT_EQ(parts.othersOf(0).from, parts.othersOf(0).to);
}
