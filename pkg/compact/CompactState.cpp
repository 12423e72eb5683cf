// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "CompactState.hpp"

#include "base/NamedFields.hpp"
#include "base/GatherBodies.hpp"

#include <pkg/common/Sphere.hpp>

namespace yade {

int CompactState::materialIndex(const Body& body)
{
	const auto material = boost::dynamic_pointer_cast<const LinearMat>(body.material);
	if (!material) refuseBody(body.getId(), "has a material that is no LinearMat", "give all bodies a LinearMat, or use the reference tier");
	const auto found = std::find(materials.begin(), materials.end(), material);
	if (found != materials.end()) return static_cast<int>(found - materials.begin());
	material->requireComplete();
	materials.push_back(material);
	return static_cast<int>(materials.size()) - 1;
}

CompactState::SphereRow CompactState::sphereOf(const Body& body, bool ofSheet)
{
	const State& state = *body.state;
	const Body::id_t id = body.getId();
	const bool fixed = state.blockedDOFs == State::DOF_ALL, turns = (state.blockedDOFs & State::DOF_RXRYRZ) != State::DOF_RXRYRZ;
	if (!body.isStandalone()) refuseBody(id, "is a clump or of one", "use single spheres, or the reference tier");
	if (body.isAspherical()) refuseBody(id, "is aspherical", "aspherical=False, or use the reference tier");
	if (!body.isBounded()) refuseBody(id, "has bounded = False, so that no collider sees it", "bounded=True, or use the reference tier");
	if (!fixed) {
		if (!ofSheet && state.blockedDOFs != 0)
			refuseBody(id, "has some of its degrees of freedom blocked", "block all or none of a grain's, or use the reference tier");
		if (!state.isDamped) refuseBody(id, "has isDamped = False", "leave it True, or use the reference tier");
		const string name = "O.bodies[" + std::to_string(id) + "].state.";
		hexmembrane::requirePositive(name + "mass", state.mass, "kg");
		if (turns) hexmembrane::requirePositive(name + "inertia", state.inertia.minCoeff(), "kg m2");
		if (turns && state.inertia.maxCoeff() > state.inertia.minCoeff() * (1 + 1e-9))
			refuseBody(id, "is aspherical (three different moments of inertia)", "give a sphere's, or use the reference tier");
	}
	const Real radius = static_cast<const Sphere&>(*body.shape).radius;
	hexmembrane::requirePositive("O.bodies[" + std::to_string(id) + "].shape.radius", radius, "m");
	const Real inertia = fixed || turns ? state.inertia[0] : std::numeric_limits<Real>::infinity();
	return {static_cast<int>(id), {state.pos, radius}, {state.vel, state.angVel}, state.mass, inertia, materialIndex(body), fixed, body.groupMask};
}

void CompactState::addBoundary(const Body& body)
{
	const auto* make = BoundaryRegistry::find(*body.shape);
	if (!body.isStandalone()) refuseBody(body.getId(), "is a boundary of a clump", "take it out of the clump, or use the reference tier");
	if (!body.isBounded()) refuseBody(body.getId(), "has bounded = False, so that no collider sees it", "bounded=True, or use the reference tier");
	if (body.state->blockedDOFs != State::DOF_ALL)
		refuseBody(body.getId(), "is a boundary that is free to move", "dynamic=False, or give it a PlatenDrive");
	const State& state = *body.state;
	spheres.boundaries.push_back({(*make)(*body.shape, state), state.pos, state.vel, state.angVel, materialIndex(body), body.groupMask});
	boundaryIds.push_back(body.getId());
}

void CompactState::collectSheet(const Scene& scene, vector<SphereRow>& rows)
{
	const size_t first = rows.size();
	vector<unsigned char> blocked;
	for (Body::id_t id : *sheet.ids) {
		const Body* b = livingBody(*scene.bodies, id);
		if (!b) refuseBody(id, "of the membrane is gone", "do not erase membrane bodies");
		if (!dynamic_cast<const Sphere*>(b->shape.get())) refuseBody(id, "of the membrane is no Sphere", "leave its shape, or use the reference tier");
		rows.push_back(sphereOf(*b, true));
		marks[id] = BodyMark(*b);
		blocked.push_back(static_cast<unsigned char>(b->state->blockedDOFs));
		const SphereRow &one = rows.back(), &other = rows[first];
		if (one.mass != other.mass) refuseBody(id, "of the membrane has another mass than the rest", "give all the same, or use the reference tier");
		if (one.place.radius != other.place.radius)
			refuseBody(id, "of the membrane has another radius than the rest", "give all the same, or use the reference tier");
		const bool turns = (b->state->blockedDOFs & State::DOF_RXRYRZ) != State::DOF_RXRYRZ;
		if (turns && !sheet.spin)
			refuseBody(id, "of the membrane is free to turn, and bonds without shear stiffness do not hold it",
			           "HexMembrane(rotations=False), bonds with ks > 0, or use the reference tier");
		if (turns && spinInertia == 0) spinInertia = one.inertia;
		if (turns && one.inertia != spinInertia)
			refuseBody(id, "of the membrane has another inertia than the rest", "give all the same, or use the reference tier");
	}
	motion = hexmembrane::MembraneMotion(sheet.stencil);
	motion.mass = rows[first].mass;
	motion.setBlocked(blocked);
	if (!sheet.velocity) ownVelocity = hexmembrane::PaddedRings(sheet.stencil.perRing, sheet.stencil.rings);
}

CompactState::CompactState(const Scene& scene, const Sheet& given) : sheet(given), collectedFrom(&scene), marks(scene.bodies->size())
{
	const std::set<Body::id_t> ofSheet = sheet.ids ? std::set<Body::id_t>(sheet.ids->begin(), sheet.ids->end()) : std::set<Body::id_t>();
	vector<SphereRow> rows;
	int common = -1, any = 0;
	for (const auto& b : *scene.bodies) {
		if (!b) continue;
		if (dynamic_cast<const Sphere*>(b->shape.get())) {
			if ((common & b->groupMask) == 0)
				refuseBody(b->getId(), "has a mask with no bit in common with all spheres before it, so some pairs would not meet",
				           "give all spheres one common bit (the membrane a second one), or use the reference tier");
			common &= b->groupMask;
			any |= b->groupMask;
		}
		if (ofSheet.count(b->getId())) continue;
		if (b->isClump()) refuseBody(b->getId(), "is a clump or of one", "use single spheres, or the reference tier");
		if (dynamic_cast<const Sphere*>(b->shape.get()))
			rows.push_back(sphereOf(*b, false));
		else if (b->shape && BoundaryRegistry::find(*b->shape))
			addBoundary(*b);
		else
			refuseBody(b->getId(), "is a " + (b->shape ? b->shape->getClassName() : string("body without a shape")),
			           "only Sphere and boundaries (" + BoundaryRegistry::names() + ") are known here; use the reference tier");
		marks[b->getId()] = BodyMark(*b);
	}
	const int grainCount = static_cast<int>(rows.size());
	if (sheet.ids) collectSheet(scene, rows);
	if (rows.empty()) throw std::runtime_error("CompactLoop: there are no spheres in the scene; fix: add some first");
	for (size_t i = 0; i < boundaryIds.size(); ++i)
		if ((any & spheres.boundaries[i].mask) == 0)
			refuseBody(boundaryIds[i], "has a mask with no bit of any sphere's, so it would meet none",
			           "give it a bit of those that it is to meet");
	spheres.setSpheres(rows, grainCount);
	refreshMaterials();
}

bool CompactState::takeOrder(const vector<int>& order)
{
	std::map<int, int> at;
	for (int i = 0; i < grains(); ++i) at[spheres.id[i]] = i;
	vector<int> from;
	for (int id : order) {
		const auto found = at.find(id);
		if (found == at.end()) return false;
		from.push_back(found->second);
	}
	if (static_cast<int>(from.size()) != grains()) return false;
	spheres.permuteGrains(from);
	return true;
}

void CompactState::refreshMaterials()
{
	vector<hexmembrane::ContactMaterial> table;
	vector<hexmembrane::SphereAssembly::OwnPair> ownPairs;
	for (const auto& material : materials) table.push_back(material->contactMaterial());
	for (size_t a = 0; a < materials.size(); ++a)
		for (size_t b = a; b < materials.size(); ++b)
			if (const auto own = LinearMat::ownPair(*materials[a], *materials[b]))
				ownPairs.push_back({static_cast<int>(a), static_cast<int>(b), *own});
	named("CompactLoop", {}, [&] { spheres.setMaterials(table, ownPairs); });
}

void CompactState::refreshBoundary(const Scene& scene, int b)
{
	const Body& body = *(*scene.bodies)[boundaryIds[b]];
	const State& state = *body.state;
	if (state.blockedDOFs != State::DOF_ALL) refuseBody(body.getId(), "is a boundary that is free to move", "dynamic=False, or give it a PlatenDrive");
	spheres.moveBoundary(b, (*BoundaryRegistry::find(*body.shape))(*body.shape, state));
	hexmembrane::Boundary& boundary = spheres.boundaries[b];
	boundary.centre = state.pos;
	boundary.velocity = state.vel;
	boundary.spin = state.angVel;
}

bool CompactState::refresh(const Scene& scene, const Sheet& now, int threads)
{
	const bool sameSheet = sheet.membrane == now.membrane && sheet.position == now.position && sheet.velocity == now.velocity && sheet.spin == now.spin;
	if (collectedFrom != &scene || !sameSheet || marks.size() != scene.bodies->size()) return false;
	const auto& bodies = *scene.bodies;
	for (size_t b = 0; b < boundaryIds.size(); ++b) {
		const Body* body = livingBody(bodies, boundaryIds[b]);
		if (!body || body->shape != marks[boundaryIds[b]].shape) return false;
	}
	const int count = spheres.spheres();
	int changed = 0;
	Real way2 = 0;
#pragma omp parallel for schedule(static) num_threads(threads) reduction(+ : changed) reduction(max : way2)
	for (int i = 0; i < count; ++i) {
		prefetchAhead(bodies, spheres.id, i);
		constexpr int ahead = 12; // what is watched lies behind pointers of its own
		if (i + ahead < count) {
			const int next = spheres.id[i + ahead];
			__builtin_prefetch(&marks[next].inertia);
			__builtin_prefetch(&marks[next]);
			const Body* b = livingBody(bodies, next);
			if (b && b->shape) __builtin_prefetch(&static_cast<const Sphere*>(b->shape.get())->radius);
		}
		const Body* b = livingBody(bodies, spheres.id[i]);
		if (!b || !marks[spheres.id[i]].holds(*b)) {
			++changed;
			continue;
		}
		const State& state = *b->state;
		way2 = std::max(way2, (state.se3.position - spheres.places[i].centre).squaredNorm());
		spheres.places[i].centre = state.se3.position;
		spheres.motions[i] = {state.vel, state.angVel};
	}
	spheres.noteWay(std::sqrt(way2)); // by a script; it counts also where what else has changed is refused, and put right later
	if (changed > 0) return false;
	for (size_t b = 0; b < boundaryIds.size(); ++b) {
		BodyMark& mark = marks[boundaryIds[b]];
		const Body& body = *bodies[boundaryIds[b]];
		mark.damped = body.state->isDamped; // of no effect on a boundary, and changed by its drive
		mark.blocked = body.state->blockedDOFs;
		if (!mark.holds(body)) return false;
		refreshBoundary(scene, static_cast<int>(b));
	}
	spheres.endStep();
	return true;
}

void CompactState::fillRows()
{
	if (!sheet.ids) return;
	const int n = sheet.stencil.perRing;
	hexmembrane::PaddedRings& v = velocity();
	for (int k = 0; k < sheet.stencil.rings; ++k) {
		for (int i = 0; i < n; ++i) {
			const int m = grains() + k * n + i;
			sheet.position->set(k, i, spheres.places[m].centre);
			v.set(k, i, spheres.motions[m].velocity);
			if (sheet.spin) sheet.spin->set(k, i, spheres.motions[m].spin);
		}
		sheet.position->wrap(k);
		v.wrap(k);
		if (sheet.spin) sheet.spin->wrap(k);
	}
}

int CompactState::boundaryIndex(Body::id_t id) const
{
	const auto at = std::find(boundaryIds.begin(), boundaryIds.end(), id);
	return at == boundaryIds.end() ? -1 : static_cast<int>(at - boundaryIds.begin());
}

void CompactState::indexSpheres()
{
	sphereAt.assign(marks.size(), -1);
	for (int i = 0; i < spheres.spheres(); ++i) sphereAt[spheres.id[i]] = i;
}

void CompactState::requirePlace(const KeptContact& kept) const
{
	if (!kept.contact.bonded()) return;
	const int b = boundaryIndex(kept.id1), i = indexOf(kept.id1), j = indexOf(kept.id2);
	if (j < 0 || (b < 0 && i < 0)) return; // a body that is gone takes its bonds along
	if (b >= 0 ? spheres.boundaryContacts[b].has(j) : spheres.contacts.has(i, j)) return;
	const string bond = "CompactLoop: bodies " + std::to_string(kept.id1) + " and " + std::to_string(kept.id2) + " are bonded ";
	if (b < 0 && spheres.isSmooth(i, j))
		throw std::runtime_error(bond + "without friction, grain and membrane; fix: bonds among grains only, or the reference tier");
	throw std::runtime_error(bond + "further apart than the neighbour lists reach; fix: a larger CompactLoop.skin, or the reference tier");
}

void CompactState::put(const KeptContact& kept)
{
	const int b = boundaryIndex(kept.id1), i = indexOf(kept.id1), j = indexOf(kept.id2);
	if (b >= 0 && j >= 0)
		spheres.boundaryContacts[b].restore(j, kept.contact);
	else if (i >= 0 && j >= 0)
		spheres.contacts.restore(i, j, kept.contact);
}

vector<Vector3r> CompactState::contactForces(const vector<hexmembrane::Place>& places,
                                             const vector<std::shared_ptr<const hexmembrane::BoundaryShape>>& shapes) const
{
	const int first = grains();
	vector<Vector3r> forces;
	for (const auto& smooth : spheres.onParticle) forces.push_back(smooth.force);
	forces.resize(spheres.spheres() - first, Vector3r::Zero());
	spheres.contacts.forEachTouching([&](int i, int j, const hexmembrane::Contact& c) {
		if (j < first || i >= first) return;
		const Real u = places[i].radius + places[j].radius - (places[j].centre - places[i].centre).norm();
		forces[j - first] += c.law.kn * u * c.memory.normal;
	});
	for (size_t b = 0; b < spheres.boundaryContacts.size(); ++b)
		spheres.boundaryContacts[b].forEachTouching([&](int i, const hexmembrane::Contact& c) {
			if (i >= first) forces[i - first] += c.law.kn * shapes[b]->touch(places[i]).overlap * c.memory.normal;
		});
	return forces;
}

void CompactState::visitContacts(const vector<hexmembrane::Place>& places, const vector<std::shared_ptr<const hexmembrane::BoundaryShape>>& shapes,
                                 const VisitContact& visit) const
{
	const Real inf = std::numeric_limits<Real>::infinity();
	const auto put = [&](Body::id_t id1, Body::id_t id2, const Vector3r& centre1, const Vector3r& centre2, const hexmembrane::Contact& c,
	                     const hexmembrane::BoundaryTouch& touch) {
		const Real normal = c.law.kn * touch.overlap;
		visit({id1, id2, centre1, centre2, touch.point, normal * touch.normal + c.memory.shear, normal, c.bonded() ? inf : c.law.friction});
	};
	forEachSpherePair(places, [&](int i, int j, const hexmembrane::Contact& c) {
		put(spheres.id[i], spheres.id[j], places[i].centre, places[j].centre, c, touchOf(places[i], places[j]));
	});
	for (size_t b = 0; b < spheres.boundaryContacts.size(); ++b)
		spheres.boundaryContacts[b].forEachTouching([&](int i, const hexmembrane::Contact& c) {
			const auto touch = shapes[b]->touch(places[i]);
			put(boundaryIds[b], spheres.id[i], touch.point, places[i].centre, c, touch);
		});
}

} // namespace yade
