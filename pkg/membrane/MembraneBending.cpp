// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "MembraneBending.hpp"

#include "base/NamedFields.hpp"
#include "kernels/membrane/MembraneTension.hpp"

namespace yade {

YADE_PLUGIN((MembraneBending));

void MembraneBending::requireMembrane(const string& who) const
{
	if (!membrane) throw std::runtime_error("MembraneBending.membrane = None: no membrane to act on; fix: MembraneBending(membrane=HexMembrane(...))");
	membrane->requireGenerated(who);
}

Real MembraneBending::springStiffness() const
{
	requireMembrane("MembraneBending.springStiffness");
	return named("MembraneBending", {}, [&] { return hexmembrane::bendingSpring(stiffness, 2 * membrane->sphereRadius); });
}

void MembraneBending::prepare()
{
	requireMembrane("MembraneBending");
	const Real wanted = springStiffness();
	if (kernel && builtFor == membrane.get() && wanted == built) return;
	const auto rest = hexmembrane::BendingForce::restOfTube(membrane->perRing, membrane->centreRadius);
	named("MembraneBending", {{"rings", "membrane"}}, [&] { kernel.reset(new hexmembrane::BendingForce(membrane->stencil(), wanted, rest)); });
	built = wanted;
	builtFor = membrane.get();
	torn = -1;
}

// A particle that has lost a bond bends nothing any more. What it stored is set free as that of the bond is.
void MembraneBending::tear(StepView& view)
{
	const int broken = bonds ? bonds->brokenCount() : 0;
	if (broken == torn) return;
	const bool known = torn >= 0; // else a saved state goes on: what its breaks set free has been entered
	torn = broken;
	if (broken == 0) return;
	const auto pairs = hexmembrane::bondList(membrane->stencil());
	vector<char> at(membrane->ids.size(), 0);
	for (size_t b = 0; b < bonds->broken.size(); ++b)
		if (bonds->broken[b]) at[pairs[b][0]] = at[pairs[b][1]] = 1;
	kernel->compute(view.positions(*membrane));
	const Real before = kernel->energy();
	kernel->setTorn(at);
	kernel->compute(view.positions(*membrane));
	if (known) freed += before - kernel->energy();
}

void MembraneBending::action() { stepOverBodies(*this); }

void MembraneBending::step(StepView& view)
{
	tear(view);
	kernel->compute(view.positions(*membrane));
	view.addForces(*membrane, {{0, membrane->rings - 1}}, kernel->force, nullptr, nullptr);
}

void MembraneBending::bookStored()
{
	if (scene->trackEnergy) {
		scene->energy->add(kernel->energy(), "elastBending", energyIndex, /*reset*/ true);
		if (freed != 0) scene->energy->add(freed, "bondDissip", freedIndex);
	}
	freed = 0;
}

void MembraneBending::addAnswer(const hexmembrane::PaddedRings& displacement, hexmembrane::PaddedRings& sum) const { kernel->addAnswer(displacement, sum); }

void MembraneBending::requireStepped(const char* what) const
{
	if (!kernel) throw std::runtime_error(string("MembraneBending.") + what + ": nothing computed yet; fix: run a step first");
}

Real MembraneBending::elasticEnergy() const
{
	requireStepped("elasticEnergy");
	return kernel->energy();
}

vector<Real> MembraneBending::axialTension(const vector<Real>& heights) const
{
	requireStepped("axialTension");
	for (Real z : heights) hexmembrane::requireFinite("MembraneBending.axialTension: heights", z, "m");
	return hexmembrane::axialPull(membrane->positions_get(), kernel->force.vectors(), heights);
}

Real MembraneBending::radialShare(int group) const
{
	requireStepped("radialShare");
	return membrane->groupPressure(group, membrane->positions_get(), kernel->force.vectors(), "MembraneBending.radialShare");
}

Real MembraneBending::criticalTimeStep() const
{
	const string who = "MembraneBending.criticalTimeStep";
	requireMembrane(who);
	const Real mass = membrane->body(*Omega::instance().getScene(), 0, who)->state->mass;
	return hexmembrane::criticalStepOfBending(springStiffness(), mass);
}

} // namespace yade
