// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "Support.hpp"
#include "kernels/compact/MembraneMotion.hpp"

#include <cmath>

using namespace hexmembrane;

namespace {

constexpr double dt = 0.1, damping = 0.3, mass = 1.7, inertia = 0.9;
constexpr int rings = 5, grains = 4;

PaddedRings rowsOf(int n, const std::vector<Vec3>& values)
{
	PaddedRings rows(n, rings);
	for (int k = 0; k < rings; ++k) {
		for (int i = 0; i < n; ++i) rows.set(k, i, values[k * n + i]);
		rows.wrap(k);
	}
	return rows;
}

/// A membrane of n particles a ring in random motion: forces of two terms, frictionless contacts on all, other loads on some particles.
struct Membrane {
	int n;
	std::vector<Vec3> x, v, w, bonds, pressure, pushes, torque;
	std::vector<Load> loads;
	std::vector<int> loaded;
	PaddedRings position, velocity, spin, bondRows, pressureRows, torqueRows;
	std::vector<PaddedForce> onParticle;
	std::vector<Place> places;
	std::vector<Motion> motions;
	MembraneMotion motion;
	std::vector<MembraneMotion::Term> terms;
	std::vector<MembraneMotion::Grip> grips;
	std::vector<unsigned char> blocked;

	explicit Membrane(int perRing) : n(perRing), motion(HexStencil{perRing, rings})
	{
		const auto random = [&](double size, unsigned seed) { return support::randomVectors(n * rings, size, seed); };
		x = random(1, 1);
		v = random(1, 2);
		w = random(1, 3);
		bonds = random(5, 4);
		pressure = random(5, 5);
		pushes = random(5, 6);
		torque = random(5, 7);
		const auto forces = random(5, 8), torques = random(5, 9);
		for (int m = 0; m < n * rings; ++m) {
			onParticle.push_back({pushes[m], 0});
			places.push_back({x[m], 0.5 + m});
			motions.push_back({Vec3::Constant(NAN), Vec3::Constant(NAN)});
			const bool acts = m % 3 == 1;
			loads.push_back(acts ? Load{forces[m], torques[m]} : noLoad());
			if (acts) loaded.push_back(grains + m);
		}
		position = rowsOf(n, x);
		velocity = rowsOf(n, v);
		spin = rowsOf(n, w);
		bondRows = rowsOf(n, bonds);
		pressureRows = rowsOf(n, pressure);
		torqueRows = rowsOf(n, torque);
		terms = {{&bondRows, 0, rings - 1, false, {}}, {&pressureRows, 1, 3, true, {}}};
		motion.mass = mass;
		blocked.assign(n * rings, 0);
	}

	int move(double limit = 1e9, int threads = 1)
	{
		motion.setBlocked(blocked);
		return motion.move(dt, damping, limit, terms, grips, {onParticle, loads.data(), loaded, grains, places.data(), motions.data()}, position,
		                   velocity, true, threads);
	}

	/// All that acts on a particle, and what of it the second term is.
	Vec3 forceOn(int m) const { return bonds[m] + pressureOn(m) + pushes[m] + loads[m].force; }
	Vec3 pressureOn(int m) const { return m / n >= 1 && m / n <= 3 ? pressure[m] : Vec3::Zero(); }
};

/// One component after a step, by the rule in words: damping takes its share of what speeds it up, judged half a step on, and adds it to what slows it down.
double after(double velocity, double load, double inert)
{
	const double halfway = velocity + 0.5 * dt * load / inert;
	const double share = load * halfway > 0 ? 1 - damping : load * halfway < 0 ? 1 + damping : 1;
	return velocity + dt * share * load / inert;
}

} // namespace

// Rings of every length modulo four: the rows are moved four at a time, and the rest by itself.
TEST(MembraneMotion, everyParticleFollowsTheDampedLaw)
{
	for (const int n : {6, 7, 8, 9}) {
		Membrane s(n);
		EXPECT_EQ(s.move(), -1);
		double kinetic = 0, damped = 0, fastest = 0;
		for (int m = 0; m < n * rings; ++m) {
			const Vec3 force = s.forceOn(m), now = s.velocity.get(m / n, m % n);
			for (int a = 0; a < 3; ++a) {
				ASSERT_NEAR(now[a], after(s.v[m][a], force[a], mass), 1e-14) << n << " a ring, particle " << m;
				ASSERT_NEAR(s.position.get(m / n, m % n)[a], s.x[m][a] + dt * now[a], 1e-15);
				kinetic += 0.5 * mass * s.v[m][a] * s.v[m][a];
				damped += damping * dt * std::abs(force[a] * s.v[m][a]);
			}
			EXPECT_LT((s.motion.force().get(m / n, m % n) - force).norm(), 1e-14);
			EXPECT_EQ((s.places[m].centre - s.position.get(m / n, m % n)).norm(), 0);
			EXPECT_EQ(s.places[m].radius, 0.5 + m);
			if (m % 3 == 1)
				EXPECT_EQ((s.motions[m].velocity - now).norm(), 0) << "of those that contacts look at";
			else
				EXPECT_TRUE(std::isnan(s.motions[m].velocity[0])) << "nobody looks at it";
			fastest = std::max(fastest, now.norm());
		}
		for (int k = 0; k < rings; ++k) {
			EXPECT_EQ(s.position.row(0, k)[-1], s.position.row(0, k)[n - 1]) << "wrapped";
			EXPECT_EQ(s.velocity.row(2, k)[n], s.velocity.row(2, k)[0]);
		}
		EXPECT_NEAR(s.motion.kinetic / kinetic, 1, 1e-14);
		EXPECT_NEAR(s.motion.dampedWork / damped, 1, 1e-14);
		EXPECT_NEAR(s.motion.fastest, fastest, 1e-14);
	}
}

TEST(MembraneMotion, worksOfATermAreForceTimesWay)
{
	Membrane s(7);
	s.terms[0].worked = true; // two at a time
	s.move();
	for (const int t : {0, 1}) {
		double before = 0, ahead = 0;
		for (int m = 0; m < 7 * rings; ++m) {
			const Vec3 force = t == 0 ? s.bonds[m] : s.pressureOn(m);
			before += 0.5 * dt * force.dot(s.v[m]);
			ahead += 0.5 * dt * force.dot(s.velocity.get(m / 7, m % 7));
		}
		EXPECT_NEAR(s.terms[t].work.before, before, 1e-13);
		EXPECT_NEAR(s.terms[t].work.after, ahead, 1e-13);
	}
}

// The O-rings' work against all forces, and the kinetic energy that they give: with what the forces do the particles' energy closes exactly.
TEST(MembraneMotion, aGrippedRingMovesAsToldAndTheGripPays)
{
	Membrane s(9);
	const Vec3 down(0.1, -0.2, 0.3), up(-0.3, 0.1, 0.2);
	s.grips = {{0, down, {}}, {4, up, {}}};
	s.move();
	for (const auto& grip : s.grips) {
		double kinetic = 0, byForcesBefore = 0, byForcesAfter = 0;
		for (int i = 0; i < 9; ++i) {
			const int m = grip.ring * 9 + i;
			EXPECT_EQ((s.velocity.get(grip.ring, i) - grip.velocity).norm(), 0);
			EXPECT_LT((s.position.get(grip.ring, i) - s.x[m] - dt * grip.velocity).norm(), 1e-15);
			kinetic += 0.5 * mass * (grip.velocity.squaredNorm() - s.v[m].squaredNorm());
			byForcesBefore += 0.5 * dt * s.forceOn(m).dot(s.v[m]);
			byForcesAfter += 0.5 * dt * s.forceOn(m).dot(grip.velocity);
		}
		EXPECT_NEAR(grip.work.atOnce, kinetic, 1e-13);
		EXPECT_NEAR(grip.work.before, -byForcesBefore, 1e-13);
		EXPECT_NEAR(grip.work.after, -byForcesAfter, 1e-13);
	}
	double damped = 0;
	for (int m = 9; m < 4 * 9; ++m) damped += damping * dt * s.v[m].cwiseAbs().dot(s.forceOn(m).cwiseAbs());
	EXPECT_NEAR(s.motion.dampedWork / damped, 1, 1e-14) << "none of those that are held";
}

TEST(MembraneMotion, blockedComponentsAreNotAccelerated)
{
	Membrane s(7);
	s.blocked[9] = 1 << 1;                             // y of one particle
	s.blocked[20] = 1 << 0 | 1 << 2 | 1 << 3 | 1 << 5; // x, z and two rotations of another one
	s.move();
	s.motion.moveSpins(dt, damping, inertia, {&s.torqueRows}, s.loads.data(), s.spin, s.motions.data(), true);
	for (int m = 0; m < 7 * rings; ++m)
		for (int a = 0; a < 3; ++a) {
			const bool stays = s.blocked[m] >> a & 1, keepsSpin = s.blocked[m] >> (3 + a) & 1;
			EXPECT_NEAR(s.velocity.get(m / 7, m % 7)[a], stays ? s.v[m][a] : after(s.v[m][a], s.forceOn(m)[a], mass), 1e-14) << m;
			EXPECT_NEAR(s.spin.get(m / 7, m % 7)[a], keepsSpin ? s.w[m][a] : after(s.w[m][a], (s.torque[m] + s.loads[m].torque)[a], inertia), 1e-14)
			        << m;
		}
}

TEST(MembraneMotion, spinsFollowTheirTorques)
{
	Membrane s(6);
	s.motion.setBlocked(s.blocked);
	EXPECT_EQ(s.motion.moveSpins(dt, damping, inertia, {&s.torqueRows, &s.bondRows}, s.loads.data(), s.spin, s.motions.data(), true), -1);
	double kinetic = 0, damped = 0;
	for (int m = 0; m < 6 * rings; ++m) {
		const Vec3 torque = s.torque[m] + s.bonds[m] + s.loads[m].torque, now = s.spin.get(m / 6, m % 6);
		for (int a = 0; a < 3; ++a) EXPECT_NEAR(now[a], after(s.w[m][a], torque[a], inertia), 1e-14);
		EXPECT_EQ((s.motions[m].spin - now).norm(), 0);
		kinetic += 0.5 * inertia * s.w[m].squaredNorm();
		damped += damping * dt * s.w[m].cwiseAbs().dot(torque.cwiseAbs());
	}
	EXPECT_NEAR(s.motion.kinetic / kinetic, 1, 1e-14);
	EXPECT_NEAR(s.motion.dampedWork / damped, 1, 1e-14);
	s.torqueRows.set(3, 2, Vec3(0, NAN, 0));
	EXPECT_EQ(s.motion.moveSpins(dt, damping, inertia, {&s.torqueRows}, s.loads.data(), s.spin, s.motions.data(), true), 3 * 6 + 2);
}

TEST(MembraneMotion, tellsAParticleThatIsLost)
{
	Membrane fast(7);
	fast.bondRows.set(3, 5, Vec3(0, 0, 1e4));
	EXPECT_EQ(fast.move(10), 3 * 7 + 5);
	Membrane broken(7);
	broken.bondRows.set(2, 6, Vec3(NAN, 0, 0));
	EXPECT_EQ(broken.move(), 2 * 7 + 6);
}

TEST(MembraneMotion, threadsDoNotChangeABit)
{
	Membrane one(9), three(9);
	for (int k = 0; k < 3; ++k) {
		one.move();
		three.move(1e9, 3);
	}
	for (int m = 0; m < 9 * rings; ++m) EXPECT_EQ((one.position.get(m / 9, m % 9) - three.position.get(m / 9, m % 9)).norm(), 0);
	EXPECT_EQ(one.motion.dampedWork, three.motion.dampedWork);
	EXPECT_EQ(one.terms[1].work.after, three.terms[1].work.after);
}
