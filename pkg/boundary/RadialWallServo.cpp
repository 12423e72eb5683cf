// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "RadialWallServo.hpp"

#include "Platen.hpp"

#include "base/RequireFunctors.hpp"

#include <core/Scene.hpp>
#include "kernels/base/Check.hpp"
#include "kernels/boundary/PlatenServo.hpp"

namespace yade {

YADE_PLUGIN((RadialWallServo));

namespace {

//! Shape of a body that must be there and be a ShapeType.
template <typename ShapeType>
ShapeType* requireShape(const Scene& scene, Body::id_t id, const string& name, const string& type)
{
	if (id < 0) hexmembrane::reject(name, int(id), "no body given", "give the id of a " + type + " body");
	if (!scene.bodies->exists(id))
		throw std::runtime_error(name + " = " + std::to_string(id) + ": there is no such body (erased?); fix: give the id of a " + type + " body");
	auto* shape = dynamic_cast<ShapeType*>((*scene.bodies)[id]->shape.get());
	if (!shape) hexmembrane::reject(name, int(id), "the body's shape is no " + type, "give the id of a " + type + " body");
	return shape;
}

} // namespace

CylinderWall& RadialWallServo::requireWall() const
{
	CylinderWall& shape = *requireShape<CylinderWall>(*scene, wall, "RadialWallServo.wall", "CylinderWall");
	shape.requireComplete();
	return shape;
}

void RadialWallServo::requireSettings() const
{
	hexmembrane::requirePositive("RadialWallServo.stress", stress, "Pa");
	hexmembrane::requirePositive("RadialWallServo.maxVelocity", maxVelocity, "m/s");
	if (!math::isnan(maxRetreat)) hexmembrane::requirePositive("RadialWallServo.maxRetreat", maxRetreat, "m/s");
	hexmembrane::requireIn(hexmembrane::shared::servo_damping, "RadialWallServo.damping", damping, "1");
	hexmembrane::requireIn(hexmembrane::shared::servo_tolerance, "RadialWallServo.tolerance", tolerance, "1");
	if (!math::isnan(timeLimit)) hexmembrane::requirePositive("RadialWallServo.timeLimit", timeLimit, "s");
}

Real RadialWallServo::specimenHeight() const
{
	if (bottomPlaten < 0 && topPlaten < 0) {
		hexmembrane::requirePositive("RadialWallServo.height", height, "m (or give bottomPlaten and topPlaten)");
		return height;
	}
	const Platen* below = requireShape<Platen>(*scene, bottomPlaten, "RadialWallServo.bottomPlaten", "Platen");
	const Platen* above = requireShape<Platen>(*scene, topPlaten, "RadialWallServo.topPlaten", "Platen");
	const auto& bodies = *scene->bodies;
	const Real gap = (bodies[topPlaten]->state->pos[2] - 0.5 * above->height) - (bodies[bottomPlaten]->state->pos[2] + 0.5 * below->height);
	if (!(gap > 0))
		throw std::runtime_error("RadialWallServo: the platens' faces are " + hexmembrane::formatNumber(gap) + " m apart at iteration " +
		                         std::to_string(scene->iter) + "; fix: bottomPlaten below topPlaten, and a shorter drive");
	return gap;
}

void RadialWallServo::requireReached(Real target)
{
	settled = math::abs(radialStress - stress) <= tolerance * stress;
	if (target != phaseTarget) {
		phaseTarget = target;
		phaseTime = 0;
		phaseSettled = phaseReached = false;
	}
	phaseSettled |= settled;
	phaseReached |= radialStress >= stress && velocity <= 0;
	if (!phaseSettled && phaseTime > timeLimit)
		throw std::runtime_error("RadialWallServo.timeLimit = " + hexmembrane::formatNumber(timeLimit) + ": the wall carries " +
		                         hexmembrane::formatNumber(radialStress) + " Pa of " + hexmembrane::formatNumber(stress) +
		                         " Pa after this time, at iteration " + std::to_string(scene->iter) +
		                         "; fix: is there a specimen inside? give a longer timeLimit, or a larger maxVelocity");
	phaseTime += scene->dt;
}

void RadialWallServo::requireReferenceScene() const { requireFunctors(*scene, "CylinderWall", "RadialWallServo"); }

void RadialWallServo::prepare()
{
	requireWall();
	requireSettings();
}

void RadialWallServo::action() { stepOverBodies(*this); }

void RadialWallServo::step(StepView& view)
{
	CylinderWall& shape = requireWall();
	const ContactSums met = view.contacts(wall);
	if (!met.silent.empty())
		throw std::runtime_error("RadialWallServo.wall: contacts of " + met.silent +
		                         " do not tell their stiffness; fix: a contact law whose IPhys derives from NormPhys");
	const Real force = met.normalForce;
	stiffness = met.normalStiffness;
	const Real area = 2 * M_PI * shape.radius * specimenHeight();
	radialStress = force / area;
	// A gap in the steps (the engine was dead, or O.resetTime) is nobody's work.
	if (scene->iter == lastIter + 1) {
		const Real done = 0.5 * (lastForce + force) * (lastRadius - shape.radius);
		work += done;
		if (scene->trackEnergy) scene->energy->add(-done, "wallWork", energyIndex, /*reset every step*/ false);
	}
	lastForce = force;
	lastRadius = shape.radius;
	lastIter = scene->iter;
	requireReached(stress);

	const Real dt = scene->dt, target = stress * area;
	if (stiffness > 0) {
		auto servo = hexmembrane::makePlatenServo(stiffness, view.touchingMass(wall), dt, target, damping, NaN, maxVelocity);
		if (!math::isnan(maxRetreat)) servo.maxRetreat = maxRetreat;
		velocity = hexmembrane::servoVelocity(servo, velocity, dt, target, force, flow);
		flow = phaseReached ? hexmembrane::servoFlow(flow, velocity) : 0; // what the wall meets on its way, it meets with its whole dashpot
		atLimit = phaseSettled && (velocity <= -servo.maxRetreat || velocity >= servo.maxVelocity);
	} else {
		velocity = maxVelocity;
		flow = 0;
		atLimit = false;
	}
	// the wall moves when the integrator moves the spheres: positions of one instant
	shape.radius -= velocity * dt;
}

} // namespace yade
