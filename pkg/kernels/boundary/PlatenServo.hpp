// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <algorithm>
#include <cmath>

namespace hexmembrane {

/// Weight of a smooth change that lasts `duration` (s) after `elapsed` (s): (1 - cos(pi elapsed/duration))/2, 0 before and 1 after it, its slope 0 at both
/// ends. A change of duration 0 is done at once.
inline double rampWeight(double elapsed, double duration)
{
	if (elapsed >= duration) return 1;
	if (elapsed <= 0) return 0;
	return 0.5 * (1 - std::cos(3.14159265358979323846 * elapsed / duration));
}

/// What the platen of a stress servo is: a body of `mass` (kg) on a dashpot of `viscosity` (N s/m), never faster into the specimen than `maxVelocity` and out of
/// it than `maxRetreat` (m/s).
struct PlatenServo {
	double mass;
	double viscosity;
	double maxVelocity;
	double maxRetreat;
};

/// Largest share of the target force by which the contact force may change in one step.
constexpr double servoForcePerStep = 0.1;

/// Largest share of the target force that the inertia of what the platen meets may answer with.
constexpr double servoImpact = 0.05;

/// Mass of a servo platen in units of K dt^2.
constexpr double servoMassFactor = 4;

/// The servo for a platen whose contacts have the summed stiffness K > 0 (N/m) and the mass M >= 0 (kg) of touching spheres, with step dt (s), target force (N),
/// damping ratio (1: critical) and two settings that may be NaN: a mass (kg) to take instead, and a velocity limit (m/s).
///   mass         m = 4 K dt^2            so that the platen's own frequency is sqrt(K/m) = 1/(2 dt). Against contacts whose far ends move too it is at most
///                                        sqrt(2K/m) (Gershgorin), a factor 2.8 below the leapfrog limit 2/dt, whatever K is.
///   viscosity    c = 2 ratio sqrt(K m)   critical for the contacts alone; the specimen behind them is softer, and more than critically damped.
///   maxVelocity  servoImpact * target/sqrt(K M), so that an impact cannot overshoot: a body that is met at v answers with its impedance, rho c A = sqrt(K M)
///                for layers of grains. It is a velocity of the specimen and the same at any step. At most servoForcePerStep * target/(K dt).
///   maxRetreat   the same
inline PlatenServo makePlatenServo(double stiffness, double touchingMass, double dt, double target, double dampingRatio, double givenMass, double givenLimit)
{
	const double mass = std::isnan(givenMass) ? servoMassFactor * stiffness * dt * dt : givenMass;
	const double limit = target / std::max(std::sqrt(stiffness * touchingMass) / servoImpact, stiffness * dt / servoForcePerStep);
	const double fastest = std::isnan(givenLimit) ? limit : std::min(limit, givenLimit);
	return {mass, 2 * dampingRatio * std::sqrt(stiffness * mass), fastest, fastest};
}

/// Velocity of the servo platen after a step (m/s, positive into the specimen): m dv/dt = wanted - measured - c (v - flow), the last term implicit (stable for
/// any c). `flow` (m/s) is the velocity that the dashpot lets pass; 0: none, and a platen that has to keep moving at v carries c v less than wanted.
inline double servoVelocity(const PlatenServo& servo, double velocity, double dt, double wanted, double measured, double flow = 0)
{
	const double drag = dt * servo.viscosity;
	const double next = (servo.mass * velocity + dt * (wanted - measured) + drag * flow) / (servo.mass + drag);
	return std::clamp(next, -servo.maxRetreat, servo.maxVelocity);
}

/// Steps over which a flow follows a velocity.
constexpr double servoFlowSteps = 100;

/// The flow of a servo after a step (m/s): the mean velocity of the last servoFlowSteps, so that a steady motion costs no force. Against a specimen of any
/// stiffness k the servo stays stable: m T s^3 + (m + c T) s^2 + k T s + k, T = servoFlowSteps dt, meets Routh's condition c T^2 > 0. Its slow oscillation
/// has the damping ratio sqrt(k T/c)/2.
inline double servoFlow(double flow, double velocity) { return flow + (velocity - flow) / servoFlowSteps; }

} // namespace hexmembrane
