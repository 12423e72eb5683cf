// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "Support.hpp"
#include "kernels/membrane/BondForce.hpp"
#include "tests/kernels/oracle/BondForceReference.hpp"

#include <omp.h>

using namespace hexmembrane;
using support::load;
using support::relativeDifference;

namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

BondLaw law(double kn, double ks = 0, double tensile = inf, double shear = inf, double friction = 0, bool tensionOnly = false)
{
	return {kn, ks, tensile, shear, friction, tensionOnly};
}

/// A membrane with its bonds, fast and slow side by side.
struct Pair {
	HexLattice tube = support::smallTube();
	BondLaw rule;
	BondForce fast;
	reference::Memory fastState, slowState;
	reference::Particles p;

	explicit Pair(const BondLaw& l) : rule(l), fast(tube, l)
	{
		load(fast.position, tube, tube.positions);
		fastState.restLength = fast.lengths();
		slowState = fastState;
		if (rule.ks > 0) slowState.shear.assign(tube.bonds.size(), Vec3::Zero());
		p.position = tube.positions;
		p.velocity.assign(tube.positions.size(), Vec3::Zero());
		p.spin = p.velocity;
	}

	void step(double dt)
	{
		load(fast.position, tube, p.position);
		if (rule.ks > 0) {
			load(fast.velocity, tube, p.velocity);
			load(fast.spin, tube, p.spin);
		}
		fast.compute(fastState.state(), dt);
		reference::bondForces(tube.bonds, rule, slowState, p, dt);
	}
};

/// Several steps of shaken motion; the largest difference of fast and slow.
double worstDifference(const BondLaw& l, int* brokenBonds = nullptr)
{
	Pair pair(l);
	const double dt = 1e-4;
	double worst = 0;
	for (unsigned s = 0; s < 5; ++s) {
		pair.p.velocity = support::randomVectors(pair.tube.positions.size(), 2., 10 + s);
		pair.p.spin = support::randomVectors(pair.tube.positions.size(), 500., 20 + s);
		for (size_t i = 0; i < pair.p.position.size(); ++i) pair.p.position[i] += dt * pair.p.velocity[i];
		pair.step(dt);
		worst = std::max(worst, relativeDifference(pair.fast.force.vectors(), pair.p.force));
		if (l.ks > 0) worst = std::max(worst, relativeDifference(pair.fast.torque.vectors(), pair.p.torque));
	}
	if (brokenBonds) {
		*brokenBonds = 0;
		for (size_t b = 0; b < pair.tube.bonds.size(); ++b) {
			EXPECT_EQ(pair.fastState.broken[b], pair.slowState.broken.empty() ? 0 : pair.slowState.broken[b]);
			*brokenBonds += pair.fastState.broken[b];
		}
	}
	return worst;
}

} // namespace

TEST(BondForce, fastEqualsReference)
{
	EXPECT_LT(worstDifference(law(346)), 1e-12) << "central";
	EXPECT_LT(worstDifference(law(346, 0, inf, inf, 0, true)), 1e-12) << "tension only";
	EXPECT_LT(worstDifference(law(346, 200)), 1e-12) << "shear";
}

TEST(BondForce, fastEqualsReferenceWithBreakage)
{
	int broken = 0;
	EXPECT_LT(worstDifference(law(346, 0, 0.08), &broken), 1e-12);
	EXPECT_GT(broken, 0);
	EXPECT_LT(worstDifference(law(346, 346, inf, 0.05, 0.5), &broken), 1e-12);
	EXPECT_GT(broken, 0);
}

TEST(BondForce, slitOfUnbreakableBonds)
{
	Pair pair(law(346));
	pair.fastState.broken.assign(pair.tube.bonds.size(), 0);
	for (size_t b = 0; b < pair.tube.bonds.size(); b += 3) pair.fastState.broken[b] = 1;
	pair.slowState.broken = pair.fastState.broken;
	support::shake(pair.p.position, 2e-4, 3);
	pair.step(1e-4);
	EXPECT_LT(relativeDifference(pair.fast.force.vectors(), pair.p.force), 1e-12);
	int pulled = 0;
	for (size_t b = 0; b < pair.tube.bonds.size(); ++b) {
		const double force = pair.fast.normalForce(pair.fastState.state(), static_cast<int>(b));
		if (pair.fastState.broken[b])
			EXPECT_LE(force, 0);
		else
			pulled += force > 0;
	}
	EXPECT_GT(pulled, 0);
}

TEST(BondForce, generatedMembraneIsFreeOfStress)
{
	Pair pair(law(1e5));
	pair.step(0);
	for (const auto& f : pair.fast.force.vectors()) ASSERT_LT(f.norm(), 1e-14 * 1e5 * 2 * pair.tube.sphereRadius) << "rounding of a length, times kn";
}

TEST(BondForce, forceIsMinusGradientOfEnergy)
{
	Pair pair(law(346));
	support::shake(pair.p.position, 2e-4, 3);
	pair.step(0);
	const auto force = pair.fast.force.vectors();
	const double h = 1e-7;
	double worst = 0, size = 0;
	for (const int v : {0, 5, pair.tube.at(3, 0), pair.tube.at(4, pair.tube.perRing - 1), pair.tube.particles() - 1})
		for (int a = 0; a < 3; ++a) {
			double e[2];
			for (int side = 0; side < 2; ++side) {
				auto x = pair.p.position;
				x[v][a] += side ? h : -h;
				load(pair.fast.position, pair.tube, x);
				e[side] = pair.fast.energy(pair.fastState.state());
			}
			worst = std::max(worst, std::abs(-(e[1] - e[0]) / (2 * h) - force[v][a]));
			size = std::max(size, force[v].norm());
		}
	EXPECT_LT(worst, 1e-6 * size) << "central differences: h^2 and rounding";
}

TEST(BondForce, neitherResultantNorMoment)
{
	Pair pair(law(346, 173));
	pair.p.velocity = support::randomVectors(pair.tube.positions.size(), 1., 5);
	pair.p.spin = support::randomVectors(pair.tube.positions.size(), 300., 6);
	support::shake(pair.p.position, 2e-4, 7);
	pair.step(1e-4);
	Vec3 resultant = Vec3::Zero(), moment = Vec3::Zero();
	double size = 0;
	const auto force = pair.fast.force.vectors(), torque = pair.fast.torque.vectors();
	for (size_t i = 0; i < force.size(); ++i) {
		resultant += force[i];
		moment += pair.p.position[i].cross(force[i]) + torque[i];
		size += force[i].norm();
	}
	EXPECT_LT(resultant.norm(), 1e-13 * size);
	EXPECT_LT(moment.norm(), 1e-13 * size * 0.05);
}

TEST(BondForce, rigidMotionLeavesShearUntouched)
{
	// a whole turn about a slanted axis in 2000 steps: the incremental shear must come back, its drift is that of the step (third order in the angle)
	Pair pair(law(346, 200));
	const Vec3 axis = Vec3(1, 2, 3).normalized();
	const int steps = 2000;
	const double dt = 1e-3, spin = 2 * M_PI / (steps * dt);
	// load one bond first by sliding a single particle
	pair.p.velocity[40] = Vec3(0, 0, 0.1);
	pair.p.position[40] += dt * pair.p.velocity[40];
	pair.step(dt);
	std::vector<double> before;
	for (const auto& s : pair.fastState.shear) before.push_back(s.norm());
	const auto start = pair.p.position;
	for (int s = 1; s <= steps; ++s) {
		const Eigen::AngleAxisd turn(2 * M_PI * s / steps, axis), half(2 * M_PI * (s - 0.5) / steps, axis);
		for (size_t i = 0; i < start.size(); ++i) {
			const Vec3 now = turn * start[i];
			pair.p.velocity[i] = (now - pair.p.position[i]) / dt;
			pair.p.position[i] = now;
			pair.p.spin[i] = spin * axis;
		}
		pair.step(dt);
	}
	ASSERT_GT(*std::max_element(before.begin(), before.end()), 0);
	// the chord 2 sin(a/2) of the positions against the arc a of the spins: a^3/12 of a bond's length each step
	const double drift = pair.rule.ks * 2 * pair.tube.sphereRadius * steps * std::pow(2 * M_PI / steps, 3) / 12;
	for (size_t b = 0; b < before.size(); ++b) ASSERT_NEAR(pair.fastState.shear[b].norm(), before[b], 1.2 * drift) << b;
}

TEST(BondForce, breaksInTensionAndCarriesNoTensionAfter)
{
	Pair pair(law(1000, 0, 0.1));
	const double limit = 0.1 / 1000;
	// lift the whole upper end: all inter-ring bonds of one row stretch alike
	for (const double lift : {0.5 * limit, 3 * limit, 0.5 * limit}) {
		pair.p.position = pair.tube.positions;
		for (int k = 4; k < pair.tube.rings; ++k)
			for (int i = 0; i < pair.tube.perRing; ++i) pair.p.position[pair.tube.at(k, i)][2] += lift;
		pair.step(0);
		const int broken = std::count(pair.fastState.broken.begin(), pair.fastState.broken.end(), 1);
		const auto force = pair.fast.force.vectors();
		if (lift < limit && broken == 0)
			EXPECT_GT(force[pair.tube.at(3, 0)][2], 0);
		else {
			EXPECT_EQ(broken, 2 * pair.tube.perRing);
			EXPECT_EQ(force[pair.tube.at(3, 0)].norm(), 0) << "lift " << lift;
		}
	}
}

TEST(BondForce, tensionOnlyCarriesNoCompression)
{
	Pair pair(law(346, 0, inf, inf, 0, true));
	for (auto& x : pair.p.position) x *= 0.97;
	pair.step(0);
	for (const auto& f : pair.fast.force.vectors()) ASSERT_EQ(f.norm(), 0);
}

// A bond without a direction has no force. From kn L0 = 4 N on, a force over the smallest number there is would not be finite; the last kn is 200 N.
TEST(BondForce, coincidentParticlesGiveNoNan)
{
	for (const double kn : {346., 5e4})
		for (const double ks : {0., 100.}) {
			Pair pair(law(kn, ks));
			pair.p.position[1] = pair.p.position[0];
			pair.step(0);
			EXPECT_LT(relativeDifference(pair.fast.force.vectors(), pair.p.force), 1e-12) << "kn " << kn << ", ks " << ks;
		}
}

// Nearer than the square root of the smallest number: distances underflow.
TEST(BondForce, almostCoincidentParticlesGiveNoNan)
{
	for (const double gap : {1e-300, 1e-161, 1e-150, 1e-20}) {
		Pair pair(law(5e4));
		pair.p.position[0] = Vec3::Zero();
		pair.p.position[1] = Vec3(gap, 0, 0);
		pair.step(0);
		for (const Vec3& f : pair.fast.force.vectors()) ASSERT_TRUE(f.allFinite()) << "gap " << gap;
	}
}

TEST(BondForce, threadsDoNotChangeABit)
{
	std::vector<std::vector<Vec3>> results;
	for (const int threads : {1, 2, 3}) {
		omp_set_num_threads(threads);
		Pair pair(law(346, 100));
		pair.p.velocity = support::randomVectors(pair.tube.positions.size(), 1., 5);
		support::shake(pair.p.position, 2e-4, 7);
		pair.step(1e-4);
		results.push_back(pair.fast.force.vectors());
	}
	omp_set_num_threads(1);
	EXPECT_EQ(relativeDifference(results[1], results[0]), 0);
	EXPECT_EQ(relativeDifference(results[2], results[0]), 0);
}

TEST(BondForce, badLawIsNamed)
{
	EXPECT_COMPLAINT(law(-1).check(), "kn = -1");
	EXPECT_COMPLAINT(law(1, -1).check(), "ks = -1");
	EXPECT_COMPLAINT(law(1, 0, 0).check(), "tensileStrength = 0");
	EXPECT_COMPLAINT(law(1, 1, inf, std::nan("")).check(), "shearStrength = nan");
	EXPECT_COMPLAINT(law(1, 1, inf, inf, 0, true).check(), "tensionOnly = 1");
}
