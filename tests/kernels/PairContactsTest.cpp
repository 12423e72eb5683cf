// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "Support.hpp"
#include "kernels/base/Random.hpp"
#include "kernels/compact/PairContacts.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

using namespace hexmembrane;

namespace {

constexpr double dt = 1e-6;

/// Overlapping spheres of two kinds in a box, in motion.
struct Spheres {
	std::vector<Place> places;
	std::vector<Motion> motions;
	PairContacts contacts;

	explicit Spheres(int count)
	{
		const auto x = support::randomVectors(count, 1e-2, 1), v = support::randomVectors(count, 1, 2), w = support::randomVectors(count, 100, 3);
		Random random(4);
		for (int i = 0; i < count; ++i) {
			places.push_back({x[i], random.uniform(1e-3, 3e-3)});
			motions.push_back({v[i], w[i]});
		}
		std::vector<int> same(count);
		std::iota(same.begin(), same.end(), 0);
		list(same, 1e-4);
	}

	/// A new list after the spheres were renumbered: `newIndex` of each.
	void list(const std::vector<int>& newIndex, double gap)
	{
		std::vector<Vec3> centres;
		std::vector<double> radii;
		for (const Place& place : places) {
			centres.push_back(place.centre);
			radii.push_back(place.radius);
		}
		contacts.rebuild(findNearPairs(centres, radii, gap, Vec3::Constant(-0.02), Vec3::Constant(0.02)), newIndex, {{0.5, 0.1}, {0, 0}},
		                 [](int i, int j) { return SpringsOfKind{{1e5, 3e4, 1e-3}, (i + j) % 3 == 0}; });
	}

	/// One step by so many threads, one after the other.
	std::vector<Load> step(int threads, SweepSums* sums = nullptr)
	{
		ThreadPartition parts;
		parts.divide(threads, contacts.rowStart(), int(places.size()));
		contacts.divide(parts);
		std::vector<Load> loads(places.size(), noLoad());
		for (int t = 0; t < threads; ++t) {
			const SweepSums part = contacts.sweep(parts, t, places, motions, loads, dt);
			if (sums) *sums += part;
		}
		for (int t = 0; t < threads; ++t) contacts.addSpills(parts, t, loads);
		return loads;
	}

	void move()
	{
		for (std::size_t i = 0; i < places.size(); ++i) places[i].centre += dt * motions[i].velocity;
	}

	std::map<std::pair<int, int>, Contact> touching() const
	{
		std::map<std::pair<int, int>, Contact> all;
		contacts.forEachTouching([&](int i, int j, const Contact& contact) { all[{i, j}] = contact; });
		return all;
	}
};

double difference(const std::vector<Load>& a, const std::vector<Load>& b)
{
	std::vector<Vec3> forcesA, forcesB, torquesA, torquesB;
	for (std::size_t i = 0; i < a.size(); ++i) {
		forcesA.push_back(a[i].force);
		forcesB.push_back(b[i].force);
		torquesA.push_back(a[i].torque);
		torquesB.push_back(b[i].torque);
	}
	return std::max(support::relativeDifference(forcesA, forcesB), support::relativeDifference(torquesA, torquesB));
}

} // namespace

TEST(PairContacts, touchingIsWhatOverlaps)
{
	Spheres spheres(60);
	spheres.step(1);
	const auto touching = spheres.touching();
	int overlapping = 0;
	for (int i = 0; i < 60; ++i)
		for (int j = i + 1; j < 60; ++j) {
			const bool overlap = (spheres.places[i].centre - spheres.places[j].centre).norm() < spheres.places[i].radius + spheres.places[j].radius;
			overlapping += overlap;
			EXPECT_EQ(touching.count({i, j}), std::size_t(overlap)) << i << " " << j;
		}
	EXPECT_GT(overlapping, 50);
	EXPECT_GT(spheres.contacts.size(), overlapping) << "some are near only";
}

// Nothing from outside: forces sum to nothing, and so do their moments about any point.
TEST(PairContacts, forcesAndMomentsAreInternal)
{
	Spheres spheres(60);
	for (int k = 0; k < 20; ++k) {
		const auto loads = spheres.step(1);
		Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
		double size = 0;
		for (int i = 0; i < 60; ++i) {
			force += loads[i].force;
			moment += loads[i].torque + spheres.places[i].centre.cross(loads[i].force);
			size += loads[i].force.norm();
		}
		ASSERT_GT(size, 100);
		ASSERT_LT(force.norm(), 1e-13 * size);
		ASSERT_LT(moment.norm(), 1e-13 * size * 1e-2);
		spheres.move();
	}
}

TEST(PairContacts, threadsShareTheWorkToRounding)
{
	Spheres one(60);
	SweepSums sums;
	std::vector<std::vector<Load>> loads;
	for (int k = 0; k < 20; ++k, one.move()) loads.push_back(one.step(1, &sums));
	EXPECT_GT(sums.works.slip, 0);
	for (const int threads : {2, 3, 7}) {
		Spheres several(60), again(60);
		SweepSums shared;
		for (int k = 0; k < 20; ++k, several.move(), again.move()) {
			const auto now = several.step(threads, &shared);
			ASSERT_LT(difference(now, loads[k]), 1e-12) << threads << " threads, step " << k;
			ASSERT_EQ(difference(again.step(threads), now), 0) << "the same bits for the same number";
		}
		EXPECT_NEAR(shared.works.slip / sums.works.slip, 1, 1e-12);
	}
}

TEST(PairContacts, memoriesFollowTheirSpheresToNewIndices)
{
	Spheres spheres(40);
	for (int k = 0; k < 5; ++k, spheres.move()) spheres.step(1);
	const auto before = spheres.touching();
	ASSERT_GT(before.size(), 20u);
	// turned round: every pair's first sphere becomes its second
	std::vector<int> newIndex(40);
	for (int i = 0; i < 40; ++i) newIndex[i] = 39 - i;
	std::reverse(spheres.places.begin(), spheres.places.end());
	spheres.list(newIndex, 2e-4);
	const auto after = spheres.touching();
	ASSERT_EQ(after.size(), before.size());
	int remembering = 0;
	for (const auto& [pair, contact] : before) {
		const auto found = after.find({39 - pair.second, 39 - pair.first});
		ASSERT_NE(found, after.end());
		const Contact& moved = found->second;
		EXPECT_EQ((moved.memory.normal + contact.memory.normal).norm(), 0) << "from the first sphere to the second";
		const bool smoothNow = (39 - pair.first + 39 - pair.second) % 3 == 0;
		if (smoothNow) continue; // this test's kinds go by index
		EXPECT_EQ((moved.memory.shear + contact.memory.shear).norm(), 0) << "what the second sphere feels";
		remembering += contact.memory.shear.norm() > 0;
	}
	EXPECT_GT(remembering, 8);
}

TEST(PairContacts, whatIsRestoredIsThereAndUnknownPairsAreTold)
{
	Spheres spheres(40);
	spheres.step(1);
	const auto [pair, contact] = *spheres.touching().begin();
	Contact bonded = contact;
	bonded.memory.shear = 0.01 * bonded.memory.normal.unitOrthogonal();
	bonded.law.tensileStrength = 7;
	bonded.law.shearStrength = 8;
	bonded.bits = contactTouching | contactBonded;
	EXPECT_TRUE(spheres.contacts.restore(pair.first, pair.second, bonded));
	const Contact there = spheres.touching()[pair];
	EXPECT_TRUE(there.bonded());
	EXPECT_EQ(there.law.tensileStrength, 7);
	EXPECT_EQ(there.law.shearStrength, 8);
	EXPECT_EQ((there.memory.shear - bonded.memory.shear).norm(), 0);
	// from the other side the same contact is its mirror image
	EXPECT_TRUE(spheres.contacts.restore(pair.second, pair.first, bonded.swapped()));
	EXPECT_EQ((spheres.touching()[pair].memory.shear - bonded.memory.shear).norm(), 0);
	std::vector<std::pair<int, int>> listed;
	spheres.contacts.forEachPair([&](int i, int j) { listed.emplace_back(i, j); });
	EXPECT_EQ(int(listed.size()), spheres.contacts.size());
	for (int i = 0; i < 40; ++i)
		for (int j = i + 1; j < 40; ++j)
			if (!std::count(listed.begin(), listed.end(), std::make_pair(i, j))) {
				EXPECT_FALSE(spheres.contacts.restore(i, j, contact));
				return;
			}
}
