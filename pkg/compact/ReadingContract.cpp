// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "ReadingContract.hpp"

#include "BoundaryRegistry.hpp"
#include "Stepped.hpp"

#include <core/InteractionLoop.hpp>
#include <pkg/common/Collider.hpp>
#include <pkg/common/Sphere.hpp>
#include <pkg/dem/NewtonIntegrator.hpp>

namespace yade {

namespace {

vector<ReadingRow> makeContract()
{
	vector<ReadingRow> rows{
	        {"Scene", "dt", "read", "any value > 0"},
	        {"Scene", "trackEnergy", "read", "energies are entered once an iteration"},
	        {"Scene", "stopAtIter, stopAtTime", "read", "an iteration ends there"},
	        {"Scene", "isPeriodic, cell", "refused", "no periodic cells"},
	        {"Scene", "forces, torques, permanent forces", "read",
	         "what stands there when the loop begins is held for the iteration; so gravity acts by GravityEngine"},
	        {"Scene", "interactions", "read", "real contacts of LinearPhys are taken over with their history and cleared; other contacts are refused"},
	        {"Scene", "engines", "refused",
	         "a collider, InteractionLoop, NewtonIntegrator or second CompactLoop beside the loop; an engine that is in both lists"},
	        {"Body", "number of bodies", "watched", "bodies may come and go; a membrane's must stay"},
	        {"Body", "material", "watched", "must be a LinearMat"},
	        {"Body", "shape", "watched", "Sphere, or a boundary that is registered (" + BoundaryRegistry::names() + ")"},
	        {"Body", "mask", "watched", "all spheres must have one bit in common; a boundary meets those that it has a bit in common with"},
	        {"Body", "clumpId", "refused", "no clumps"},
	        {"Body", "bounded", "refused", "a body that no collider sees"},
	        {"Body", "aspherical", "refused", "no aspherical bodies"},
	        {"State", "pos, vel, angVel", "read",
	         "of spheres and boundaries; the works of engines count the way that a step of the present velocities makes"},
	        {"State", "ori", "read", "of boundaries; that of grains is advanced by their rotation, that of membrane particles is not kept"},
	        {"State", "mass", "watched", "positive for what moves; one for all particles of a membrane"},
	        {"State", "inertia", "watched", "positive and a sphere's for what turns"},
	        {"State", "blockedDOFs, dynamic", "watched", "grains all or none, membrane particles any, boundaries all"},
	        {"State", "isDamped", "watched", "True for what moves freely; of no effect on what is blocked"},
	        {"Sphere", "radius", "watched", "one for all particles of a membrane"},
	        {"LinearMat", "kn, ks, emod, kratio, friction, rollingFriction", "read", "contacts follow at once; a spring that is taken away lets go"},
	        {"LinearMat", "setPair, removePair", "read", "contacts of the pair follow at once"},
	        {"LinearMat", "cbTensile, cbShear, density", "read", "by what makes bonds and bodies, not by a step"},
	};
	for (const BoundaryRegistry::Entry* boundary : BoundaryRegistry::byName())
		rows.push_back({boundary->name(), boundary->attributes, "read", "in every step"});
	return rows;
}

} // namespace

const vector<ReadingRow>& readingContract()
{
	static const vector<ReadingRow> rows = makeContract();
	return rows;
}

void refuseBody(Body::id_t id, const string& wrong, const string& fix)
{
	throw std::runtime_error("CompactLoop: body " + std::to_string(id) + " " + wrong + "; fix: " + fix);
}

namespace {

Real radiusOf(const Body& body)
{
	const auto* sphere = dynamic_cast<const Sphere*>(body.shape.get());
	return sphere ? sphere->radius : 0;
}

} // namespace

BodyMark::BodyMark(const Body& body)
    : shape(body.shape), material(body.material), radius(radiusOf(body)), mass(body.state->mass), inertia(body.state->inertia),
      blocked(body.state->blockedDOFs), flags(body.flags), mask(body.groupMask), clump(body.clumpId), damped(body.state->isDamped)
{
}

bool BodyMark::holds(const Body& body) const
{
	const State& state = *body.state;
	// the radius is that of the shape that was collected: its class is known to be a Sphere where there is one
	return body.shape == shape && body.material == material && (radius == 0 || static_cast<const Sphere&>(*shape).radius == radius) && state.mass == mass &&
	       state.inertia == inertia && state.blockedDOFs == blocked && body.flags == flags && body.groupMask == mask && body.clumpId == clump &&
	       state.isDamped == damped;
}

void requireCompactScene(const Scene& scene, const Engine& self, const vector<shared_ptr<Engine>>& stepped)
{
	if (scene.isPeriodic) throw std::runtime_error("CompactLoop: the scene is periodic; fix: use the reference tier");
	for (const auto& engine : scene.engines) {
		if (engine->dead || engine.get() == &self) continue;
		if (dynamic_cast<const ContactKeeper*>(engine.get()) || dynamic_cast<const NewtonIntegrator*>(engine.get()) ||
		    dynamic_cast<const Collider*>(engine.get()) || dynamic_cast<const InteractionLoop*>(engine.get()))
			throw std::runtime_error("CompactLoop: there is a " + engine->getClassName() +
			                         " beside it in O.engines, both would act; fix: remove it");
		if (dynamic_cast<const Stepped*>(engine.get()))
			throw std::runtime_error(
			        "CompactLoop: " + engine->getClassName() +
			        (std::find(stepped.begin(), stepped.end(), engine) == stepped.end()
			                 ? " stands in O.engines, where it would act once in many steps; fix: put it into CompactLoop.engines"
			                 : " stands in O.engines and in CompactLoop.engines, it would act twice; fix: leave it in CompactLoop.engines alone"));
	}
}

} // namespace yade
