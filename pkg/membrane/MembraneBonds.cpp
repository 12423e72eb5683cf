// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "MembraneBonds.hpp"

#include "base/GatherBodies.hpp"
#include "base/NamedFields.hpp"
#include "kernels/membrane/LatticeConstants.hpp"
#include "kernels/membrane/MembraneTension.hpp"

#include <pkg/common/Collider.hpp>

namespace yade {

YADE_PLUGIN((MembraneBonds));

namespace {

bool same(const hexmembrane::BondLaw& a, const hexmembrane::BondLaw& b)
{
	return a.kn == b.kn && a.ks == b.ks && a.tensileStrength == b.tensileStrength && a.shearStrength == b.shearStrength && a.friction == b.friction &&
	       a.tensionOnly == b.tensionOnly;
}

} // namespace

hexmembrane::BondLaw MembraneBonds::law() const
{
	hexmembrane::BondLaw l{kn, math::isnan(ks) ? 0. : ks, tensileStrength, shearStrength, friction, tensionOnly};
	const bool sheet = !math::isnan(young) || !math::isnan(thickness) || !math::isnan(poisson);
	if (sheet && !(math::isnan(kn) && math::isnan(ks)))
		hexmembrane::reject("MembraneBonds.kn", kn, "stiffness is given twice, as springs and as a sheet",
		                    "either kn and ks, or young, thickness and poisson");
	if (sheet) {
		hexmembrane::requirePositive("MembraneBonds.young", young, "Pa");
		hexmembrane::requirePositive("MembraneBonds.thickness", thickness, "m");
		const auto springs = named("MembraneBonds", {{"stretch", "young * thickness"}},
		                           [this] { return hexmembrane::bondsFromSheet({young * thickness, poisson}); });
		l.kn = springs.normal;
		l.ks = springs.shear;
	}
	named("MembraneBonds", {}, [&] { l.check(); });
	return l;
}

void MembraneBonds::prepare()
{
	if (!membrane) throw std::runtime_error("MembraneBonds.membrane = None: no membrane to act on; fix: MembraneBonds(membrane=HexMembrane(...))");
	membrane->requireGenerated("MembraneBonds");
	const hexmembrane::BondLaw wanted = law();
	if (kernel && builtFor == membrane.get() && same(wanted, built)) return;
	if (wanted.ks > 0 && !membrane->rotations)
		hexmembrane::reject("MembraneBonds.ks", wanted.ks, "shear needs particles that rotate, the membrane was made without",
		                    "HexMembrane(rotations=True), or ks = 0 (poisson = 1/3)");
	const size_t bonds = membrane->stencil().bondCount();
	if ((!broken.empty() && broken.size() != bonds) || (!shearForces.empty() && shearForces.size() != bonds))
		throw std::runtime_error("MembraneBonds: the stored state of " + std::to_string(std::max(broken.size(), shearForces.size())) +
		                         " bonds does not fit a membrane of " + std::to_string(bonds) + "; fix: a new MembraneBonds for another membrane");
	for (int one : broken)
		if (one != 0 && one != 1)
			hexmembrane::reject("MembraneBonds.broken", one, "is neither whole nor broken", "0 or 1 for each of HexMembrane.bonds");
	kernel.reset(new hexmembrane::BondForce(membrane->stencil(), wanted));
	restLength.assign(bonds, 2 * membrane->sphereRadius);
	built = wanted;
	builtFor = membrane.get();
}

void MembraneBonds::requireReferenceScene() const
{
	const int mask = membrane->body(*scene, 0, "MembraneBonds")->groupMask;
	for (const auto& engine : scene->engines) {
		const auto* collider = dynamic_cast<const Collider*>(engine.get());
		if (collider && !(collider->avoidSelfInteractionMask & mask))
			throw std::runtime_error("MembraneBonds: the collider lets the membrane's bonded spheres collide with each other; fix: "
			                         "Collider.avoidSelfInteractionMask with a bit of HexMembrane.mask = " +
			                         std::to_string(mask) + ", one that no other body has");
	}
}

Sheet MembraneBonds::sheet()
{
	const bool turning = built.ks > 0;
	return {membrane.get(),
	        &membrane->ids,
	        membrane->stencil(),
	        &kernel->position,
	        turning ? &kernel->velocity : nullptr,
	        turning ? &kernel->spin : nullptr};
}

void MembraneBonds::forEachBond(const VisitBond& visit) const
{
	const auto tube = membrane->stencil();
	const auto at = [&](int v) { return kernel->position.get(v / tube.perRing, v % tube.perRing); };
	for (const auto& pair : hexmembrane::bondList(tube)) visit(pair[0], pair[1], at(pair[1]) - at(pair[0]), built.kn, built.ks);
}

void MembraneBonds::step(StepView& view)
{
	view.refresh(sheet());
	kernel->compute(state(), scene->dt);
	stepped = view.leavesInstant() ? kernel->position : hexmembrane::PaddedRings();
	view.addForces(*membrane, {{0, membrane->rings - 1}}, kernel->force, built.ks > 0 ? &kernel->torque : nullptr, nullptr);
}

void MembraneBonds::action() { stepOverBodies(*this); }

void MembraneBonds::bookStored()
{
	if (scene->trackEnergy) scene->energy->add(elasticEnergy(), "elastMembrane", energyIndex, /*reset*/ true);
}

namespace {

// While it lives the bonds' kernel has the positions that the last step's forces belong to: in the compact tier the particles have moved on since.
class AtLastStep {
public:
	AtLastStep(hexmembrane::PaddedRings& present, hexmembrane::PaddedRings& stepped) : now(present), then(stepped), moved(stepped.rows() > 0) { swap(); }
	~AtLastStep() { swap(); }
	AtLastStep(const AtLastStep&) = delete;
	AtLastStep& operator=(const AtLastStep&) = delete;

private:
	void swap()
	{
		if (moved) std::swap(now, then);
	}
	hexmembrane::PaddedRings &now, &then;
	const bool moved;
};

} // namespace

void MembraneBonds::requireStepped(const char* what) const
{
	if (!kernel) throw std::runtime_error(string("MembraneBonds.") + what + ": nothing computed yet; fix: run a step first");
}

Real MembraneBonds::elasticEnergy()
{
	requireStepped("elasticEnergy");
	const AtLastStep then(kernel->position, stepped);
	return kernel->energy(state());
}

vector<Real> MembraneBonds::normalForces()
{
	requireStepped("normalForces");
	const AtLastStep then(kernel->position, stepped);
	vector<Real> forces(membrane->stencil().bondCount());
	for (size_t b = 0; b < forces.size(); ++b) forces[b] = kernel->normalForce(state(), static_cast<int>(b));
	return forces;
}

vector<Real> MembraneBonds::axialTension(const vector<Real>& heights)
{
	requireStepped("axialTension");
	for (Real z : heights) hexmembrane::requireFinite("MembraneBonds.axialTension: heights", z, "m");
	const AtLastStep then(kernel->position, stepped);
	const auto onFirst = hexmembrane::bondForces(*kernel, state());
	return hexmembrane::axialTension(membrane->stencil(), kernel->position.vectors(), onFirst, heights);
}

Real MembraneBonds::radialShare(int group)
{
	requireStepped("radialShare");
	const AtLastStep then(kernel->position, stepped);
	return membrane->groupPressure(group, kernel->position.vectors(), kernel->force.vectors(), "MembraneBonds.radialShare");
}

Real MembraneBonds::criticalTimeStep() const
{
	const auto l = law();
	if (!membrane) throw std::runtime_error("MembraneBonds.membrane = None: no membrane to act on; fix: MembraneBonds(membrane=HexMembrane(...))");
	membrane->requireGenerated("MembraneBonds.criticalTimeStep");
	const Real mass = membrane->body(*Omega::instance().getScene(), 0, "MembraneBonds.criticalTimeStep")->state->mass;
	return named("MembraneBonds", {}, [&] { return hexmembrane::criticalStepOfBonds({l.kn, l.ks}, mass); });
}

int MembraneBonds::brokenCount() const { return static_cast<int>(std::count(broken.begin(), broken.end(), 1)); }

} // namespace yade
