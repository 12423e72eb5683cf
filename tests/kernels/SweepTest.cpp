// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/compact/Sweep.hpp"

#include "Support.hpp"
#include "kernels/base/Random.hpp"

#include <cmath>
#include <numeric>
#include <vector>

using namespace hexmembrane;

namespace {

/// Contacts that stick, slide, roll, open, and such as have lost a spring while it held something, at random.
struct Case {
	Contact contact;
	PairSprings<double> springs;
	PairKind<double> kind;
	Meeting meeting;
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
		const Vec3 normal = (before + anywhere(1e-3)).normalized();
		one.meeting = {normal,        random.uniform(-0.3e-5, 1e-5), {anywhere(1), anywhere(300)}, {anywhere(1), anywhere(300)}, 1e-3 * normal,
		               -2e-3 * normal};
		one.kind = {c % 11 == 0 ? 0 : random.uniform(0, 2), c % 3 == 0 ? 0 : random.uniform(0.01, 2)};
		one.springs = {1e5, c % 5 == 0 ? 0 : 3e4, random.uniform(0.5e-3, 1e-3)};
		one.contact = {noMemory(), {lawOf(one.springs, one.kind), 0, 0}, static_cast<unsigned char>(c % 7 ? contactTouching : 0)};
		if (one.contact.bits) one.contact.memory = {acrossNormal(anywhere(0.3), before), acrossNormal(anywhere(3e-4), before), before};
		all.push_back(one);
	}
	return all;
}

/// Each with a kind of its own.
ContactStore stored(const std::vector<Case>& cases)
{
	std::vector<PairKind<double>> table;
	for (const Case& one : cases) table.push_back(one.kind);
	ContactStore store;
	store.start(cases.size(), table);
	for (int c = 0; c < int(cases.size()); ++c) {
		store.setSprings(c, {cases[c].springs, c});
		store.put(c, cases[c].contact);
	}
	return store;
}

template <class V>
void setLane(Lanes3<V>& to, int k, const Vec3& v)
{
	to.x[k] = v[0];
	to.y[k] = v[1];
	to.z[k] = v[2];
}

template <class V>
Vec3 lane(const Lanes3<V>& v, int k)
{
	return {v.x[k], v.y[k], v.z[k]};
}

template <class V>
Passing<V> passing(const std::vector<Case>& all, int at)
{
	Passing<V> group{};
	for (int k = 0; k < laneCount<V>; ++k) {
		const Meeting& meeting = all[at + k].meeting;
		const PairMotion<double> motion = meeting.motion();
		setLane(group.normal, k, meeting.normal);
		group.overlap[k] = meeting.overlap;
		setLane(group.motion.velocity, k, motion.velocity);
		setLane(group.motion.spinSum, k, motion.spinSum);
		setLane(group.motion.spinDifference, k, motion.spinDifference);
	}
	return group;
}

/// The law in plain words, branch by branch: nothing of ContactLaw.hpp's steps.
struct Expected {
	double normal = 0, slip = 0, roll = 0;
	Vec3 shear = Vec3::Zero(), moment = Vec3::Zero();
};

Expected plainly(const Case& one)
{
	const Meeting& m = one.meeting;
	const Vec3 &n0 = one.contact.memory.normal, &n = m.normal;
	const auto turned = [&](Vec3 v) {
		v += n0.cross(n).cross(v);
		const Vec3 twist = 0.5 * dt * n0.dot(m.body1.spin + m.body2.spin) * n0;
		return Vec3(v + twist.cross(v));
	};
	const auto across = [&](const Vec3& v) { return Vec3(v - n.dot(v) * n); };
	const Vec3 relative = m.body2.velocity + m.body2.spin.cross(m.arm2) - m.body1.velocity - m.body1.spin.cross(m.arm1);
	Expected e;
	const auto spring = [&](const Vec3& held, const Vec3& rate, double k, double limit, double& work) {
		Vec3 kept = Vec3::Zero();
		if (!(k > 0)) return kept;
		if (m.overlap < 0) {
			work = held.squaredNorm() / (2 * k);
			return kept;
		}
		const Vec3 trial = held - k * dt * across(rate);
		kept = trial.norm() > limit ? Vec3(trial * limit / trial.norm()) : trial;
		if (trial.norm() > limit) work = 0.5 * (held + kept).dot(trial - kept) / k;
		return kept;
	};
	e.normal = m.overlap < 0 ? 0 : one.springs.kn * m.overlap;
	const double r = one.springs.rollingRadius;
	e.shear = spring(turned(one.contact.memory.shear), relative, one.springs.ks, one.kind.friction * e.normal, e.slip);
	e.moment =
	        spring(turned(one.contact.memory.moment), m.body2.spin - m.body1.spin, one.springs.ks * r * r, one.kind.rollingFriction * r * e.normal, e.roll);
	return e;
}

} // namespace

/// Of as many lanes as any set has.
template <class V>
class SweepOf : public testing::Test {};
using Widths = testing::Types<Lanes<2>, Lanes<4>, Lanes<8>>;
TYPED_TEST_SUITE(SweepOf, Widths);

TYPED_TEST(SweepOf, oneContactAndAGroupDoWhatTheLawSays)
{
	constexpr int width = laneCount<TypeParam>;
	std::vector<Case> all = cases(4000);
	ContactStore store = stored(all);
	int opened = 0, slid = 0, rolled = 0, lost = 0;
	for (int at = 0; at < int(all.size()); at += width) {
		int index[width];
		std::iota(index, index + width, at);
		Passing<TypeParam> group = passing<TypeParam>(all, at);
		LaneWorks<TypeParam> works;
		advanceGroup<TypeParam>(store, index, group, dt, works);
		for (int k = 0; k < width; ++k) {
			Case& one = all[at + k];
			const Expected expected = plainly(one);
			const bool held = one.contact.memory.shear.norm() > 0;
			const ContactStep step = advanceContact(one.contact, one.meeting, dt);
			const Contact got = store.get(at + k);
			EXPECT_NEAR(step.normal, expected.normal, 1e-15);
			EXPECT_NEAR(group.normalForce[k], expected.normal, 1e-15);
			for (const Vec3& shear : {one.contact.memory.shear, got.memory.shear, lane(group.shear, k)})
				EXPECT_LT((shear - expected.shear).norm(), 1e-12) << at + k;
			for (const Vec3& moment : {one.contact.memory.moment, got.memory.moment, lane(group.moment, k)})
				EXPECT_LT((moment - expected.moment).norm(), 1e-15) << at + k;
			for (const double slip : {step.works.slip, works.slip[k]}) EXPECT_NEAR(slip, expected.slip, 1e-12 * std::abs(expected.slip) + 1e-20);
			for (const double roll : {step.works.roll, works.roll[k]}) EXPECT_NEAR(roll, expected.roll, 1e-12 * std::abs(expected.roll) + 1e-20);
			EXPECT_EQ(got.memory.normal, one.meeting.normal);
			EXPECT_EQ(got.bits, one.contact.bits);
			EXPECT_EQ(got.bits, step.open ? 0 : contactTouching);
			opened += step.open;
			slid += !step.open && expected.slip > 0;
			rolled += !step.open && expected.roll > 0;
			lost += held && one.springs.ks == 0;
		}
	}
	EXPECT_GT(opened, 500);
	EXPECT_GT(slid, 500);
	EXPECT_GT(rolled, 300);
	EXPECT_GT(lost, 300);
}

TEST(ContactStore, givesBackWhatItGot)
{
	const std::vector<Case> all = cases(100);
	ContactStore store = stored(all);
	Contact bonded = all[1].contact;
	bonded.law.tensileStrength = 3;
	bonded.law.shearStrength = 4;
	bonded.bits = contactTouching | contactBonded;
	store.put(1, bonded);
	for (int c = 0; c < int(all.size()); ++c) {
		const Contact got = store.get(c);
		const ContactLaw& law = all[c].contact.law;
		// what there is no spring for is not kept
		const bool springs = all[c].springs.ks > 0;
		EXPECT_EQ(got.memory.shear, springs ? all[c].contact.memory.shear : Vec3::Zero());
		EXPECT_EQ(got.memory.moment, springs ? all[c].contact.memory.moment : Vec3::Zero());
		EXPECT_EQ(got.memory.normal, all[c].contact.memory.normal);
		EXPECT_EQ(got.law.kn, law.kn);
		EXPECT_EQ(got.law.ks, law.ks);
		EXPECT_EQ(got.law.friction, law.friction);
		EXPECT_EQ(got.law.kr, law.kr);
		EXPECT_EQ(got.law.rollingArm, law.rollingArm);
		EXPECT_EQ(got.law.tensileStrength, c == 1 ? 3 : 0);
		EXPECT_EQ(got.law.shearStrength, c == 1 ? 4 : 0);
		EXPECT_EQ(got.bonded(), c == 1);
	}
}

TYPED_TEST(SweepOf, aNaNStays)
{
	constexpr int width = laneCount<TypeParam>;
	std::vector<Case> all = cases(width);
	for (Case& one : all) {
		one.springs.ks = 3e4;
		one.contact.bits = contactTouching;
		one.meeting = {Vec3::UnitX(), 1e-6, {Vec3::Zero(), Vec3::Zero()}, {Vec3::Zero(), Vec3::Zero()}, Vec3::Zero(), Vec3::Zero()};
	}
	all[1].meeting.body2.velocity[1] = std::nan("");
	ContactStore store = stored(all);
	int index[width];
	std::iota(index, index + width, 0);
	Passing<TypeParam> group = passing<TypeParam>(all, 0);
	LaneWorks<TypeParam> works;
	advanceGroup<TypeParam>(store, index, group, dt, works);
	for (int k = 0; k < width; ++k) EXPECT_EQ(std::isnan(store.get(k).memory.shear.sum()), k == 1);
}
