// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "CompactLoop.hpp"

#include "base/NamedFields.hpp"
#include "base/GatherBodies.hpp"

#include <core/Scene.hpp>
#include <lib/pyutil/gil.hpp>

namespace yade {

Real CompactLoop::usedSkin(const hexmembrane::SphereAssembly& spheres) const
{
	if (!math::isnan(skin)) return skin;
	Real smallest = std::numeric_limits<Real>::infinity();
	for (const auto& place : spheres.places) smallest = std::min(smallest, place.radius);
	return HEXMEMBRANE_LIST_SKIN_DEFAULT * smallest;
}

// Made beside what is there, and put in its place when nothing can be refused any more.
void CompactLoop::collect(const Sheet& sheet)
{
	const bool loaded = !state && !contactFields.empty();
	auto next = std::make_unique<CompactState>(*scene, sheet);
	named("CompactLoop", {}, [&] { next->spheres.setSkin(usedSkin(next->spheres)); });
	const int lost = next->spheres.nowhere();
	if (lost >= 0) refuseBody(lost, "has a position that is not finite", "find out what sent it away, or load the last checkpoint");
	const vector<KeptContact> kept = loaded ? savedContacts() : contactsSoFar();
	if (!loaded || !continueLists(*next)) named("CompactLoop", {}, [&] { next->spheres.makeLists(); });
	next->indexSpheres();
	for (const KeptContact& contact : kept) next->requirePlace(contact);
	for (const KeptContact& contact : kept) next->put(contact);
	{
		const gilLock lock; // the last to hold a shape that was made in Python, of a body that is gone, may be the state before
		state = std::move(next);
	}
	stepShapes.clear();
	contactFields.clear(); // what was loaded is of use once
}

void CompactLoop::takeScene()
{
	Sheet sheet;
	for (Stepped* one : stepped)
		if (one->sheet().membrane) sheet = one->sheet();
	const vector<KeptContact> found = exported ? vector<KeptContact>() : interactionContacts();
	if (!state || !state->refresh(*scene, sheet, threads)) collect(sheet);
	state->refreshMaterials();
	named("CompactLoop", {}, [&] { state->spheres.setSkin(usedSkin(state->spheres)); });
	if (!found.empty()) {
		if (!state->spheres.listsHold()) state->spheres.makeLists();
		state->indexSpheres();
		for (const KeptContact& contact : found) state->requirePlace(contact);
		for (const KeptContact& contact : found) state->put(contact);
	}
	takeOutsideForces();
	if (scene->interactions->size() > 0) scene->interactions->clear();
	exported = false;
	state->fillRows();
}

void CompactLoop::takeOutsideForces()
{
	if (scene->forces.lastReset < scene->iter)
		throw std::runtime_error("CompactLoop: the forces of the step before are still there; fix: put ForceResetter() first in O.engines");
	scene->forces.sync();
	hexmembrane::SphereAssembly& spheres = state->spheres;
	spheres.outside.clear();
	outsideOn.clear();
	for (Body::id_t id : state->boundaryIds) outsideOn.push_back(scene->forces.getForce(id));
	const int count = spheres.spheres();
	const auto load = [&](int i) { return hexmembrane::Load{scene->forces.getForce(spheres.id[i]), scene->forces.getTorque(spheres.id[i])}; };
	bool any = false;
#pragma omp parallel for schedule(static) num_threads(threads) reduction(|| : any)
	for (int i = 0; i < count; ++i) {
		const hexmembrane::Load found = load(i);
		any = any || found.force != Vector3r::Zero() || found.torque != Vector3r::Zero();
	}
	if (!any) return;
	for (int i = 0; i < count; ++i) spheres.outside.push_back(load(i));
}

void CompactLoop::giveScene()
{
	hexmembrane::SphereAssembly& spheres = state->spheres;
	const Sheet& sheet = state->sheet;
	const int count = spheres.spheres(), grains = spheres.grains(), n = sheet.stencil.perRing;
	const auto& bodies = *scene->bodies;
	if (sheet.ids) state->motion.giveVelocities(state->velocity(), spheres.motions.data() + grains);
	const bool computed = static_cast<int>(spheres.loads.size()) == count;
	// each thread adds to forces of its own, and each body is one thread's: the sums are the same for any number of them
#pragma omp parallel for schedule(static) num_threads(threads)
	for (int i = 0; i < count; ++i) {
		prefetchAhead(bodies, spheres.id, i);
		State& body = *livingBody(bodies, spheres.id[i])->state;
		body.se3.position = spheres.places[i].centre;
		body.vel = spheres.motions[i].velocity;
		body.angVel = spheres.motions[i].spin;
		if (!computed) continue;
		Vector3r force = spheres.loads[i].force, torque = spheres.loads[i].torque;
		if (i < grains) {
			const Real angle = spheres.turned[i].norm();
			if (angle > 0) {
				body.se3.orientation = Quaternionr(AngleAxisr(angle, spheres.turned[i] / angle)) * body.se3.orientation;
				body.se3.orientation.normalize();
				spheres.turned[i] = Vector3r::Zero();
			}
		} else {
			const int k = (i - grains) / n, m = (i - grains) % n;
			force = state->motion.force().get(k, m);
			for (const hexmembrane::PaddedRings* rows : torques) torque += rows->get(k, m);
		}
		if (!spheres.outside.empty()) { // it is in O.forces already
			force -= spheres.outside[i].force;
			torque -= spheres.outside[i].torque;
		}
		scene->forces.addForce(spheres.id[i], force);
		scene->forces.addTorque(spheres.id[i], torque);
	}
	for (size_t b = 0; b < spheres.onBoundary.size(); ++b) {
		scene->forces.addForce(state->boundaryIds[b], spheres.onBoundary[b].load.force);
		scene->forces.addTorque(state->boundaryIds[b], spheres.onBoundary[b].load.torque);
	}
	scene->forces.sync();
	listsMade = spheres.listsMade();
}

} // namespace yade
