// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "Support.hpp"
#include "kernels/compact/GrainMotion.hpp"

#include <cmath>

using namespace hexmembrane;

namespace {

constexpr int count = 13;

/// Grains in random motion under random loads, and the arrays of a step.
struct Grains {
	std::vector<Place> places;
	std::vector<Motion> motions;
	std::vector<Load> loads;
	std::vector<double> mass, inertia;
	std::vector<unsigned char> fixed;
	std::vector<Vec3> turned;
	GrainMotion step;

	explicit Grains(unsigned seed, double damping = 0.3, double dt = 0.1)
	{
		const auto x = support::randomVectors(count, 1, seed), v = support::randomVectors(count, 1, seed + 1),
		           w = support::randomVectors(count, 1, seed + 2);
		const auto f = support::randomVectors(count, 5, seed + 3), t = support::randomVectors(count, 5, seed + 4);
		turned = support::randomVectors(count, 1, seed + 5);
		for (int i = 0; i < count; ++i) {
			places.push_back({x[i], 0.1 + i});
			motions.push_back({v[i], w[i]});
			loads.push_back({f[i], t[i]});
			mass.push_back(1 + 0.1 * i);
			inertia.push_back(2 - 0.1 * i);
			fixed.push_back(i % 5 == 4);
		}
		step = {places.data(),
		        motions.data(),
		        loads.data(),
		        mass.data(),
		        inertia.data(),
		        fixed.data(),
		        turned.data(),
		        0,
		        count,
		        dt,
		        damping,
		        1e6,
		        true,
		        0,
		        0,
		        0,
		        0};
	}
};

/// Velocity of one component after a step, by the rule in words: damping takes its share of what speeds the component up, judged half a step on, and adds it
/// to what slows it down.
double after(double velocity, double load, double inertia, double dt, double damping)
{
	const double halfway = velocity + 0.5 * dt * load / inertia;
	if (load * halfway > 0)
		load -= damping * load;
	else if (load * halfway < 0)
		load += damping * load;
	return velocity + dt * load / inertia;
}

} // namespace

TEST(GrainMotion, everyComponentFollowsTheDampedLaw)
{
	Grains grains(1);
	const Grains before = grains;
	moveGrains(grains.step);
	for (int i = 0; i < count; ++i) {
		const Motion &old = before.motions[i], &now = grains.motions[i];
		for (int a = 0; a < 3; ++a) {
			if (before.fixed[i]) {
				EXPECT_EQ(now.velocity[a], old.velocity[a]) << "a fixed grain moves on as it is told";
				EXPECT_EQ(now.spin[a], old.spin[a]);
			} else {
				EXPECT_NEAR(now.velocity[a], after(old.velocity[a], before.loads[i].force[a], before.mass[i], 0.1, 0.3), 1e-14);
				EXPECT_NEAR(now.spin[a], after(old.spin[a], before.loads[i].torque[a], before.inertia[i], 0.1, 0.3), 1e-14);
			}
			EXPECT_NEAR(grains.places[i].centre[a], before.places[i].centre[a] + 0.1 * now.velocity[a], 1e-15);
			EXPECT_NEAR(grains.turned[i][a], before.turned[i][a] + 0.1 * now.spin[a], 1e-15);
		}
		EXPECT_EQ(grains.places[i].radius, before.places[i].radius);
	}
	EXPECT_EQ(grains.step.lost, count) << "none";
}

TEST(GrainMotion, restUnderNoLoadStaysAtRest)
{
	Grains grains(2);
	for (auto& motion : grains.motions) motion = {Vec3::Zero(), Vec3::Zero()};
	for (auto& load : grains.loads) load = noLoad();
	const auto places = grains.places;
	moveGrains(grains.step);
	for (int i = 0; i < count; ++i) EXPECT_EQ((grains.places[i].centre - places[i].centre).norm(), 0);
	EXPECT_EQ(grains.step.fastest2, 0);
}

// Gain of kinetic energy + what damping took = work of the loads, both by the trapezoidal rule of leapfrog, where no component turns round.
TEST(GrainMotion, dampingIsBookedToFirstOrder)
{
	for (const double dt : {1e-3, 1e-4}) {
		Grains grains(3, 0.3, dt);
		std::fill(grains.fixed.begin(), grains.fixed.end(), 0);
		const Grains before = grains;
		moveGrains(grains.step);
		double kinetic = 0, work = 0, gain = 0;
		for (int i = 0; i < count; ++i) {
			const Motion &old = before.motions[i], &now = grains.motions[i];
			kinetic += 0.5 * grains.mass[i] * old.velocity.squaredNorm() + 0.5 * grains.inertia[i] * old.spin.squaredNorm();
			gain += 0.5 * grains.mass[i] * (now.velocity.squaredNorm() - old.velocity.squaredNorm());
			gain += 0.5 * grains.inertia[i] * (now.spin.squaredNorm() - old.spin.squaredNorm());
			work += dt * before.loads[i].force.dot(0.5 * (old.velocity + now.velocity)) +
			        dt * before.loads[i].torque.dot(0.5 * (old.spin + now.spin));
		}
		EXPECT_NEAR(grains.step.kinetic / kinetic, 1, 1e-14) << "by the velocities before the step";
		EXPECT_NEAR((work - gain) / grains.step.dampedWork, 1, 20 * dt);
		EXPECT_GT(grains.step.dampedWork, 0);
	}
}

TEST(GrainMotion, aFixedGrainBooksNoDamping)
{
	Grains grains(4);
	std::fill(grains.fixed.begin(), grains.fixed.end(), 1);
	moveGrains(grains.step);
	EXPECT_EQ(grains.step.dampedWork, 0);
	EXPECT_GT(grains.step.kinetic, 0);
	grains.step.energies = false;
	moveGrains(grains.step);
	EXPECT_EQ(grains.step.kinetic, 0) << "not asked for";
}

TEST(GrainMotion, tellsTheFastestAndTheFirstLost)
{
	Grains grains(5, 0, 1e-9);
	grains.motions[6].velocity = Vec3(3, -4, 12);
	moveGrains(grains.step);
	EXPECT_NEAR(grains.step.fastest2, 169, 1e-5);
	grains.step.limit2 = 168;
	moveGrains(grains.step);
	EXPECT_EQ(grains.step.lost, 6);
	grains.step.limit2 = 1e6;
	const double nan = std::nan("");
	for (const int where : {9, 3}) {
		Grains bad(6, 0, 1e-9);
		bad.motions[11].velocity[1] = nan;
		if (where == 9)
			bad.motions[9].spin[2] = INFINITY;
		else
			bad.motions[3].spin[0] = nan;
		moveGrains(bad.step);
		EXPECT_EQ(bad.step.lost, where);
	}
}

TEST(GrainMotion, movesItsRangeOnly)
{
	Grains grains(7), whole(7);
	moveGrains(whole.step);
	const auto before = grains.places;
	grains.step.from = 4;
	grains.step.to = 9;
	moveGrains(grains.step);
	for (int i = 0; i < count; ++i) EXPECT_EQ((grains.places[i].centre - (i >= 4 && i < 9 ? whole : Grains(7)).places[i].centre).norm(), 0) << i;
	EXPECT_EQ(grains.step.lost, 9);
}
