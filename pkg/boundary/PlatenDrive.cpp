// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "PlatenDrive.hpp"

#include "base/RequireFunctors.hpp"

#include <core/Scene.hpp>
#include "kernels/base/Check.hpp"
#include "kernels/base/WeightedMedian.hpp"
#include "kernels/boundary/OverlappingRamps.hpp"
#include "kernels/boundary/PlatenServo.hpp"

#include <stdexcept>

namespace yade {

YADE_PLUGIN((PlatenDrive));

namespace {

// Velocity of the approach over sqrt(stress/density). In a specimen h high of grains of size d it is the inertial number times h/d, so grains that are
// pushed at it stay well below the quasi-static limit of 1e-3.
constexpr Real approachNumber = 1e-3;
// Angle (rad) between two steps that counts as turned: far above the rounding of an orientation that is normalized every step.
constexpr Real turnedTolerance = 1e-9;

[[noreturn]] void stop(const std::string& what) { throw std::runtime_error(what); }

} // namespace

State& PlatenDrive::requirePlaten() const
{
	if (platen < 0) hexmembrane::reject("PlatenDrive.platen", int(platen), "no body given", "give the id of a Platen body");
	if (!scene->bodies->exists(platen))
		stop("PlatenDrive.platen = " + std::to_string(platen) +
		     ": there is no such body (erased?); fix: give the id of a Platen body, or remove the engine");
	const shared_ptr<Body>& body = Body::byId(platen, scene);
	const auto* shape = dynamic_cast<const Platen*>(body->shape.get());
	if (!shape) hexmembrane::reject("PlatenDrive.platen", int(platen), "the body's shape is no Platen", "give the id of a Platen body");
	if (!body->isStandalone()) hexmembrane::reject("PlatenDrive.platen", int(platen), "the body belongs to a clump", "take it out of the clump");
	shape->requireComplete();
	return *body->state;
}

void PlatenDrive::requireSettings() const
{
	for (int i = 0; i < 3; i++) hexmembrane::requireFinite("PlatenDrive.direction[" + std::to_string(i) + "]", direction[i], "(no unit)");
	if (direction.norm() < 1e-6)
		hexmembrane::reject("PlatenDrive.direction", direction.norm(), "its length is zero", "give the direction into the specimen");
	hexmembrane::requireNonNegative("PlatenDrive.rampTime", rampTime, "s");
	if (!math::isnan(area)) hexmembrane::requirePositive("PlatenDrive.area", area, "m2");
	if (mode == "velocity") {
		hexmembrane::requireFinite("PlatenDrive.velocity", velocity, "m/s");
		return;
	}
	if (mode != "stress") hexmembrane::reject("PlatenDrive.mode", "'" + mode + "'", "unknown mode", "give 'velocity' or 'stress'");
	hexmembrane::requireFinite("PlatenDrive.stress", stress, "Pa");
	if (stress <= 0)
		hexmembrane::reject("PlatenDrive.stress", stress, "a loose packing holds no tension",
		                    "give a stress > 0 Pa, or unload with mode 'velocity' and a negative velocity");
	hexmembrane::requireIn(hexmembrane::shared::servo_damping, "PlatenDrive.damping", damping, "(no unit)");
	hexmembrane::requireIn(hexmembrane::shared::servo_tolerance, "PlatenDrive.tolerance", tolerance, "(no unit)");
	if (!math::isnan(mass)) hexmembrane::requirePositive("PlatenDrive.mass", mass, "kg");
	if (!math::isnan(contactStiffness)) hexmembrane::requirePositive("PlatenDrive.contactStiffness", contactStiffness, "N/m");
	if (!math::isnan(maxVelocity)) hexmembrane::requirePositive("PlatenDrive.maxVelocity", maxVelocity, "m/s");
	if (!math::isnan(timeLimit)) hexmembrane::requirePositive("PlatenDrive.timeLimit", timeLimit, "s");
}

Real PlatenDrive::target(const Platen& shape) const
{
	if (mode == "velocity") return velocity;
	return stress * (math::isnan(area) ? M_PI * shape.radius * shape.radius : area);
}

void PlatenDrive::record(const State& state, Real newForce, const Vector3r& unit)
{
	// A gap in the steps (the engine was dead, or O.resetTime) is nobody's work.
	if (scene->iter == lastIter + 1) {
		const Real turned = state.ori.angularDistance(lastOrientation);
		if (turned > turnedTolerance)
			stop("PlatenDrive.platen = " + std::to_string(platen) + ": the platen was turned by " + hexmembrane::formatNumber(turned) +
			     " rad before iteration " + std::to_string(scene->iter) +
			     ", and the work of that would be booked nowhere; fix: tilt it before the first step, or turn it without a PlatenDrive");
		const Real way = (state.pos - lastPosition).dot(unit);
		const Real done = 0.5 * (force + newForce) * way;
		displacement += way;
		work += done;
		if (scene->trackEnergy) scene->energy->add(-done, "platenWork", energyIndex, /*reset every step*/ false);
	}
	force = newForce;
	lastIter = scene->iter;
	lastPosition = state.pos;
	lastOrientation = state.ori;
}

Real PlatenDrive::approachVelocity() const
{
	if (!math::isnan(maxVelocity)) return maxVelocity;
	// that of the grains: a membrane, whose density is often scaled, has less volume than what it encloses
	vector<std::pair<Real, Real>> densities;
	for (const auto& body : *scene->bodies) {
		const auto* sphere = body ? dynamic_cast<const Sphere*>(body->shape.get()) : nullptr;
		if (!sphere || !body->isDynamic()) continue;
		const Real volume = 4. / 3 * M_PI * math::pow(sphere->radius, 3);
		densities.emplace_back(body->state->mass / volume, volume);
	}
	const Real density = hexmembrane::weightedMedian(std::move(densities));
	if (!(density > 0))
		hexmembrane::reject("PlatenDrive.maxVelocity", maxVelocity, "no movable sphere with a mass to take it from", "give a velocity > 0 in m/s");
	return approachNumber * math::sqrt(stress / density);
}

void PlatenDrive::beginPhase(Real newTarget, const State& state, const Vector3r& unit)
{
	phaseApproach = mode == "stress" ? approachVelocity() : NaN;
	phaseMode = mode;
	phaseDirection = direction;
	phaseTarget = newTarget;
	phaseDuration = rampTime;
	phaseTime = 0;
	phaseVelocity = state.vel.dot(unit);
	ramps.clear();
	hexmembrane::addRamp(ramps, newTarget - (mode == "stress" ? force : phaseVelocity), rampTime);
	changeTime = 0;
	phaseSettled = false;
}

void PlatenDrive::changeTarget(Real newTarget)
{
	if (mode == "stress") phaseApproach = approachVelocity();
	hexmembrane::addRamp(ramps, newTarget - phaseTarget, rampTime);
	phaseTarget = newTarget;
	changeTime = 0;
	phaseSettled = false;
}

Real PlatenDrive::servoStep(Real velocityNow, Real touchingMass)
{
	const Real dt = scene->dt;
	const Real wanted = phaseTarget - hexmembrane::stillToCome(ramps, 0);
	if (stiffness > 0) {
		const hexmembrane::PlatenServo servo = hexmembrane::makePlatenServo(stiffness, touchingMass, dt, phaseTarget, damping, mass, phaseApproach);
		return hexmembrane::servoVelocity(servo, velocityNow, dt, wanted, force);
	}
	// Nothing to hold on to: a given mass accelerates as it does in nature, up to the velocity of the approach.
	if (math::isnan(mass)) return phaseApproach;
	return hexmembrane::servoVelocity({mass, 0, phaseApproach, phaseApproach}, velocityNow, dt, wanted, force);
}

void PlatenDrive::requireReached(Real newTarget)
{
	settled = ramps.empty() && math::abs(force - newTarget) <= tolerance * newTarget;
	phaseSettled |= settled;
	if (phaseSettled || !(changeTime > timeLimit)) return;
	stop("PlatenDrive.timeLimit = " + hexmembrane::formatNumber(timeLimit) + ": platen " + std::to_string(platen) + " carries " +
	     hexmembrane::formatNumber(force) + " N of " + hexmembrane::formatNumber(newTarget) + " N after this time, at iteration " +
	     std::to_string(scene->iter) + "; fix: is there a specimen in its way? give a longer timeLimit, or a larger maxVelocity");
}

void PlatenDrive::requireReferenceScene() const { requireFunctors(*scene, "Platen", "PlatenDrive"); }

void PlatenDrive::prepare()
{
	requirePlaten();
	requireSettings();
}

void PlatenDrive::action() { stepOverBodies(*this); }

void PlatenDrive::step(StepView& view)
{
	State& state = requirePlaten();
	const Vector3r unit = direction.normalized();
	const Real newTarget = target(static_cast<const Platen&>(*Body::byId(platen, scene)->shape));
	const ContactSums met = view.contacts(platen);

	record(state, 0 - met.force.dot(unit), unit); // 0 - x: no force is 0, not -0
	const bool changed = newTarget != phaseTarget;
	if (mode != phaseMode || direction != phaseDirection || (changed && ramps.empty()))
		beginPhase(newTarget, state, unit);
	else if (changed)
		changeTarget(newTarget);

	// The velocity set here holds half a step later, midway to the next position.
	const Real ahead = 0.5 * scene->dt;
	if (mode == "stress") {
		requireReached(newTarget);
		stiffness = math::isnan(contactStiffness) ? view.stiffness(platen, unit) : (met.count > 0 ? contactStiffness : 0);
		const Real next = servoStep(state.vel.dot(unit), view.touchingMass(platen)), weight = hexmembrane::rampWeight(phaseTime + ahead, phaseDuration);
		state.vel = (weight * next + (1 - weight) * phaseVelocity) * unit;
	} else {
		settled = false;
		state.vel = (newTarget - hexmembrane::stillToCome(ramps, ahead)) * unit;
	}
	state.angVel = Vector3r::Zero();
	state.blockedDOFs = State::DOF_ALL;
	state.isDamped = false; // else NewtonIntegrator books a dissipation that does not take place
	phaseTime += scene->dt;
	changeTime += scene->dt;
	hexmembrane::advanceRamps(ramps, scene->dt);
}

} // namespace yade
