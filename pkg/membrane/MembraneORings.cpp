// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "MembraneORings.hpp"

#include "base/GatherBodies.hpp"
#include "kernels/base/Check.hpp"

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

void MembraneORings::prepare()
{
	if (!membrane) throw std::runtime_error("MembraneORings.membrane = None: no membrane to act on; fix: MembraneORings(membrane=HexMembrane(...))");
	membrane->requireGenerated("MembraneORings");
	hexmembrane::requireOneOf(hexmembrane::shared::o_ring_mode, "MembraneORings.mode", mode);
	if (mode == "fixed") return;
	platen(bottomPlaten, "bottomPlaten");
	platen(topPlaten, "topPlaten");
}

void MembraneORings::action() { stepOverBodies(*this); }

void MembraneORings::step(StepView& view)
{
	const bool ride = mode == "platens";
	const Vector3r below = ride ? platen(bottomPlaten, "bottomPlaten").state->vel : Vector3r::Zero();
	const Vector3r above = ride ? platen(topPlaten, "topPlaten").state->vel : Vector3r::Zero();
	vector<std::pair<int, Vector3r>> rings;
	for (int row = 0; row < membrane->oRingRows; ++row) {
		rings.emplace_back(row, below);
		rings.emplace_back(membrane->rings - 1 - row, above);
	}
	view.grip(*membrane, rings, *meter);
}

void MembraneORings::bookWorks() { meter->book(*scene, "oRingWork"); }

} // namespace yade
