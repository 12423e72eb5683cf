// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "CompactLoop.hpp"

#include "contact/LinearContact.hpp"
#include "kernels/compact/CriticalStep.hpp"
#include "membrane/GatherBodies.hpp"

#include <core/Scene.hpp>
#include <pkg/dem/ScGeom.hpp>

#include <boost/make_shared.hpp>

#include <numeric>

namespace yade {

using hexmembrane::ContactMemory;

// Calls visit(id1, id2, memory, bits) for every contact that remembers something.
template <typename Visit>
void CompactLoop::forEachContact(Visit&& visit) const
{
	flat.contacts.forEachTouching([&](int i, int j, const ContactMemory& memory, unsigned char bits) { visit(flat.id[i], flat.id[j], memory, bits); });
	for (size_t b = 0; b < flat.boundaryContacts.size(); ++b)
		flat.boundaryContacts[b].forEachTouching(
		        [&](int i, const ContactMemory& memory, unsigned char bits) { visit(boundaryIds[b], flat.id[i], memory, bits); });
}

void CompactLoop::forgetStored()
{
	contactIds.clear();
	contactBits.clear();
	contactShear.clear();
	contactMoment.clear();
	contactNormal.clear();
	contactTensile.clear();
	contactStrength.clear();
}

void CompactLoop::storeContacts()
{
	order.assign(flat.id.begin(), flat.id.begin() + flat.grains());
	listedCentres = flat.listed;
	listedBoundaryCentres.clear();
	listedBoundaryRadii.clear();
	for (const auto& boundary : flat.listedBoundaries) {
		listedBoundaryCentres.push_back(boundary.solid.centre);
		listedBoundaryRadii.push_back(boundary.solid.radius);
	}
	travelled = flat.travelled;
	forgetStored();
	forEachContact([&](int a, int b, const ContactMemory& memory, unsigned char bits) {
		contactIds.emplace_back(a, b);
		contactBits.push_back(bits);
		contactShear.push_back(memory.shear);
		contactMoment.push_back(memory.moment);
		contactNormal.push_back(memory.normal);
		contactTensile.push_back(memory.law.tensileStrength);
		contactStrength.push_back(memory.law.shearStrength);
	});
}

void CompactLoop::preSave(CompactLoop&)
{
	if (collected) storeContacts();
}

// The lists as they were when the state was saved, from the positions that they had been made from.
void CompactLoop::continueLists()
{
	flat.listed = listedCentres;
	flat.listedBoundaries = flat.boundaries;
	for (size_t b = 0; b < boundaryIds.size(); ++b) {
		flat.listedBoundaries[b].solid.centre = listedBoundaryCentres[b];
		flat.listedBoundaries[b].solid.radius = listedBoundaryRadii[b];
	}
	flat.travelled = travelled;
	vector<int> same(flat.spheres());
	std::iota(same.begin(), same.end(), 0);
	flat.buildLists(same);
}

void CompactLoop::putContact(Body::id_t a, Body::id_t b, ContactMemory memory, unsigned char bits)
{
	const auto index = [&](Body::id_t id) { return static_cast<size_t>(id) < sphereAt.size() ? sphereAt[id] : -1; };
	const auto boundary = std::find(boundaryIds.begin(), boundaryIds.end(), a);
	const int i = index(a), j = index(b);
	bool known = false;
	if (boundary != boundaryIds.end()) {
		auto& contacts = flat.boundaryContacts[boundary - boundaryIds.begin()];
		if (j >= 0) {
			const auto law = hexmembrane::boundaryLaw(flat.materialOf(flat.boundaries[boundary - boundaryIds.begin()].material),
			                                          flat.materialOf(flat.material[j]), flat.places[j].radius);
			memory.law = {law.kn, law.ks, law.friction, law.kr, law.rollingArm, memory.law.tensileStrength, memory.law.shearStrength};
			known = contacts.restore(j, memory, bits);
		}
	} else if (i >= 0 && j >= 0) {
		const auto law = flat.lawOf(i, j);
		memory.law = {law.kn, law.ks, law.friction, law.kr, law.rollingArm, memory.law.tensileStrength, memory.law.shearStrength};
		known = flat.contacts.restore(i, j, memory, bits);
		if (!known && hexmembrane::normalOnly(law)) { // with the membrane: has nothing to remember, and no place to do so
			if (bits & hexmembrane::contactBonded)
				throw std::runtime_error(
				        "CompactLoop: bodies " + std::to_string(a) + " and " + std::to_string(b) +
				        " are bonded without friction, grain and membrane; fix: bonds among grains only, or the reference tier");
			known = true;
		}
	}
	if (!known && (bits & hexmembrane::contactBonded))
		throw std::runtime_error("CompactLoop: the bond of bodies " + std::to_string(a) + " and " + std::to_string(b) +
		                         " reaches further than the neighbour lists; fix: a larger CompactLoop.skin, or the reference tier");
}

void CompactLoop::indexSpheres()
{
	sphereAt.assign(scene->bodies->size(), -1);
	for (int i = 0; i < flat.spheres(); ++i) sphereAt[flat.id[i]] = i;
}

void CompactLoop::restoreContacts()
{
	indexSpheres();
	for (size_t c = 0; c < contactIds.size(); ++c) {
		ContactMemory memory{contactShear[c], contactMoment[c], contactNormal[c], {}};
		memory.law.tensileStrength = contactTensile[c];
		memory.law.shearStrength = contactStrength[c];
		putContact(contactIds[c][0], contactIds[c][1], memory, static_cast<unsigned char>(contactBits[c]));
	}
	forgetStored();
}

// What the reference tier left: contacts go on with their forces and moments.
void CompactLoop::importInteractions()
{
	indexSpheres();
	for (const auto& contact : *scene->interactions) {
		if (!contact->isReal()) continue;
		const auto* phys = dynamic_cast<const LinearPhys*>(contact->phys.get());
		const auto* geom = dynamic_cast<const ScGeom*>(contact->geom.get());
		if (!phys || !geom)
			throw std::runtime_error("CompactLoop: the contact of bodies " + std::to_string(contact->getId1()) + " and " +
			                         std::to_string(contact->getId2()) + " was made by another law (" + contact->phys->getClassName() +
			                         "); fix: LinearMat and its law in the reference tier, or O.interactions.clear()");
		ContactMemory memory{phys->shearForce, phys->moment, geom->normal, {}};
		memory.law.tensileStrength = phys->tensileStrength;
		memory.law.shearStrength = phys->shearStrength;
		const unsigned char bits = hexmembrane::contactTouching | (phys->bonded ? hexmembrane::contactBonded : 0);
		putContact(contact->getId1(), contact->getId2(), memory, bits);
	}
	scene->interactions->clear();
}

// Positions and boundaries as they were when the forces of the last step were computed.
CompactLoop::Instant CompactLoop::lastInstant() const
{
	Instant then{flat.places, flat.boundaries};
	for (int i = 0; i < flat.spheres(); ++i) then.places[i].centre -= lastDt * flat.motions[i].velocity;
	for (size_t b = 0; b < then.boundaries.size(); ++b) {
		then.boundaries[b].solid.centre -= lastDt * flat.boundaries[b].velocity;
		if (wallServo && boundaryIds[b] == wallServo->wall) then.boundaries[b].solid.radius += lastDt * wallServo->velocity;
	}
	return then;
}

void CompactLoop::exportContacts()
{
	if (!collected) throw std::runtime_error("CompactLoop.exportContacts: nothing computed yet; fix: run a step first");
	auto& interactions = *scene->interactions;
	interactions.clear();
	const auto write = [&](int a, int b, const hexmembrane::ContactLaw& law, bool spheres, Real u, const Vector3r& normal, const Vector3r& point, Real r1,
	                       Real r2, const ContactMemory* memory, unsigned char bits) {
		auto geom = boost::make_shared<ScGeom>();
		geom->normal = normal;
		geom->contactPoint = point;
		geom->penetrationDepth = u;
		geom->refR1 = geom->radius1 = r1;
		geom->refR2 = geom->radius2 = r2;
		auto phys = boost::make_shared<LinearPhys>();
		phys->set(law, spheres);
		phys->normalForce = law.kn * u * normal;
		if (memory) {
			phys->shearForce = memory->shear;
			phys->moment = memory->moment;
			if (bits & hexmembrane::contactBonded) phys->bond(law.tensileStrength, law.shearStrength);
		}
		auto contact = boost::make_shared<Interaction>(a, b);
		contact->geom = geom;
		contact->phys = phys;
		contact->iterMadeReal = scene->iter;
		interactions.insert(contact);
	};
	const Instant then = lastInstant();
	const auto& places = then.places;
	const auto writeSpheres = [&](int i, int j, const hexmembrane::ContactLaw& law, const ContactMemory* memory, unsigned char bits) {
		const auto &a = places[i], &b = places[j];
		const Vector3r branch = b.centre - a.centre;
		const Real distance = branch.norm(), u = a.radius + b.radius - distance;
		const Vector3r normal = branch / distance;
		write(flat.id[i], flat.id[j], law, true, u, normal, a.centre + (a.radius - 0.5 * u) * normal, a.radius, b.radius, memory, bits);
	};
	flat.contacts.forEachTouching([&](int i, int j, const ContactMemory& memory, unsigned char bits) { writeSpheres(i, j, memory.law, &memory, bits); });
	flat.smooth.forEachTouching(places, [&](int i, int j, Real, Real, const Vector3r&) { writeSpheres(i, j, flat.lawOf(i, j), nullptr, 0); });
	for (size_t k = 0; k < then.boundaries.size(); ++k)
		flat.boundaryContacts[k].forEachTouching([&](int i, const ContactMemory& memory, unsigned char bits) {
			const auto touch = then.boundaries[k].touch(places[i]);
			write(boundaryIds[k], flat.id[i], memory.law, false, touch.u, touch.normal, touch.point, places[i].radius, places[i].radius, &memory,
			      bits);
		});
	exported = true;
}

int CompactLoop::contactCount() const
{
	int count = 0;
	forEachContact([&](int, int, const ContactMemory&, unsigned char) { ++count; });
	flat.smooth.forEachTouching(lastInstant().places, [&](int, int, Real, Real, const Vector3r&) { ++count; });
	return count;
}

Real CompactLoop::criticalTimeStep()
{
	if (!collected) throw std::runtime_error("CompactLoop.criticalTimeStep: nothing computed yet; fix: run a step first");
	hexmembrane::CriticalStep step(flat);
	if (bonds) {
		const auto& x = bonds->bondKernel().position;
		const auto tube = collectedMembrane->stencil();
		for (const auto& pair : hexmembrane::bondList(tube)) {
			const auto at = [&](int v) { return x.get(v / tube.perRing, v % tube.perRing); };
			step.addBond(pair[0], pair[1], at(pair[1]) - at(pair[0]), bonds->springs().kn, bonds->springs().ks);
		}
	}
	return step.compute();
}

} // namespace yade
