// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "CompactLoop.hpp"

#include "contact/LinearContact.hpp"
#include "kernels/base/Check.hpp"
#include "membrane/GatherBodies.hpp"

#include <core/Scene.hpp>
#include <pkg/common/Sphere.hpp>

namespace yade {

using hexmembrane::FlatBoundary;
using hexmembrane::SphereAssembly;

namespace {

[[noreturn]] void refuse(Body::id_t id, const string& wrong, const string& fix)
{
	throw std::runtime_error("CompactLoop: body " + std::to_string(id) + " " + wrong + "; fix: " + fix);
}

} // namespace

int CompactLoop::materialIndex(const Body& body)
{
	const auto* material = dynamic_cast<const LinearMat*>(body.material.get());
	if (!material) refuse(body.getId(), "has a material that is no LinearMat", "give all bodies a LinearMat, or use the reference tier");
	const auto found = std::find(materials.begin(), materials.end(), material);
	if (found != materials.end()) return static_cast<int>(found - materials.begin());
	material->requireComplete();
	materials.push_back(material);
	return static_cast<int>(materials.size()) - 1;
}

SphereAssembly::Sphere CompactLoop::sphereOf(const Body& body, bool ofMembrane)
{
	const State& state = *body.state;
	const bool fixed = state.blockedDOFs == State::DOF_ALL;
	if (!ofMembrane && !fixed) {
		if (state.blockedDOFs != 0)
			refuse(body.getId(), "has some of its degrees of freedom blocked", "block all or none of a grain's, or use the reference tier");
		if (!state.isDamped) refuse(body.getId(), "has isDamped = False", "leave it True, or use the reference tier");
		const string name = "O.bodies[" + std::to_string(body.getId()) + "].state.";
		hexmembrane::requirePositive(name + "mass", state.mass, "kg");
		hexmembrane::requirePositive(name + "inertia", state.inertia.minCoeff(), "kg m2");
		if (state.inertia.maxCoeff() > state.inertia.minCoeff() * (1 + 1e-9))
			refuse(body.getId(), "is aspherical (three different moments of inertia)", "give a sphere's, or use the reference tier");
	}
	const Real radius = static_cast<const Sphere&>(*body.shape).radius;
	const bool spins = fixed || (state.blockedDOFs & State::DOF_RXRYRZ) != State::DOF_RXRYRZ;
	const Real inertia = spins ? state.inertia[0] : std::numeric_limits<Real>::infinity();
	return {static_cast<int>(body.getId()), {state.pos, radius}, {state.vel, state.angVel}, state.mass, inertia, materialIndex(body), fixed};
}

void CompactLoop::collectBoundary(const Body& body, FlatBoundary::Kind kind)
{
	const FlatBoundary boundary{kind, {Vector3r::Zero(), Vector3r::UnitZ(), 0, 0}, Vector3r::Zero(), Vector3r::Zero(), materialIndex(body)};
	flat.boundaries.push_back(boundary);
	boundaryIds.push_back(body.getId());
}

void CompactLoop::checkMasks() const
{
	int common = -1;
	for (const auto& b : *scene->bodies)
		if (b) common &= b->groupMask;
	if (common == 0)
		throw std::runtime_error(
		        "CompactLoop: the masks of the bodies have no bit in common, so some pairs would not meet; fix: give all bodies one common "
		        "bit (the membrane a second one), or use the reference tier");
}

void CompactLoop::collect()
{
	if (scene->isPeriodic) throw std::runtime_error("CompactLoop: the scene is periodic; fix: use the reference tier");
	if (collected) storeContacts(); // bodies have come or gone: what contacts remember goes on by ids
	checkMasks();
	const HexMembrane* membrane = bonds ? bonds->membrane.get() : nullptr;
	const std::set<Body::id_t> ofMembrane = membrane ? std::set<Body::id_t>(membrane->ids.begin(), membrane->ids.end()) : std::set<Body::id_t>();
	vector<SphereAssembly::Sphere> spheres;
	materials.clear();
	boundaryIds.clear();
	flat.boundaries.clear();
	for (const auto& b : *scene->bodies) {
		if (!b || ofMembrane.count(b->getId())) continue;
		if (!b->isStandalone()) refuse(b->getId(), "is a clump or of one", "use single spheres, or the reference tier");
		if (dynamic_cast<const Sphere*>(b->shape.get()))
			spheres.push_back(sphereOf(*b, false));
		else if (dynamic_cast<const Platen*>(b->shape.get()))
			collectBoundary(*b, FlatBoundary::Kind::platen);
		else if (dynamic_cast<const CylinderWall*>(b->shape.get()))
			collectBoundary(*b, FlatBoundary::Kind::cylinder);
		else
			refuse(b->getId(), "is a " + (b->shape ? b->shape->getClassName() : string("body without a shape")),
			       "only Sphere, Platen and CylinderWall are known here; use the reference tier");
	}
	const int grains = static_cast<int>(spheres.size());
	if (membrane)
		for (Body::id_t id : membrane->ids) {
			const Body* b = livingBody(*scene->bodies, id);
			if (!b) refuse(id, "of the membrane is gone", "do not erase membrane bodies");
			spheres.push_back(sphereOf(*b, true));
		}
	if (spheres.empty()) throw std::runtime_error("CompactLoop: there are no spheres in the scene; fix: add some first");

	const bool continues = !collected && inSavedOrder(spheres, grains);
	flat.setSpheres(spheres, grains);
	flat.setSkin(usedSkin());
	if (membraneContacts && membrane) {
		const auto tube = membrane->stencil();
		std::set<std::array<int, 2>> neighbours;
		for (auto pair : hexmembrane::bondList(tube)) neighbours.insert({std::min(pair[0], pair[1]), std::max(pair[0], pair[1])});
		flat.setMembraneContacts([neighbours](int a, int b) { return neighbours.count({std::min(a, b), std::max(a, b)}) > 0; });
	} else
		flat.setMembraneContacts({});
	if (membrane) {
		rows = hexmembrane::MembraneMotion(membrane->stencil(), membrane->oRingRows);
		rows.mass = spheres.back().mass;
		for (int i = grains; i < static_cast<int>(spheres.size()); ++i)
			if (!(spheres[i].mass == rows.mass)) refuse(spheres[i].id, "of the membrane has another mass than the rest", "give all the same");
	}
	collectedBodies = scene->bodies->size();
	collectedMembrane = membrane;
	refreshMaterials();
	for (size_t b = 0; b < boundaryIds.size(); ++b) refreshBoundary(b);
	if (continues)
		continueLists();
	else
		flat.makeLists();
	restoreContacts();
	collected = true;
}

// A state that was loaded goes on in the order of the arrays that it was saved from: sums over contacts keep their bits.
bool CompactLoop::inSavedOrder(vector<SphereAssembly::Sphere>& spheres, int grains) const
{
	if (static_cast<int>(order.size()) != grains || listedCentres.size() != spheres.size() || listedBoundaryRadii.size() != boundaryIds.size())
		return false;
	std::map<int, int> at;
	for (int i = 0; i < grains; ++i) at[spheres[i].id] = i;
	vector<SphereAssembly::Sphere> sorted(spheres);
	for (int i = 0; i < grains; ++i) {
		const auto found = at.find(order[i]);
		if (found == at.end()) return false;
		sorted[i] = spheres[found->second];
	}
	spheres.swap(sorted);
	return true;
}

Real CompactLoop::usedSkin() const
{
	if (!math::isnan(skin)) return skin;
	Real smallest = std::numeric_limits<Real>::infinity();
	for (const auto& place : flat.places) smallest = std::min(smallest, place.radius);
	return 0.3 * smallest;
}

void CompactLoop::refreshMaterials()
{
	vector<hexmembrane::ContactMaterial> table;
	for (const LinearMat* material : materials) table.push_back(material->contactMaterial());
	flat.setMaterials(table);
}

void CompactLoop::refreshBoundary(size_t b)
{
	const Body& body = *(*scene->bodies)[boundaryIds[b]];
	FlatBoundary& boundary = flat.boundaries[b];
	boundary.velocity = body.state->vel;
	boundary.spin = body.state->angVel;
	if (boundary.kind == FlatBoundary::Kind::platen) {
		const auto& shape = static_cast<const Platen&>(*body.shape);
		shape.requireComplete();
		boundary.solid = shape.solid(body.state->se3);
	} else {
		const auto& shape = static_cast<const CylinderWall&>(*body.shape);
		shape.requireComplete();
		boundary.solid = {body.state->pos, Vector3r::UnitZ(), shape.radius, 0.5 * shape.height};
	}
}

bool CompactLoop::refreshBodies()
{
	const int count = flat.spheres();
	const auto& bodies = *scene->bodies;
	int missing = 0;
#pragma omp parallel for schedule(static) num_threads(threads) reduction(+ : missing)
	for (int i = 0; i < count; ++i) {
		prefetchAhead(bodies, flat.id, i);
		const Body* b = livingBody(bodies, flat.id[i]);
		if (!b) {
			++missing;
			continue;
		}
		flat.places[i].centre = b->state->se3.position;
		flat.motions[i] = {b->state->vel, b->state->angVel};
	}
	if (missing > 0) return false;
	for (Body::id_t id : boundaryIds)
		if (!livingBody(bodies, id)) return false;
	for (size_t b = 0; b < boundaryIds.size(); ++b) refreshBoundary(b);
	return true;
}

void CompactLoop::takeScene()
{
	const HexMembrane* membrane = bonds ? bonds->membrane.get() : nullptr;
	if (collectedScene != scene) collected = false; // the engine was put into another scene: what it remembers is of no use there
	collectedScene = scene;
	if (!collected || collectedBodies != scene->bodies->size() || collectedMembrane != membrane || !refreshBodies()) collect();
	refreshMaterials();
	flat.setSkin(usedSkin());
	if (exported) {
		scene->interactions->clear();
		exported = false;
	} else if (scene->interactions->size() > 0)
		importInteractions();
	takeOutsideForces();
	if (!membrane) return;
	// the kernels' rows
	const int n = membrane->perRing, grains = flat.grains();
	hexmembrane::BondForce& kernel = bonds->bondKernel();
	const bool rotating = rotatingMembrane();
	for (int k = 0; k < membrane->rings; ++k) {
		for (int i = 0; i < n; ++i) {
			const int m = grains + k * n + i;
			kernel.position.set(k, i, flat.places[m].centre);
			rows.velocity.set(k, i, flat.motions[m].velocity);
			if (!rotating) continue;
			kernel.velocity.set(k, i, flat.motions[m].velocity);
			kernel.spin.set(k, i, flat.motions[m].spin);
		}
		kernel.position.wrap(k);
		if (!rotating) continue;
		kernel.velocity.wrap(k);
		kernel.spin.wrap(k);
	}
}

void CompactLoop::takeOutsideForces()
{
	if (scene->forces.lastReset < scene->iter)
		throw std::runtime_error("CompactLoop: the forces of the step before are still there; fix: put ForceResetter() first in O.engines");
	scene->forces.sync();
	flat.outside.clear();
	const int count = flat.spheres();
	const auto load = [&](int i) { return hexmembrane::Load{scene->forces.getForce(flat.id[i]), scene->forces.getTorque(flat.id[i])}; };
	bool any = false;
#pragma omp parallel for schedule(static) num_threads(threads) reduction(|| : any)
	for (int i = 0; i < count; ++i) {
		const hexmembrane::Load found = load(i);
		any = any || found.force != Vector3r::Zero() || found.torque != Vector3r::Zero();
	}
	if (!any) return;
	for (int i = 0; i < count; ++i) flat.outside.push_back(load(i));
}

void CompactLoop::giveScene()
{
	const int count = flat.spheres(), grains = flat.grains();
	const bool rotating = collectedMembrane && rotatingMembrane();
	const auto& bodies = *scene->bodies;
	if (collectedMembrane) rows.giveVelocities(flat.motions.data() + grains);
	// each thread adds to forces of its own, and each body is one thread's: the sums are the same for any number of them
#pragma omp parallel for schedule(static) num_threads(threads)
	for (int i = 0; i < count; ++i) {
		prefetchAhead(bodies, flat.id, i);
		const Body* b = livingBody(bodies, flat.id[i]);
		State& state = *b->state;
		state.se3.position = flat.places[i].centre;
		state.vel = flat.motions[i].velocity;
		state.angVel = flat.motions[i].spin;
		if (flat.loads.empty()) continue;
		Vector3r force = flat.loads[i].force, torque = flat.loads[i].torque;
		if (i < grains) {
			const Real angle = flat.turned[i].norm();
			if (angle > 0) {
				state.se3.orientation = Quaternionr(AngleAxisr(angle, flat.turned[i] / angle)) * state.se3.orientation;
				state.se3.orientation.normalize();
				flat.turned[i] = Vector3r::Zero();
			}
		} else {
			const int m = i - grains, n = collectedMembrane->perRing;
			force = rows.force().get(m / n, m % n);
			if (rotating) torque += bonds->bondKernel().torque.get(m / n, m % n);
		}
		if (!flat.outside.empty()) { // it is in O.forces already
			force -= flat.outside[i].force;
			torque -= flat.outside[i].torque;
		}
		scene->forces.addForce(flat.id[i], force);
		scene->forces.addTorque(flat.id[i], torque);
	}
	for (size_t b = 0; b < boundaryIds.size() && b < flat.onBoundary.size(); ++b) {
		scene->forces.addForce(boundaryIds[b], flat.onBoundary[b].load.force);
		scene->forces.addTorque(boundaryIds[b], flat.onBoundary[b].load.torque);
	}
	scene->forces.sync();
	listsMade = flat.listsMade();
}

} // namespace yade
