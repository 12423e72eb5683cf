// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <core/Body.hpp>
#include <core/Scene.hpp>
#include <core/State.hpp>

namespace yade {

/*! What the compact tier does with an attribute that a script may change between iterations. */
struct ReadingRow {
	string of, attribute, treatment, what;
};

//! The reading contract: every attribute of scene, body, state, shape and material that acts on a step in the reference tier is
//! 'read' each iteration, or 'watched' (a change makes the tier collect anew), or 'refused' with the body's id and a fix.
const vector<ReadingRow>& readingContract();

/*! What is watched of a body. A body that differs from what was collected makes the tier collect anew, which refuses what it cannot do. */
struct BodyMark {
	shared_ptr<Shape> shape; //!< held: its address is not used again while it is watched
	shared_ptr<Material> material;
	Real radius = 0, mass = 0; //!< radius 0: no sphere
	Vector3r inertia = Vector3r::Zero();
	unsigned blocked = 0;
	int flags = 0, mask = 0, clump = 0;
	bool damped = true;

	BodyMark() = default;
	explicit BodyMark(const Body& body);
	bool holds(const Body& body) const;
};

//! Refuses a scene, or engines beside the compact loop `self`, that it cannot do.
void requireCompactScene(const Scene& scene, const Engine& self, const vector<shared_ptr<Engine>>& stepped);

[[noreturn]] void refuseBody(Body::id_t id, const string& wrong, const string& fix);

} // namespace yade
