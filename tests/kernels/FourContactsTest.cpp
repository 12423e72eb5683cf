// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "Support.hpp"
#include "kernels/base/Random.hpp"
#include "kernels/compact/FourContacts.hpp"

#include <cmath>
#include <vector>

using namespace hexmembrane;

namespace {

/// Contacts that stick, slide, roll, open, and such as lack shear springs, rolling resistance or both, at random.
struct Case {
	ContactMemory memory;
	unsigned char bits;
	Vec3 normal;
	double overlap;
	Motion body1, body2;
	Frictions kind;
};

constexpr double dt = 1e-5;

std::vector<Case> cases(int count)
{
	Random random(1);
	const auto anywhere = [&](double size) { return Vec3(random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)); };
	std::vector<Case> all;
	for (int c = 0; c < count; ++c) {
		const Vec3 before = anywhere(1).normalized();
		Case one{};
		one.normal = (before + anywhere(1e-3)).normalized();
		one.overlap = random.uniform(-0.3e-5, 1e-5);
		one.body1 = {anywhere(1), anywhere(300)};
		one.body2 = {anywhere(1), anywhere(300)};
		one.kind = {random.uniform(0, 2), c % 3 == 0 ? 0 : random.uniform(0.01, 2)};
		const double ks = c % 5 == 0 ? 0 : 3e4, lever = random.uniform(0.5e-3, 1e-3), kr = one.kind.rolling > 0 ? ks * lever * lever : 0;
		one.memory.law = {1e5, ks, one.kind.sliding, kr, one.kind.rolling * lever, 0, 0};
		one.bits = c % 7 ? contactTouching : 0;
		one.memory.shear = one.memory.moment = one.memory.normal = Vec3::Zero();
		if (one.bits) {
			one.memory.normal = before;
			if (ks > 0) one.memory.shear = acrossNormal(anywhere(0.3), before);
			if (kr > 0) one.memory.moment = acrossNormal(anywhere(3e-4), before);
		}
		all.push_back(one);
	}
	return all;
}

/// Each with a kind of its own.
ContactStore stored(const std::vector<Case>& cases)
{
	std::vector<Frictions> table;
	for (const Case& one : cases) table.push_back(one.kind);
	ContactStore store;
	store.start(cases.size(), table);
	for (int c = 0; c < int(cases.size()); ++c) {
		store.setLaw(c, {cases[c].memory.law, c});
		store.put(c, cases[c].memory, cases[c].bits);
	}
	return store;
}

} // namespace

TEST(FourContacts, doWhatFourTimesOneDoes)
{
	const double arm1 = 1e-3, arm2 = 2e-3;
	std::vector<Case> ones = cases(4000);
	ContactStore store = stored(ones);
	int opened = 0, slid = 0, rolled = 0;
	for (int at = 0; at < int(ones.size()); at += 4) {
		const int index[4] = {at, at + 1, at + 2, at + 3};
		Four four;
		Lanes3 velocity, spinSum, spinDifference;
		const auto set = [](Lanes3& to, int k, const Vec3& v) {
			to.x[k] = v[0];
			to.y[k] = v[1];
			to.z[k] = v[2];
		};
		for (int k = 0; k < 4; ++k) {
			const Case& one = ones[at + k];
			set(four.normal, k, one.normal);
			four.overlap[k] = one.overlap;
			set(velocity, k,
			    relativeVelocity(one.body1.velocity, one.body1.spin, arm1 * one.normal, one.body2.velocity, one.body2.spin, -arm2 * one.normal));
			set(spinSum, k, one.body1.spin + one.body2.spin);
			set(spinDifference, k, one.body2.spin - one.body1.spin);
		}
		four.path = contactPath(four.normal, velocity, spinSum, spinDifference, dt);
		FourSums sums;
		advance(store, index, four, sums);
		for (int k = 0; k < 4; ++k) {
			Case& one = ones[at + k];
			Vec3 force;
			SweepSums expected;
			const bool closed = advanceMemory(one.memory, one.bits, one.overlap, one.normal, one.body1, arm1 * one.normal, one.body2,
			                                  -arm2 * one.normal, dt, force, expected);
			if (!closed) force = Vec3::Zero();
			const Lanes3 got = four.normalForce * four.normal + four.shear;
			EXPECT_LT((Vec3(got.x[k], got.y[k], got.z[k]) - force).norm(), 1e-12) << at + k;
			const ContactMemory memory = store.get(at + k);
			EXPECT_LT((memory.shear - one.memory.shear).norm(), 1e-12) << at + k;
			EXPECT_LT((memory.moment - one.memory.moment).norm(), 1e-15) << at + k;
			EXPECT_EQ(memory.normal, one.memory.normal);
			EXPECT_EQ(memory.law.kn, one.memory.law.kn);
			EXPECT_EQ(memory.law.friction, one.memory.law.friction);
			EXPECT_EQ(store.bits[at + k], one.bits) << at + k;
			EXPECT_NEAR(sums.slip[k], expected.slip, 1e-12 * std::abs(expected.slip) + 1e-20) << at + k;
			EXPECT_NEAR(sums.roll[k], expected.roll, 1e-12 * std::abs(expected.roll) + 1e-20) << at + k;
			opened += !closed;
			slid += closed && expected.slip > 0;
			rolled += closed && expected.roll > 0;
		}
	}
	EXPECT_GT(opened, 500);
	EXPECT_GT(slid, 500);
	EXPECT_GT(rolled, 300);
}

TEST(ContactStore, givesBackWhatItGot)
{
	const std::vector<Case> all = cases(100);
	ContactStore store = stored(all);
	ContactMemory bonded = all[1].memory;
	bonded.law.tensileStrength = 3;
	bonded.law.shearStrength = 4;
	store.put(1, bonded, contactTouching | contactBonded);
	for (int c = 0; c < int(all.size()); ++c) {
		const ContactMemory got = store.get(c);
		const ContactLaw& law = all[c].memory.law;
		EXPECT_EQ(got.shear, all[c].memory.shear);
		EXPECT_EQ(got.moment, all[c].memory.moment);
		EXPECT_EQ(got.normal, all[c].memory.normal);
		EXPECT_EQ(got.law.kn, law.kn);
		EXPECT_EQ(got.law.ks, law.ks);
		EXPECT_EQ(got.law.friction, law.friction);
		EXPECT_NEAR(got.law.kr, law.kr, 1e-15 * law.kr);
		EXPECT_NEAR(got.law.rollingArm, law.rollingArm, 1e-15 * law.rollingArm);
		EXPECT_EQ(got.law.tensileStrength, c == 1 ? 3 : 0);
		EXPECT_EQ(got.law.shearStrength, c == 1 ? 4 : 0);
	}
}

TEST(FourContacts, aNaNStays)
{
	std::vector<Case> ones = cases(4);
	const int index[4] = {0, 1, 2, 3};
	Four four;
	for (Case& one : ones) {
		one.memory.law.ks = 3e4;
		one.bits = contactTouching;
	}
	ContactStore store = stored(ones);
	four.normal = {lanes(1), lanes(0), lanes(0)};
	four.overlap = lanes(1e-6);
	const Lanes3 nothing{lanes(0), lanes(0), lanes(0)};
	Lanes3 velocity = nothing;
	velocity.y[2] = std::nan("");
	four.path = contactPath(four.normal, velocity, nothing, nothing, dt);
	FourSums sums;
	advance(store, index, four, sums);
	for (int k = 0; k < 4; ++k) EXPECT_EQ(std::isnan(store.get(k).shear.sum()), k == 2);
}
