// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <pkg/dem/Ig2_Sphere_Sphere_ScGeom.hpp>

namespace yade {

class Ig2_Sphere_Sphere_LinearScGeom : public Ig2_Sphere_Sphere_ScGeom {
public:
	bool go(const shared_ptr<Shape>& sphere1, const shared_ptr<Shape>& sphere2, const State& state1, const State& state2, const Vector3r& shift2,
	        const bool& force, const shared_ptr<Interaction>& contact) override;
	bool goReverse(const shared_ptr<Shape>& sphere1, const shared_ptr<Shape>& sphere2, const State& state1, const State& state2, const Vector3r& shift2,
	               const bool& force, const shared_ptr<Interaction>& contact) override;

	// clang-format off
	YADE_CLASS_BASE_DOC(Ig2_Sphere_Sphere_LinearScGeom,Ig2_Sphere_Sphere_ScGeom,
		"The ScGeom of two spheres, the same to the last bit as Ig2_Sphere_Sphere_ScGeom's but made with less work, for contacts of LinearPhys: "
		"a contact that carries nothing but a normal force (no friction, rolling resistance or bond) gets normal, overlap, "
		"contact point and radii only; its shearInc is zero. Attributes are those of the base class.");
	// clang-format on
	FUNCTOR2D(Sphere, Sphere);
	DEFINE_FUNCTOR_ORDER_2D(Sphere, Sphere);
};
REGISTER_SERIALIZABLE(Ig2_Sphere_Sphere_LinearScGeom);

} // namespace yade
