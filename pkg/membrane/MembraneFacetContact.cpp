// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "MembraneFacetContact.hpp"

#include "ContactStiffness.hpp"

#include "base/GatherBodies.hpp"
#include "base/NamedFields.hpp"

namespace yade {

YADE_PLUGIN((MembraneFacetContact));

void MembraneFacetContact::requireMembrane(const string& who) const
{
	if (!membrane)
		throw std::runtime_error("MembraneFacetContact.membrane = None: no membrane to act on; fix: MembraneFacetContact(membrane=HexMembrane(...))");
	membrane->requireGenerated(who);
}

Real MembraneFacetContact::normalStiffness() const
{
	if (math::isnan(kn)) requireMembrane("MembraneFacetContact.normalStiffness");
	return contactStiffness(kn, membrane.get(), "MembraneFacetContact");
}

Real MembraneFacetContact::usedOffset() const
{
	if (!math::isnan(offset)) return offset;
	requireMembrane("MembraneFacetContact.usedOffset");
	return 0.25 * membrane->sphereRadius;
}

void MembraneFacetContact::prepare()
{
	requireMembrane("MembraneFacetContact");
	const Real stiffness = normalStiffness(), h = usedOffset();
	if (kernel && builtFor == membrane.get() && stiffness == builtStiffness && h == builtOffset) return;
	named("MembraneFacetContact", {}, [&] { kernel.reset(new hexmembrane::FacetContact(membrane->stencil(), membrane->sphereRadius, h, stiffness)); });
	builtStiffness = stiffness;
	builtOffset = h;
	builtFor = membrane.get();
	torn = -1;
}

void MembraneFacetContact::compute(StepView& view)
{
	const hexmembrane::PaddedRings& x = view.positions(*membrane);
	named("MembraneFacetContact", {{"points", "grains"}, {"low", "grains"}, {"high", "grains"}},
	      [&] { kernel->compute(x, [&] { return view.grains(*membrane); }, view.travel()); });
}

// Triangles beside a broken bond carry nothing any more. What they stored is set free as that of the bond is.
void MembraneFacetContact::tear(StepView& view)
{
	const int broken = bonds ? bonds->brokenCount() : 0;
	if (broken == torn) return;
	const bool known = torn >= 0; // else a saved state goes on: what its breaks set free has been entered
	torn = broken;
	if (!known && broken == 0) return;
	compute(view);
	const Real before = kernel->energy();
	named("MembraneFacetContact", {{"broken", "bonds"}}, [&] { kernel->setBroken(bonds ? bonds->broken : vector<int>()); });
	compute(view);
	if (known) freed += before - kernel->energy();
}

void MembraneFacetContact::action() { stepOverBodies(*this); }

void MembraneFacetContact::step(StepView& view)
{
	tear(view);
	compute(view);
	if (kernel->touching().empty()) return;
	view.addForces(*membrane, {{kernel->firstRing(), kernel->lastRing()}}, kernel->force, nullptr, nullptr);
	for (const Contact& contact : kernel->touching()) view.addForce(contact.grain, forceOf(contact));
}

void MembraneFacetContact::bookStored()
{
	if (scene->trackEnergy) {
		scene->energy->add(kernel->energy(), "elastFacet", energyIndex, /*reset*/ true);
		if (freed != 0) scene->energy->add(freed, "bondDissip", freedIndex);
	}
	freed = 0;
}

void MembraneFacetContact::forEachContact(const VisitContact& visit) const
{
	if (!kernel) return;
	for (const Contact& contact : kernel->touching())
		for (int c = 0; c < 3; ++c) {
			const Real share = contact.shares[c];
			if (share == 0) continue;
			visit({membrane->ids[contact.corners[c]], contact.id, contact.places[c], contact.centre, contact.point, share * forceOf(contact),
			       share * builtStiffness * contact.overlap, 0});
		}
}

// Springs of a share of the stiffness between the grain and each corner are stiffer than the contact, whose corners give way together.
void MembraneFacetContact::forEachSupport(const VisitSupport& visit) const
{
	if (!kernel) return;
	for (const Contact& contact : kernel->touching())
		for (int c = 0; c < 3; ++c)
			if (contact.shares[c] > 0)
				visit(contact.corners[c], contact.id, contact.normal, contact.shares[c] * contact.stiffness * builtStiffness);
}

const hexmembrane::FacetContact& MembraneFacetContact::computed(const char* what) const
{
	if (!kernel) throw std::runtime_error(string("MembraneFacetContact.") + what + ": nothing computed yet; fix: run a step first");
	return *kernel;
}

vector<Body::id_t> MembraneFacetContact::grains() const
{
	vector<Body::id_t> all;
	for (const Contact& contact : computed("grains").touching()) all.push_back(contact.id);
	return all;
}

vector<Vector3i> MembraneFacetContact::triangles() const
{
	vector<Vector3i> all;
	for (const Contact& contact : computed("triangles").touching()) all.emplace_back(contact.corners[0], contact.corners[1], contact.corners[2]);
	return all;
}

vector<Real> MembraneFacetContact::overlaps() const
{
	vector<Real> all;
	for (const Contact& contact : computed("overlaps").touching()) all.push_back(contact.overlap);
	return all;
}

Real MembraneFacetContact::elasticEnergy() const { return computed("elasticEnergy").energy(); }

Real MembraneFacetContact::criticalTimeStep() const
{
	const string who = "MembraneFacetContact.criticalTimeStep";
	requireMembrane(who);
	if (!kernel || kernel->touching().empty()) return std::numeric_limits<Real>::infinity();
	const Scene& scene = currentScene();
	Real perMass = kernel->largestShare() / membrane->body(scene, 0, who)->state->mass;
	Real ofGrain = 0; // sum over its contacts, which stand together
	Body::id_t last = -1;
	for (const Contact& contact : kernel->touching()) {
		ofGrain = (contact.id == last ? ofGrain : 0) + contact.stiffness;
		last = contact.id;
		if (const Body* grain = livingBody(*scene.bodies, contact.id)) perMass = std::max(perMass, ofGrain / grain->state->mass);
	}
	return 2 / math::sqrt(2 * builtStiffness * perMass);
}

} // namespace yade
