// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/boundary/PlatenServo.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace {

using namespace hexmembrane;

const double nan = std::numeric_limits<double>::quiet_NaN();

TEST(PlatenServo, RampIsSmoothAndComplete)
{
	EXPECT_EQ(rampWeight(0, 2), 0);
	EXPECT_EQ(rampWeight(-1, 2), 0);
	EXPECT_EQ(rampWeight(2, 2), 1);
	EXPECT_EQ(rampWeight(5, 2), 1);
	EXPECT_EQ(rampWeight(0, 0), 1);
	EXPECT_NEAR(rampWeight(1, 2), 0.5, 1e-15);
	// C1: neighbouring slopes differ by the curvature, pi^2/2/duration^2, times the step.
	const double step = 1e-3;
	double slopeBefore = 0;
	for (double t = -0.5; t < 2.5; t += step) {
		const double slope = (rampWeight(t + step, 2) - rampWeight(t, 2)) / step;
		EXPECT_LT(std::abs(slope - slopeBefore), 1.01 * 9.8697 / 2 / 4 * step);
		EXPECT_GE(slope, 0);
		slopeBefore = slope;
	}
	// The midpoint rule over a whole ramp is exact: half the duration is lost, to rounding.
	double sum = 0;
	for (int i = 0; i < 37; i++) sum += rampWeight((i + 0.5) * 2 / 37, 2) * 2 / 37;
	EXPECT_NEAR(sum, 1, 1e-14);
}

TEST(PlatenServo, FreePlatenFollowsNewton)
{
	const PlatenServo servo{2, 0, 1e9, 1e9};
	EXPECT_NEAR(servoVelocity(servo, 0.3, 0.1, 5, 1), 0.3 + 0.1 * 4 / 2, 1e-15);
	// With the dashpot alone the velocity falls by 1/(1 + c dt/m) a step, for any c, and never turns round.
	for (const double c : {0.1, 20., 1e6}) EXPECT_NEAR(servoVelocity({2, c, 1e9, 1e9}, 0.3, 0.1, 1, 1), 0.3 / (1 + c * 0.1 / 2), 1e-15);
	EXPECT_EQ(servoVelocity({2, 0, 0.25, 0.2}, 0.3, 0.1, 5, 1), 0.25);
	EXPECT_EQ(servoVelocity({2, 0, 0.25, 0.2}, -0.3, 0.1, 1, 5), -0.2);
}

TEST(PlatenServo, LimitsOfTheRecipe)
{
	const PlatenServo servo = makePlatenServo(1e6, 1e-6, 1e-5, 100, 1, nan, nan);
	EXPECT_NEAR(servo.mass, 4e-4, 1e-18);
	EXPECT_NEAR(servo.viscosity, 2 * std::sqrt(1e6 * 4e-4), 1e-12);
	EXPECT_NEAR(servo.maxVelocity * 1e-5 * 1e6, 10, 1e-12); // a tenth of the target a step
	EXPECT_EQ(servo.maxRetreat, servo.maxVelocity);
	EXPECT_EQ(makePlatenServo(1e6, 1e-6, 1e-5, 100, 1, 0.5, nan).mass, 0.5);
	EXPECT_EQ(makePlatenServo(1e6, 1e-6, 1e-5, 100, 1, nan, 0.01).maxVelocity, 0.01);
	EXPECT_NEAR(makePlatenServo(1e6, 1e-6, 1e-5, 100, 1, nan, 1e3).maxVelocity, 1, 1e-14);
	// heavy spheres: a twentieth of the target over the impedance sqrt(K M), whatever the step is
	for (const double dt : {1e-7, 1e-6}) EXPECT_NEAR(makePlatenServo(1e6, 1e-2, dt, 100, 1, nan, nan).maxVelocity, 0.05 * 100 / 100., 1e-14);
}

// A chain of equal masses and springs on a fixed floor under the servo, in the order of a YADE step. Grains have no damping of their own.
struct Chain {
	double stiffness, mass, dt, gap;
	std::vector<double> x, v;              // grains from the bottom; displacement down is negative
	double platen = 0, platenVelocity = 0; // downwards positive
	double floor = 0, floorVelocity = 0;   // upwards positive
	bool flows = false;                    // whether the dashpot lets the mean velocity pass
	double flow = 0;

	Chain(int grains, double k, double m, double step, double initialGap)
	    : stiffness(k), mass(m), dt(step), gap(initialGap), x(static_cast<size_t>(grains), 0.), v(static_cast<size_t>(grains), 0.)
	{
	}

	double contact(double overlap) const { return stiffness * std::max(overlap, 0.); }

	double step(double target)
	{
		const size_t n = x.size();
		std::vector<double> force(n + 1);
		force[0] = contact(floor - x[0]);
		for (size_t i = 1; i < n; i++) force[i] = contact(x[i - 1] - x[i]);
		force[n] = contact(platen - gap + x[n - 1]);
		for (size_t i = 0; i < n; i++) {
			double f = force[i] - force[i + 1];
			// Cundall's local damping, 0.2, as in NewtonIntegrator.
			const double half = v[i] + 0.5 * dt * f / mass;
			f *= 1 - 0.2 * (f * half > 0 ? 1 : f * half < 0 ? -1 : 0);
			v[i] += dt * f / mass;
			x[i] += dt * v[i];
		}
		PlatenServo servo = makePlatenServo(stiffness, mass, dt, target, 1, nan, nan);
		if (floorVelocity > 0) servo.maxRetreat = 1e9;
		platenVelocity = servoVelocity(servo, platenVelocity, dt, target, force[n], flow);
		if (flows) flow = servoFlow(flow, platenVelocity);
		platen += dt * platenVelocity;
		floor += dt * floorVelocity;
		return force[n];
	}
};

TEST(PlatenServo, SettlesWithoutOvershootForAnyStiffness)
{
	for (const double stiffness : {1e3, 1e5, 1e7})
		for (const int grains : {1, 5, 40})
			for (const double safety : {0.05, 0.3, 0.8}) { // of the critical step of the chain
				const double mass = 1e-5, dt = safety * std::sqrt(mass / stiffness), target = 1;
				Chain chain(grains, stiffness, mass, dt, 5 * target / stiffness);
				double peak = 0, force = 0;
				for (int i = 0; i < 400000 && !(i > 1000 && std::abs(force - target) < 1e-9 * target && std::abs(chain.platenVelocity) < 1e-12);
				     i++) {
					force = chain.step(target);
					peak = std::max(peak, force);
				}
				EXPECT_NEAR(force, target, 1e-6) << stiffness << " N/m, " << grains << " grains, " << safety;
				EXPECT_LT(peak, 1.02 * target) << stiffness << " N/m, " << grains << " grains, " << safety;
			}
}

// A specimen that flows: the floor pushes the chain against the servo at a constant speed, at which the dashpot alone takes a fifth of the target.
TEST(PlatenServo, CarriesItsTargetWhileItHasToMove)
{
	for (const double stiffness : {1e3, 1e7})
		for (const int grains : {1, 5, 40}) {
			const double mass = 1e-5, dt = 0.3 * std::sqrt(mass / stiffness), target = 1;
			const PlatenServo servo = makePlatenServo(stiffness, mass, dt, target, 1, nan, nan);
			for (const bool flows : {false, true}) {
				Chain chain(grains, stiffness, mass, dt, 5 * target / stiffness);
				for (int i = 0; i < 40000; i++) chain.step(target);
				chain.flows = flows;
				chain.floorVelocity = 0.2 * target / servo.viscosity;
				double force = 0, largest = 0;
				for (int i = 0; i < 40000; i++) {
					force = chain.step(target);
					if (i > 10000) largest = std::max(largest, std::abs(force / target - 1));
				}
				EXPECT_NEAR(largest, flows ? 0 : 0.2, 1e-3) << stiffness << " N/m, " << grains << " grains";
				EXPECT_NEAR(chain.platenVelocity, -chain.floorVelocity, 1e-3 * chain.floorVelocity);
			}
		}
}

} // namespace
