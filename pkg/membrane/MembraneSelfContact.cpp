// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "MembraneSelfContact.hpp"

#include "ContactStiffness.hpp"

#include "base/NamedFields.hpp"
#include "kernels/membrane/MembraneTension.hpp"

namespace yade {

YADE_PLUGIN((MembraneSelfContact));

void MembraneSelfContact::requireMembrane(const string& who) const
{
	if (!membrane)
		throw std::runtime_error("MembraneSelfContact.membrane = None: no membrane to act on; fix: MembraneSelfContact(membrane=HexMembrane(...))");
	membrane->requireGenerated(who);
}

Real MembraneSelfContact::normalStiffness() const
{
	if (math::isnan(kn)) requireMembrane("MembraneSelfContact.normalStiffness");
	return contactStiffness(kn, membrane.get(), "MembraneSelfContact");
}

void MembraneSelfContact::prepare()
{
	requireMembrane("MembraneSelfContact");
	const Real wanted = normalStiffness();
	if (kernel && builtFor == membrane.get() && wanted == built) return;
	kernel.reset(new hexmembrane::SelfContact(membrane->stencil(), membrane->sphereRadius, wanted));
	built = wanted;
	builtFor = membrane.get();
}

void MembraneSelfContact::action() { stepOverBodies(*this); }

void MembraneSelfContact::step(StepView& view)
{
	const hexmembrane::PaddedRings& x = view.positions(*membrane);
	named("MembraneSelfContact", {{"centres", "membrane.positions"}, {"points", "membrane.positions"}}, [&] { kernel->compute(x); });
	if (kernel->firstRing() <= kernel->lastRing()) view.addForces(*membrane, {{kernel->firstRing(), kernel->lastRing()}}, kernel->force, nullptr, nullptr);
}

void MembraneSelfContact::bookStored()
{
	if (scene->trackEnergy) scene->energy->add(kernel->energy(), "elastSelfContact", energyIndex, /*reset*/ true);
}

void MembraneSelfContact::forEachBond(const VisitBond& visit) const
{
	for (const auto& pair : kernel->touching()) visit(pair.i, pair.j, pair.branch, built, 0);
}

const hexmembrane::SelfContact& MembraneSelfContact::computed(const char* what) const
{
	if (!kernel) throw std::runtime_error(string("MembraneSelfContact.") + what + ": nothing computed yet; fix: run a step first");
	return *kernel;
}

vector<Vector2i> MembraneSelfContact::pairs() const
{
	vector<Vector2i> all;
	for (const auto& pair : computed("pairs").touching()) all.emplace_back(pair.i, pair.j);
	return all;
}

Real MembraneSelfContact::elasticEnergy() const { return computed("elasticEnergy").energy(); }

vector<Real> MembraneSelfContact::axialTension(const vector<Real>& heights) const
{
	const auto& force = computed("axialTension").force;
	for (Real z : heights) hexmembrane::requireFinite("MembraneSelfContact.axialTension: heights", z, "m");
	return hexmembrane::axialPull(membrane->positions_get(), force.vectors(), heights);
}

Real MembraneSelfContact::radialShare(int group) const
{
	const auto& force = computed("radialShare").force;
	return membrane->groupPressure(group, membrane->positions_get(), force.vectors(), "MembraneSelfContact.radialShare");
}

Real MembraneSelfContact::criticalTimeStep() const
{
	const string who = "MembraneSelfContact.criticalTimeStep";
	requireMembrane(who);
	const int most = kernel ? kernel->mostOfOne() : 0;
	if (most == 0) return std::numeric_limits<Real>::infinity();
	return 2 * math::sqrt(membrane->body(*Omega::instance().getScene(), 0, who)->state->mass / (2 * most * built));
}

} // namespace yade
