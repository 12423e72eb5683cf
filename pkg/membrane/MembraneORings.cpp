// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "MembraneORings.hpp"

#include "Scatter.hpp"
#include "kernels/Check.hpp"

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

std::pair<Vector3r, Vector3r> MembraneORings::velocities() const
{
	if (!membrane) throw std::runtime_error("MembraneORings.membrane = None: no membrane to act on; fix: MembraneORings(membrane=HexMembrane(...))");
	membrane->requireGenerated("MembraneORings");
	if (mode != "fixed" && mode != "platens") hexmembrane::reject("MembraneORings.mode", "'" + mode + "'", "unknown", "'fixed' or 'platens'");
	if (mode == "fixed") return {Vector3r::Zero(), Vector3r::Zero()};
	return {platen(bottomPlaten, "bottomPlaten").state->vel, platen(topPlaten, "topPlaten").state->vel};
}

void MembraneORings::action()
{
	const auto [below, above] = velocities();
	const int n = membrane->perRing;
	for (int row = 0; row < membrane->oRingRows; ++row)
		for (int i = 0; i < n; ++i) {
			membrane->body(*scene, row * n + i, "MembraneORings")->state->vel = below;
			membrane->body(*scene, (membrane->rings - 1 - row) * n + i, "MembraneORings")->state->vel = above;
		}
}

} // namespace yade
