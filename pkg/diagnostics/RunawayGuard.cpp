// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "RunawayGuard.hpp"

#include <core/Scene.hpp>
#include "kernels/base/Check.hpp"
#include <pkg/common/Sphere.hpp>

#include <limits>
#include <stdexcept>
#include <vector>

namespace yade {

YADE_PLUGIN((RunawayGuard));

namespace {

std::string text(const Vector3r& v)
{
	return "(" + hexmembrane::formatNumber(v[0]) + ", " + hexmembrane::formatNumber(v[1]) + ", " + hexmembrane::formatNumber(v[2]) + ")";
}

// The classes of shapes have numbers, given at the first object of each; this asks no vtable for a cast of every body.
bool isSphere(const Shape& shape, int sphereIndex) { return shape.getClassIndex() == sphereIndex; }

// A body is three objects at three places of the heap; the loop waits for memory, not for arithmetic. Asks for those of the bodies that come next.
void fetchAhead(const std::vector<shared_ptr<Body>>& bodies, size_t i)
{
	constexpr size_t near = 6, far = 14;
	if (i + far < bodies.size() && bodies[i + far]) __builtin_prefetch(&bodies[i + far]->state);
	if (i + near >= bodies.size() || !bodies[i + near]) return;
	const Body& next = *bodies[i + near];
	__builtin_prefetch(&next.state->se3);
	__builtin_prefetch(&next.state->vel);
	__builtin_prefetch(&next.state->angVel);
	__builtin_prefetch(next.shape.get());
}

} // namespace

bool RunawayGuard::isActivated()
{
	if (iterPeriod < 1) hexmembrane::reject("RunawayGuard.iterPeriod", iterPeriod, "must be at least 1", "give a number of iterations");
	return scene->iter % iterPeriod == 0;
}

std::string RunawayGuard::complaint(const Body& body) const
{
	const State& state = *body.state;
	std::string what;
	if (!state.pos.allFinite() || !state.vel.allFinite() || !state.angVel.allFinite())
		what = "is not finite";
	else if (state.vel.norm() > maxVelocity)
		what = "moves at " + hexmembrane::formatNumber(state.vel.norm()) +
		       " m/s (RunawayGuard.maxVelocity = " + hexmembrane::formatNumber(maxVelocity) + ")";
	else {
		const Real radius = static_cast<const Sphere&>(*body.shape).radius;
		what = "moves " + hexmembrane::formatNumber(state.vel.norm() * scene->dt / radius) +
		       " of its radius in one step (RunawayGuard.maxStep = " + hexmembrane::formatNumber(maxStep) + ")";
	}
	return "RunawayGuard: body " + std::to_string(body.getId()) + " at iteration " + std::to_string(scene->iter) + " " + what + "; position " +
	       text(state.pos) + " m, velocity " + text(state.vel) + " m/s, angular velocity " + text(state.angVel) + " rad/s; " +
	       (checkpoint.empty() ? std::string("no checkpoint is known") : "last good state: " + checkpoint) +
	       "; fix: smaller time step, or look for overlaps and forces that are too large there";
}

void RunawayGuard::action()
{
	if (!math::isnan(maxStep)) hexmembrane::requirePositive("RunawayGuard.maxStep", maxStep, "(of the radius)");
	if (!math::isnan(maxVelocity)) hexmembrane::requirePositive("RunawayGuard.maxVelocity", maxVelocity, "m/s");

	const auto& bodies = scene->bodies->body;
	const long count = static_cast<long>(bodies.size());
	const int sphereIndex = Sphere::getClassIndexStatic();
	const Real infinity = std::numeric_limits<Real>::infinity();
	// Squares, so that no root is drawn; a limit that is not set is infinity.
	const Real fastest = math::isnan(maxVelocity) ? infinity : maxVelocity * maxVelocity;
	const Real perStep = math::isnan(maxStep) ? infinity : maxStep / scene->dt;
	const Real perStep2 = perStep * perStep;
	long first = count;
#pragma omp parallel for schedule(static) reduction(min : first)
	for (long i = 0; i < count; i++) {
		fetchAhead(bodies, static_cast<size_t>(i));
		const shared_ptr<Body>& body = bodies[i];
		if (!body) continue;
		const State& state = *body->state;
		// A sum is finite only if all of its terms are.
		const Real all = state.se3.position.sum() + state.vel.sum() + state.angVel.sum();
		const Real speed = state.vel.squaredNorm();
		bool good = all - all == 0 && speed <= fastest;
		if (body->shape && isSphere(*body->shape, sphereIndex)) {
			const Real radius = static_cast<const Sphere&>(*body->shape).radius;
			good = good && speed <= perStep2 * radius * radius;
		}
		if (!good && i < first) first = i;
	}
	if (first < count) throw std::runtime_error(complaint(*bodies[first]));
}

} // namespace yade
