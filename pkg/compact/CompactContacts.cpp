// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "CompactLoop.hpp"

#include "contact/LinearContact.hpp"
#include "kernels/compact/CriticalStep.hpp"

#include <core/Scene.hpp>
#include <pkg/dem/ScGeom.hpp>

#include <boost/make_shared.hpp>

#include <cstring>
#include <unordered_map>

namespace yade {

using hexmembrane::Contact;

namespace {

// A contact's saved numbers: what the model remembers and the strengths of its bond, as they lie in memory, named by their fields.
struct SavedContact {
	hexmembrane::ContactMemory<double> memory;
	hexmembrane::BondStrengths strengths;

	static constexpr size_t numbers = (sizeof(memory) + sizeof(strengths)) / sizeof(double);
	static string fields() { return string(decltype(memory)::fields) + " " + decltype(strengths)::fields; }
};
static_assert(sizeof(SavedContact) == SavedContact::numbers * sizeof(double), "a saved contact is its numbers");

} // namespace

void CompactLoop::requireRun(const char* what) const
{
	if (!state) throw std::runtime_error(string("CompactLoop.") + what + ": nothing computed yet; fix: run a step first");
}

vector<KeptContact> CompactLoop::contactsSoFar() const
{
	vector<KeptContact> kept;
	if (state) state->forEachContact([&](const KeptContact& contact) { kept.push_back(contact); });
	return kept;
}

void CompactLoop::preSave(CompactLoop&)
{
	if (!state) return; // what was loaded is still there
	const hexmembrane::SphereAssembly& spheres = state->spheres;
	order.assign(spheres.id.begin(), spheres.id.begin() + spheres.grains());
	listedCentres = spheres.listed;
	listedShapes.clear();
	for (const auto& shape : spheres.listedShapes)
		for (const Real number : shape->numbers()) listedShapes.push_back(number);
	travelled = spheres.travelled;
	contactFields = SavedContact::fields();
	contactIds.clear();
	contactBits.clear();
	contactNumbers.clear();
	state->forEachContact([&](const KeptContact& kept) {
		contactIds.emplace_back(kept.id1, kept.id2);
		contactBits.push_back(kept.contact.bits);
		const SavedContact saved{kept.contact.memory, kept.contact.strengths()};
		Real numbers[SavedContact::numbers];
		std::memcpy(numbers, static_cast<const void*>(&saved), sizeof saved);
		contactNumbers.insert(contactNumbers.end(), numbers, numbers + SavedContact::numbers);
	});
}

vector<KeptContact> CompactLoop::savedContacts() const
{
	if (contactFields != SavedContact::fields())
		throw std::runtime_error("CompactLoop: the saved contacts have the fields '" + contactFields + "', this version has '" +
		                         SavedContact::fields() + "'; fix: go on with the version that saved the state, or start anew");
	if (contactBits.size() != contactIds.size() || contactNumbers.size() != SavedContact::numbers * contactIds.size())
		throw std::runtime_error("CompactLoop: the saved contacts are not whole (" + std::to_string(contactIds.size()) + " contacts, " +
		                         std::to_string(contactNumbers.size()) + " numbers); fix: load another saved state");
	vector<KeptContact> kept;
	for (size_t c = 0; c < contactIds.size(); ++c) {
		SavedContact saved;
		std::memcpy(static_cast<void*>(&saved), contactNumbers.data() + SavedContact::numbers * c, sizeof saved);
		kept.push_back({contactIds[c][0], contactIds[c][1], {saved.memory, {}, static_cast<unsigned char>(contactBits[c])}});
		kept.back().contact.law.tensileStrength = saved.strengths.tension;
		kept.back().contact.law.shearStrength = saved.strengths.shear;
	}
	return kept;
}

// The lists as they were when the state was saved, from the positions that they had been made from: sums over contacts keep their bits.
bool CompactLoop::continueLists(CompactState& next) const
{
	hexmembrane::SphereAssembly& spheres = next.spheres;
	size_t at = 0;
	vector<std::shared_ptr<const hexmembrane::BoundaryShape>> shapes;
	for (const auto& boundary : spheres.boundaries) {
		const size_t count = boundary.shape->numbers().size();
		if (at + count > listedShapes.size()) return false;
		shapes.push_back(boundary.shape->from({listedShapes.begin() + at, listedShapes.begin() + at + count}));
		at += count;
	}
	if (at != listedShapes.size() || listedCentres.size() != static_cast<size_t>(spheres.spheres()) || !next.takeOrder(order)) return false;
	spheres.continueLists(listedCentres, shapes, travelled);
	return true;
}

// What the reference tier left: contacts go on with their forces and moments.
vector<KeptContact> CompactLoop::interactionContacts() const
{
	vector<KeptContact> found;
	for (const auto& interaction : *scene->interactions) {
		if (!interaction->isReal()) continue;
		const auto* phys = dynamic_cast<const LinearPhys*>(interaction->phys.get());
		const auto* geom = dynamic_cast<const ScGeom*>(interaction->geom.get());
		if (!phys || !geom)
			throw std::runtime_error("CompactLoop: the contact of bodies " + std::to_string(interaction->getId1()) + " and " +
			                         std::to_string(interaction->getId2()) + " was made by another law (" + interaction->phys->getClassName() +
			                         "); fix: LinearMat and its law in the reference tier, or O.interactions.clear()");
		const unsigned char bits = hexmembrane::contactTouching | (phys->bonded ? hexmembrane::contactBonded : 0);
		found.push_back({interaction->getId1(), interaction->getId2(), {phys->memory(geom->normal), phys->law(), bits}});
	}
	return found;
}

// Positions and boundaries as they were when the forces of the last step were computed.
CompactLoop::Instant CompactLoop::lastInstant() const
{
	Instant then{state->spheres.places, stepShapes.empty() ? state->spheres.shapes() : stepShapes};
	for (int i = 0; i < state->spheres.spheres(); ++i) then.places[i].centre -= lastDt * state->spheres.motions[i].velocity;
	return then;
}

vector<Vector3r> CompactLoop::contactForces(const HexMembrane& membrane) const
{
	if (state->sheet.membrane != &membrane)
		throw std::runtime_error("CompactLoop: this membrane is not one that it steps; fix: MembraneBonds of this membrane in CompactLoop.engines");
	const Instant then = lastInstant();
	return withEngines(state->contactForces(then.places, then.shapes));
}

vector<Vector3r> CompactLoop::withEngines(vector<Vector3r> forces) const
{
	Stepped::forEachOf(engines, [&](const Stepped& one) { one.addContactForces(*state->sheet.ids, forces); });
	return forces;
}

void CompactLoop::forEachContact(const VisitContact& visit) const
{
	const Instant then = lastInstant();
	visitWithEngines(then.places, then.shapes, visit);
}

void CompactLoop::visitWithEngines(const vector<hexmembrane::Place>& places, const vector<std::shared_ptr<const hexmembrane::BoundaryShape>>& shapes,
                                   const VisitContact& visit) const
{
	Stepped::forEachContactWith(engines, [&](const VisitContact& one) { state->visitContacts(places, shapes, one); }, visit);
}

void CompactLoop::exportContacts()
{
	requireRun("exportContacts");
	auto& interactions = *scene->interactions;
	interactions.clear();
	const hexmembrane::SphereAssembly& spheres = state->spheres;
	const auto write = [&](Body::id_t a, Body::id_t b, const Contact& c, bool ofSpheres, const hexmembrane::BoundaryTouch& touch, Real r1, Real r2) {
		auto geom = boost::make_shared<ScGeom>();
		geom->normal = touch.normal;
		geom->contactPoint = touch.point;
		geom->penetrationDepth = touch.overlap;
		geom->refR1 = geom->radius1 = r1;
		geom->refR2 = geom->radius2 = r2;
		auto phys = boost::make_shared<LinearPhys>();
		phys->set(c.law, ofSpheres);
		phys->normalForce = c.law.kn * touch.overlap * touch.normal;
		phys->remember(c.memory);
		if (c.bonded()) phys->bond(c.law.tensileStrength, c.law.shearStrength);
		auto contact = boost::make_shared<Interaction>(a, b);
		contact->geom = geom;
		contact->phys = phys;
		contact->iterMadeReal = scene->iter;
		interactions.insert(contact);
	};
	const Instant then = lastInstant();
	const auto& places = then.places;
	state->forEachSpherePair(places, [&](int i, int j, const Contact& contact) {
		write(spheres.id[i], spheres.id[j], contact, true, CompactState::touchOf(places[i], places[j]), places[i].radius, places[j].radius);
	});
	for (size_t b = 0; b < spheres.boundaryContacts.size(); ++b)
		spheres.boundaryContacts[b].forEachTouching([&](int i, const Contact& contact) {
			write(state->boundaryIds[b], spheres.id[i], contact, false, then.shapes[b]->touch(places[i]), places[i].radius, places[i].radius);
		});
	exported = true;
}

int CompactLoop::contactCount() const
{
	requireRun("contactCount");
	int count = static_cast<int>(contactsSoFar().size());
	state->spheres.smooth.forEachTouching(lastInstant().places, [&](int, int, Real, Real, const Vector3r&) { ++count; });
	Stepped::forEachOf(engines, [&](const Stepped& one) { one.forEachContact([&](const TouchingContact&) { ++count; }); });
	return count;
}

Real CompactLoop::criticalTimeStep()
{
	requireRun("criticalTimeStep");
	hexmembrane::CriticalStep step(state->spheres);
	// row of a body, -1 where the next step refuses it; the map is made when it is first asked
	std::unordered_map<Body::id_t, int> rows;
	const auto rowOf = [&](Body::id_t body) {
		const auto& ids = state->spheres.id;
		if (rows.empty())
			for (size_t i = 0; i < ids.size(); ++i) rows[ids[i]] = static_cast<int>(i);
		const auto found = rows.find(body);
		return found == rows.end() ? -1 : found->second;
	};
	for (Stepped* one : stepped) {
		one->forEachBond([&](int first, int second, const Vector3r& branch, Real kn, Real ks) { step.addBond(first, second, branch, kn, ks); });
		one->forEachSupport([&](int particle, Body::id_t grain, const Vector3r& normal, Real kn) {
			if (const int row = rowOf(grain); row >= 0) step.addSupport(particle, row, normal, kn);
		});
		one->forEachJointSpring(
		        [&](Body::id_t first, Body::id_t second, const Vector3r& normal, const std::array<Real, 2>& arms, const JointStiffness& k) {
			        const int a = rowOf(first), b = rowOf(second);
			        if (a < 0 || b < 0) return;
			        step.addJoint(a, b, normal, arms[0], arms[1], {k.normal, k.shear, 0, k.bending, 0}, k.twisting);
		        });
	}
	if (state->sheet.ids)
		step.setSheet(state->sheet.stencil, [&](const hexmembrane::PaddedRings& displacement, hexmembrane::PaddedRings& sum) {
			for (const Stepped* one : stepped) one->addAnswer(displacement, sum);
		});
	return step.compute();
}

} // namespace yade
