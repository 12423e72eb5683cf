// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/compact/MembraneMotion.hpp"

#include <core/Scene.hpp>
#include <functional>
#include <lib/serialization/Serializable.hpp>

namespace yade {

/*! Work of forces on a membrane by the trapezoidal rule in force and displacement, in either tier. Steps in which the engine did not act are nobody's work. */
class WorkMeter : public Serializable {
public:
	//! The compact tier's way: the halves of a step's work before and after its positions.
	void add(long iter, const hexmembrane::MembraneMotion::HalfWorks& halves);
	//! Where the last step was one of the reference tier: the half of its work that led on to these positions, of the points in its order.
	void takeOver(long iter, const std::function<Vector3r(size_t)>& position);
	//! Where the last step was one of the compact tier: the half of this step's work that led here, the points having come these ways (m).
	void takeOver(long iter, const vector<Vector3r>& forces, const std::function<Vector3r(size_t)>& way);
	//! The reference tier's way: forces on points at their positions of this step; both are taken over. `atOnce` is work that is done in this step alone (J).
	void add(long iter, vector<Vector3r>& forces, vector<Vector3r>& positions, Real atOnce = 0);
	//! Enters minus the work under this name: energy that comes in counts negative, as YADE has it with gravity.
	void book(Scene& scene, const char* name);

private:
	int energyIndex = -1;

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS(WorkMeter,Serializable,
		"Work of an engine's forces on a membrane, summed by the trapezoidal rule (F(n) + F(n+1)) (x(n+1) - x(n))/2. "
		"Part of MembranePressure, MembraneRadialServo and MembraneORings.",
		((Real,work,0,Attr::readonly,"Work so far [J], up to the positions of the last step."))
		((Real,ahead,0,(Attr::readonly|Attr::hidden),"Compact tier: half work of the way that led on from the last step's positions [J]."))
		((long,lastIter,-2,(Attr::readonly|Attr::hidden),"Last step that was counted."))
		((vector<Vector3r>,lastForces,,(Attr::readonly|Attr::hidden),"Reference tier: forces of the last step."))
		((vector<Vector3r>,lastPositions,,(Attr::readonly|Attr::hidden),"Reference tier: positions of the last step."))
	);
	// clang-format on
};
REGISTER_SERIALIZABLE(WorkMeter);

} // namespace yade
