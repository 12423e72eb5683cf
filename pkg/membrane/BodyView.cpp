// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "BodyView.hpp"

#include "HexMembrane.hpp"

#include "base/GatherBodies.hpp"
#include "contact/LinearContact.hpp"

#include <core/Interaction.hpp>
#include <pkg/common/NormShearPhys.hpp>
#include <pkg/common/Sphere.hpp>
#include <pkg/dem/CohesiveFrictionalContactLaw.hpp>
#include <pkg/dem/ScGeom.hpp>
#include <pkg/dem/NewtonIntegrator.hpp>

#include <map>
#include <unordered_map>

namespace yade {

namespace {

//! Calls visit(geom, phys) for each contact of a body. \return class of a contact that does not tell its normal and stiffness, which is left out; "": none
template <typename Visit>
string forEachOfBody(const Body& body, Visit&& visit)
{
	string silent;
	for (const auto& entry : body.intrs) {
		const Interaction& contact = *entry.second;
		if (!contact.isReal()) continue;
		const auto* geom = dynamic_cast<const GenericSpheresContact*>(contact.geom.get());
		const auto* phys = dynamic_cast<const NormPhys*>(contact.phys.get());
		if (geom && phys)
			visit(*geom, *phys);
		else
			silent = contact.phys->getClassName();
	}
	return silent;
}

//! What holds the same two spheres together besides.
void addTo(TouchingContact& contact, const TouchingContact& joint)
{
	contact.force += joint.id1 == contact.id1 ? joint.force : Vector3r(-joint.force);
	contact.normalForce += joint.normalForce;
	contact.friction = joint.friction;
}

} // namespace

void Stepped::stepOverBodies(GlobalEngine& self)
{
	Scene& scene = *self.scene;
	const string who = self.getClassName();
	if (const auto* keeper = ContactKeeper::of(scene))
		throw std::runtime_error(who + ": it stands in O.engines beside a " + keeper->getClassName() +
		                         ", where it would act once in many steps; fix: put it into its engines");
	bool integrated = false;
	for (const auto& engine : scene.engines) {
		if (dynamic_cast<const NewtonIntegrator*>(engine.get())) integrated = true;
		if (engine.get() == &self && integrated)
			throw std::runtime_error(who + ": it comes after NewtonIntegrator in O.engines; fix: put it before, after the engines that add forces");
	}
	prepare();
	constexpr long lookEvery = 1000; // engines are rarely changed while a test runs
	if (scene.iter % lookEvery == 0) requireReferenceScene();
	BodyView view(scene, who);
	step(view);
	bookStored();
	bookWorks();
}

const Engine* ContactKeeper::of(const Scene& scene)
{
	for (const auto& engine : scene.engines)
		if (!engine->dead && dynamic_cast<const ContactKeeper*>(engine.get())) return engine.get();
	return nullptr;
}

void Stepped::forEachOf(const vector<shared_ptr<Engine>>& engines, const Visit& visit)
{
	for (const auto& engine : engines) {
		const auto* one = dynamic_cast<const Stepped*>(engine.get());
		if (one && !engine->dead) visit(*one);
	}
}

const vector<shared_ptr<Engine>>& Stepped::enginesOf(const Scene& scene)
{
	const auto* keeper = dynamic_cast<const ContactKeeper*>(ContactKeeper::of(scene));
	return keeper ? keeper->innerEngines() : scene.engines;
}

void Stepped::forEachIn(const Scene& scene, const Visit& visit) { forEachOf(enginesOf(scene), visit); }

void Stepped::forEachContactWith(const vector<shared_ptr<Engine>>& engines, const std::function<void(const VisitContact&)>& own, const VisitContact& visit)
{
	vector<TouchingContact> joints;
	std::map<std::pair<Body::id_t, Body::id_t>, size_t> jointOf; // the lower id first
	forEachOf(engines, [&](const Stepped& engine) {
		engine.forEachJoint([&](const TouchingContact& joint) {
			const auto [at, isNew] = jointOf.emplace(std::minmax(joint.id1, joint.id2), joints.size());
			if (isNew)
				joints.push_back(joint);
			else
				addTo(joints[at->second], joint);
		});
	});
	if (joints.empty())
		own(visit);
	else
		own([&](const TouchingContact& contact) {
			const auto at = jointOf.find(std::minmax(contact.id1, contact.id2));
			if (at == jointOf.end()) return visit(contact);
			TouchingContact both = contact;
			addTo(both, joints[at->second]);
			jointOf.erase(at);
			visit(both);
		});
	for (const TouchingContact& joint : joints)
		if (jointOf.count(std::minmax(joint.id1, joint.id2))) visit(joint);
	forEachOf(engines, [&](const Stepped& engine) { engine.forEachContact(visit); });
}

void Stepped::addContactForces(const vector<Body::id_t>& ids, vector<Vector3r>& onParticles) const
{
	std::unordered_map<Body::id_t, size_t> index; // made when there is a contact
	forEachContact([&](const TouchingContact& contact) {
		if (index.empty())
			for (size_t i = 0; i < ids.size(); ++i) index[ids[i]] = i;
		const auto at = index.find(contact.id1);
		if (at != index.end()) onParticles[at->second] -= contact.force;
	});
}

const ContactKeeper* ContactKeeper::in(const Scene& scene)
{
	const auto* keeper = dynamic_cast<const ContactKeeper*>(of(scene));
	return keeper && keeper->keepsContacts() ? keeper : nullptr;
}

const hexmembrane::PaddedRings& BodyView::positions(const HexMembrane& membrane)
{
	if (rowsOf != &membrane) membrane.gather(scene, who, rows);
	rowsOf = &membrane;
	return rows;
}

void BodyView::refresh(const Sheet& sheet)
{
	sheet.membrane->gather(scene, who, *sheet.position);
	if (!sheet.spin) return;
	const int n = sheet.stencil.perRing;
	forEachState(*scene.bodies, *sheet.ids, [&](int i, const State& state) { // they all live: gather() has looked
		sheet.velocity->set(i / n, i % n, state.vel);
		sheet.spin->set(i / n, i % n, state.angVel);
	});
	for (int k = 0; k < sheet.stencil.rings; ++k) {
		sheet.velocity->wrap(k);
		sheet.spin->wrap(k);
	}
}

void BodyView::addForces(const HexMembrane& membrane, const vector<RingRange>& rings, const hexmembrane::PaddedRings& force,
                         const hexmembrane::PaddedRings* torque, WorkMeter* meter)
{
	vector<int> list;
	for (const RingRange& range : rings)
		for (int k = range.first; k <= range.last; ++k) list.push_back(k);
	const int n = membrane.perRing, count = static_cast<int>(list.size()) * n;
	vector<Vector3r> forces(meter ? count : 0), at(meter ? count : 0);
	const hexmembrane::PaddedRings* x = meter ? &positions(membrane) : nullptr;
	int bad = -1;
#pragma omp parallel for schedule(static) reduction(max : bad)
	for (int p = 0; p < count; ++p) {
		const int k = list[p / n], i = p % n;
		const Body::id_t id = membrane.ids[k * n + i];
		const Vector3r f = force.get(k, i);
		if (!isFinite(f)) bad = std::max(bad, k * n + i);
		scene.forces.addForce(id, f);
		if (torque) scene.forces.addTorque(id, torque->get(k, i));
		if (!meter) continue;
		forces[p] = f;
		at[p] = x->get(k, i);
	}
	if (bad >= 0) throwNotFinite(who + ": force", membrane.ids[bad], scene);
	if (!meter) return;
	meter->takeOver(scene.iter, forces, [&](size_t p) { return Vector3r(scene.dt * (*scene.bodies)[membrane.ids[list[p / n] * n + p % n]]->state->vel); });
	meter->add(scene.iter, forces, at);
}

void BodyView::grip(const HexMembrane& membrane, const vector<std::pair<int, Vector3r>>& rings, WorkMeter& meter)
{
	scene.forces.sync();
	vector<Vector3r> held, at, ways;
	Real speeding = 0;
	for (const auto& [ring, velocity] : rings)
		for (int i = ring * membrane.perRing; i < (ring + 1) * membrane.perRing; ++i) {
			State& state = *membrane.body(scene, i, who)->state;
			speeding += 0.5 * state.mass * (velocity.squaredNorm() - state.vel.squaredNorm());
			ways.push_back(scene.dt * state.vel);
			state.vel = velocity;
			state.isDamped = false; // else NewtonIntegrator books a dissipation that does not take place
			held.push_back(-scene.forces.getForce(membrane.ids[i]));
			at.push_back(state.pos);
		}
	meter.takeOver(scene.iter, held, [&](size_t p) { return ways[p]; });
	meter.add(scene.iter, held, at, speeding);
}

hexmembrane::SphereRows BodyView::grains(const HexMembrane& membrane)
{
	if (grainsBeside == &membrane) return {grainPlaces.data(), grainIds.data(), static_cast<int>(grainIds.size())};
	grainsBeside = &membrane;
	vector<char> own(scene.bodies->size(), 0);
	for (Body::id_t id : membrane.ids) own.at(id) = 1;
	grainPlaces.clear();
	grainIds.clear();
	for (const auto& body : *scene.bodies) {
		const auto* sphere = body && !own[body->getId()] ? dynamic_cast<const Sphere*>(body->shape.get()) : nullptr;
		if (!sphere) continue;
		grainPlaces.push_back({body->state->pos, sphere->radius});
		grainIds.push_back(body->getId());
	}
	return grains(membrane);
}

void BodyView::addForce(int grain, const Vector3r& force)
{
	if (!isFinite(force)) throwNotFinite(who + ": force", grainIds[grain], scene);
	scene.forces.addForce(grainIds[grain], force);
}

MovingRows BodyView::moving(const vector<Body::id_t>& ids)
{
	movingIds = &ids;
	movingPlaces.clear();
	motions.clear();
	for (const Body::id_t id : ids) {
		const Body* body = livingBody(*scene.bodies, id);
		const auto* sphere = body ? dynamic_cast<const Sphere*>(body->shape.get()) : nullptr;
		if (!sphere) hexmembrane::reject(who + ".ids", int(id), "is bonded, and is no sphere any more", "release() it before it is erased");
		movingPlaces.push_back({body->state->pos, sphere->radius});
		motions.push_back({body->state->vel, body->state->angVel});
	}
	return {movingPlaces.data(), motions.data(), ids.data(), static_cast<int>(ids.size()), 0};
}

void BodyView::addLoad(int row, const hexmembrane::Load& load)
{
	scene.forces.addForce((*movingIds)[row], load.force);
	scene.forces.addTorque((*movingIds)[row], load.torque);
}

vector<Vector3r> BodyView::contactForces(const HexMembrane& membrane) { return membrane.contactForces(scene, who); }

ContactSums BodyView::contacts(Body::id_t boundary)
{
	scene.forces.sync();
	ContactSums sums;
	sums.force = scene.forces.getForce(boundary);
	sums.silent = forEachOfBody(*(*scene.bodies)[boundary], [&](const GenericSpheresContact& geom, const NormPhys& phys) {
		++sums.count;
		sums.normalForce += phys.normalForce.dot(geom.normal);
		sums.normalStiffness += phys.kn;
	});
	return sums;
}

Real BodyView::stiffness(Body::id_t boundary, const Vector3r& along)
{
	Real sum = 0;
	const string silent = forEachOfBody(*(*scene.bodies)[boundary], [&](const GenericSpheresContact& geom, const NormPhys& phys) {
		const auto* shear = dynamic_cast<const NormShearPhys*>(&phys);
		const Real cosine = geom.normal.dot(along), squared = cosine * cosine;
		sum += phys.kn * squared + (shear ? shear->ks * (1 - squared) : 0);
	});
	if (!silent.empty())
		throw std::runtime_error(who + ": contacts of " + silent +
		                         " do not tell their stiffness; fix: a contact law whose IPhys derives from NormPhys, or give contactStiffness in N/m");
	return sum;
}

Real BodyView::touchingMass(Body::id_t boundary)
{
	Real sum = 0;
	for (const auto& [other, contact] : (*scene.bodies)[boundary]->intrs) {
		const Body* body = contact->isReal() ? livingBody(*scene.bodies, other) : nullptr;
		if (body) sum += body->state->mass;
	}
	return sum;
}

namespace {

//! As TouchingContact::friction.
Real frictionOf(const NormShearPhys& phys)
{
	const auto* linear = dynamic_cast<const LinearPhys*>(&phys);
	const auto* cohesive = dynamic_cast<const CohFrictPhys*>(&phys);
	if ((linear && linear->bonded) || (cohesive && !cohesive->cohesionBroken)) return std::numeric_limits<Real>::infinity();
	const auto* frictional = dynamic_cast<const FrictPhys*>(&phys);
	return frictional ? frictional->tangensOfFrictionAngle : NaN;
}

void forEachOwn(const Scene& scene, const string& who, const VisitContact& visit)
{
	for (const auto& interaction : *scene.interactions) {
		if (!interaction->isReal()) continue;
		const Body *a = livingBody(*scene.bodies, interaction->getId1()), *b = livingBody(*scene.bodies, interaction->getId2());
		if (!a || !b) continue; // YADE takes it away in the next step
		const auto* geom = dynamic_cast<const GenericSpheresContact*>(interaction->geom.get());
		const auto* phys = dynamic_cast<const NormShearPhys*>(interaction->phys.get());
		if (!geom || !phys)
			throw std::runtime_error(who + ": contacts of " + interaction->phys->getClassName() +
			                         " do not tell their forces; fix: a contact law whose IPhys derives from NormShearPhys");
		// where the centres were when the forces were computed: NewtonIntegrator has moved them since
		const auto* overlapping = dynamic_cast<const ScGeom*>(geom);
		const auto centre = [&](const Body& body, Real side) -> Vector3r {
			const auto* sphere = dynamic_cast<const Sphere*>(body.shape.get());
			if (!sphere) return geom->contactPoint;
			return overlapping ? Vector3r(geom->contactPoint + side * (sphere->radius - 0.5 * overlapping->penetrationDepth) * geom->normal)
			                   : body.state->pos;
		};
		visit({a->getId(), b->getId(), centre(*a, -1), centre(*b, 1), geom->contactPoint, phys->normalForce + phys->shearForce,
		       phys->normalForce.dot(geom->normal), frictionOf(*phys)});
	}
}

void forEachInteraction(const Scene& scene, const string& who, const VisitContact& visit)
{
	Stepped::forEachContactWith(Stepped::enginesOf(scene), [&](const VisitContact& one) { forEachOwn(scene, who, one); }, visit);
}

} // namespace

void forEachContactOf(const Scene& scene, const string& who, const VisitContact& visit)
{
	if (const auto* keeper = ContactKeeper::in(scene))
		keeper->forEachContact(visit);
	else
		forEachInteraction(scene, who, visit);
}

void BodyView::forEachContact(const VisitContact& visit) { forEachInteraction(scene, who, visit); }

} // namespace yade
