// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/boundary/CylinderContact.hpp"

#include <core/Dispatching.hpp>
#include <core/Shape.hpp>
#include <pkg/common/Sphere.hpp>
#include <pkg/dem/ScGeom.hpp>

namespace yade {

/*! The inside of an upright cylinder as one body: the rigid wall of the comparison test. */
class CylinderWall : public Shape {
public:
	virtual ~CylinderWall() = default;

	//! \throws std::invalid_argument unless both sizes were given and are positive
	void requireComplete() const;
	//! What spheres meet, whose centres are beside the wall; one beyond an end has a gap of its radius.
	hexmembrane::CylinderBoundary boundary(const State& state) const;

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS_CTOR(CylinderWall,Shape,
		"Rigid lateral wall: the inside of an upright cylinder as one body with exact contact to spheres (nothing is tessellated). "
		"Body position is the centre of the axis; the axis is vertical whatever the body's orientation. "
		"It has no thickness, no ends, and no outside: a sphere whose centre is above or below it meets nothing.\n\n"
		"Contacts need Bo1_CylinderWall_Aabb and Ig2_CylinderWall_Sphere_ScGeom; RadialWallServo moves the radius. The body itself does not move: "
		"give it ``dynamic=False``.\n\n"
		".. code-block:: python\n\n"
		"\twall=Body()\n\twall.shape=CylinderWall(radius=.02,height=.1); wall.state.pos=(0,0,.04); wall.material=O.materials[0]; "
		"wall.dynamic=False\n\tO.bodies.append(wall)\n\n"
		"A missing size (NaN) is an error in the first step.",
		((Real,radius,NaN,,"Radius of the inside [m], > 0, required."))
		((Real,height,NaN,,"Height of the wall [m], > 0, required."))
		,
		createIndex(); /*ctor*/
	);
	// clang-format on
	REGISTER_CLASS_INDEX(CylinderWall, Shape);
};
REGISTER_SERIALIZABLE(CylinderWall);

class Bo1_CylinderWall_Aabb : public BoundFunctor {
public:
	void go(const shared_ptr<Shape>& shape, shared_ptr<Bound>& bound, const Se3r& se3, const Body* body) override;
	FUNCTOR1D(CylinderWall);
	// clang-format off
	YADE_CLASS_BASE_DOC(Bo1_CylinderWall_Aabb,BoundFunctor,"Makes the Aabb of a CylinderWall: the box round the whole cylinder, "
		"so that every sphere inside is a possible contact (a test of 20 ns each and step).");
	// clang-format on
};
REGISTER_SERIALIZABLE(Bo1_CylinderWall_Aabb);

class Ig2_CylinderWall_Sphere_ScGeom : public IGeomFunctor {
public:
	bool go(const shared_ptr<Shape>& wall, const shared_ptr<Shape>& sphere, const State& wallState, const State& sphereState, const Vector3r& shift2,
	        const bool& force, const shared_ptr<Interaction>& contact) override;
	bool goReverse(const shared_ptr<Shape>& sphere, const shared_ptr<Shape>& wall, const State& sphereState, const State& wallState, const Vector3r& shift2,
	               const bool& force, const shared_ptr<Interaction>& contact) override;

	// clang-format off
	YADE_CLASS_BASE_DOC(Ig2_CylinderWall_Sphere_ScGeom,IGeomFunctor,
		"Makes the ScGeom of a CylinderWall and a Sphere, in this order: the normal points from the wall to the sphere, towards the axis. "
		"Both reference radii are the sphere's, as with Box. The shear increment is the sphere's true velocity at the contact point; "
		"a change of the wall's radius is along the normal and does not enter it.");
	// clang-format on
	FUNCTOR2D(CylinderWall, Sphere);
	DEFINE_FUNCTOR_ORDER_2D(CylinderWall, Sphere);
};
REGISTER_SERIALIZABLE(Ig2_CylinderWall_Sphere_ScGeom);

} // namespace yade
