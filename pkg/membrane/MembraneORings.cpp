// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "MembraneORings.hpp"

#include "GatherBodies.hpp"
#include "kernels/base/Check.hpp"
#include "kernels/base/TrapezoidalWork.hpp"

#include <pkg/dem/NewtonIntegrator.hpp>

namespace yade {

YADE_PLUGIN((MembraneORings));

const Body& MembraneORings::platen(Body::id_t id, const char* name) const
{
	const Body* b = livingBody(*scene->bodies, id);
	if (!b)
		throw std::runtime_error(string("MembraneORings.") + name + " = " + std::to_string(id) +
		                         ": there is no such body; fix: give the platen's id, or mode='fixed'");
	return *b;
}

void MembraneORings::requireOrder() const
{
	bool integrated = false;
	for (const auto& engine : scene->engines) {
		if (dynamic_cast<const NewtonIntegrator*>(engine.get())) integrated = true;
		if (engine.get() == this && integrated)
			throw std::runtime_error(
			        "MembraneORings: it comes after NewtonIntegrator in O.engines; fix: put it before, after the engines that add forces");
	}
}

std::pair<Vector3r, Vector3r> MembraneORings::velocities() const
{
	if (!membrane) throw std::runtime_error("MembraneORings.membrane = None: no membrane to act on; fix: MembraneORings(membrane=HexMembrane(...))");
	membrane->requireGenerated("MembraneORings");
	if (mode != "fixed" && mode != "platens") hexmembrane::reject("MembraneORings.mode", "'" + mode + "'", "unknown", "'fixed' or 'platens'");
	if (mode == "fixed") return {Vector3r::Zero(), Vector3r::Zero()};
	return {platen(bottomPlaten, "bottomPlaten").state->vel, platen(topPlaten, "topPlaten").state->vel};
}

void MembraneORings::grip(int k, const Vector3r& velocity, vector<Vector3r>& held, vector<Vector3r>& at)
{
	for (int i = k * membrane->perRing; i < (k + 1) * membrane->perRing; ++i) {
		State& state = *membrane->body(*scene, i, "MembraneORings")->state;
		work += 0.5 * state.mass * (velocity.squaredNorm() - state.vel.squaredNorm());
		state.vel = velocity;
		state.isDamped = false;
		held.push_back(-scene->forces.getForce(membrane->ids[i]));
		at.push_back(state.pos);
	}
}

void MembraneORings::bookWork(vector<Vector3r>& held, vector<Vector3r>& at)
{
	work += hexmembrane::WorkMeter{lastIter, lastForces, lastPositions}.record(scene->iter, held, at);
	bookEnergy();
}

void MembraneORings::bookEnergy()
{
	if (scene->trackEnergy) scene->energy->add(-work, "oRingWork", energyIndex, /*reset*/ true);
}

void MembraneORings::action()
{
	const auto [below, above] = velocities();
	requireOrder();
	scene->forces.sync();
	vector<Vector3r> held, at;
	for (int row = 0; row < membrane->oRingRows; ++row) {
		grip(row, below, held, at);
		grip(membrane->rings - 1 - row, above, held, at);
	}
	bookWork(held, at);
}

} // namespace yade
