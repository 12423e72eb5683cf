// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <core/Body.hpp>
#include <core/Interaction.hpp>
#include <core/Scene.hpp>
#include <pkg/common/PeriodicEngines.hpp>

namespace yade {

class MemoryOrder : public PeriodicEngine {
public:
	void action() override;

private:
	vector<shared_ptr<Body>> spheresInSpace() const;
	vector<shared_ptr<Interaction>> interactionsInSpace(const vector<shared_ptr<Body>>& spheres) const;
	void replaceBodies(const vector<shared_ptr<Body>>& spheres, const vector<shared_ptr<Body>>& anew) const;
	void replaceInteraction(shared_ptr<Interaction>& interaction, const shared_ptr<Interaction>& anew) const;

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS_CTOR(MemoryOrder,PeriodicEngine,
		"Restores the order of memory for the reference tier: every iterPeriod steps it allocates spheres (Body, State, Shape, "
		"Bound) and interactions (with geometry and physics) anew, in an order of space, and sorts the list of interactions in that order. "
		"YADE's loops walk over these objects; after some thousand steps neighbours in the specimen lie anywhere in the heap, "
		"and every step waits for memory. CompactLoop needs none of it.\n\n"
		"Nothing else is changed: ids, states, histories, bonds are kept to the last bit. "
		"What a run adds up goes on in another order of its sums, so results differ from those without this engine by rounding; "
		"with it they repeat to the last bit on one thread. (YADE itself does not repeat, after a load, "
		"the order in which its collider finds new contacts; with ``iterPeriod=1``, a cure for tests, a loaded run is exact.)\n\n"
		"Left where they are: bodies of other shapes than Sphere, members of clumps, "
		"interactions with bodies of shapes that hold other bodies (GridConnection, PFacet), "
		"and whatever a script or an engine holds (``s=O.bodies[7].state`` remains the state of body 7).\n\n"
		"Place: first in ``O.engines``, after ForceResetter. Takes about 12 microseconds an object, "
		"of which a step of the specimen has three to eight a grain; every five thousand steps keeps that below some percent. Source of the measure: "
		"``scripts/bench order``.\n\n"
		"Example::\n\n\tO.engines=[ForceResetter(),MemoryOrder(iterPeriod=5000),InsertionSortCollider(...),...]",
		((long,moved,0,Attr::readonly,"Bodies and interactions that were allocated anew the last time."))
		,/*ctor*/ iterPeriod=5000;
	);
	// clang-format on
};
REGISTER_SERIALIZABLE(MemoryOrder);

} // namespace yade
