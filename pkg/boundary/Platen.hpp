// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <core/Dispatching.hpp>
#include <core/Shape.hpp>
#include "kernels/boundary/PlatenContact.hpp"
#include <pkg/common/Sphere.hpp>
#include <pkg/dem/ScGeom.hpp>

namespace yade {

class Platen : public Shape {
public:
	virtual ~Platen() = default;

	/// Where the cylinder is when its body stands at `se3`.
	hexmembrane::SolidCylinder solid(const Se3r& se3) const;
	/// \throws std::invalid_argument unless both sizes were given and are positive
	void requireComplete() const;
	void postLoad(Platen&);

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS_CTOR(Platen,Shape,"Loading platen: a solid cylinder with two flat faces, a side and two sharp rims, "
		"one body with exact contact to spheres (nothing is tessellated). "
		"Body position is the centre of the solid, the axis is the body's local z axis, so an unrotated platen stands upright.\n\n"
		"Contacts need Bo1_Platen_Aabb and Ig2_Platen_Sphere_ScGeom (or Ig2_Platen_Sphere_ScGeom6D); motion is given by PlatenDrive. "
		"Make one with ``hexmembrane.scene.platens.platen(...)``:\n\n"
		".. code-block:: python\n\n"
		"\tO.bodies.append(platens.platen(faceCentre=(0,0,.08),radius=.02,height=.005,facing=-1))\n\n"
		"Sizes are refused at once when they are not positive or not finite; a missing one (NaN) is an error in the first step.",
		((Real,radius,NaN,Attr::triggerPostLoad,"Radius of the cylinder [m], > 0, required."))
		((Real,height,NaN,Attr::triggerPostLoad,"Distance of the two faces [m], > 0, required."))
		,
		createIndex(); /*ctor*/
	);
	// clang-format on
	REGISTER_CLASS_INDEX(Platen, Shape);

private:
	// What a refused assignment goes back to.
	Real acceptedRadius = NaN, acceptedHeight = NaN;
};
REGISTER_SERIALIZABLE(Platen);

class Bo1_Platen_Aabb : public BoundFunctor {
public:
	void go(const shared_ptr<Shape>& shape, shared_ptr<Bound>& bound, const Se3r& se3, const Body* body) override;
	FUNCTOR1D(Platen);
	// clang-format off
	YADE_CLASS_BASE_DOC(Bo1_Platen_Aabb,BoundFunctor,
		"Makes the Aabb of a Platen: the smallest box round it in its present orientation, half edges R sqrt(1 - a_i²) + H |a_i| with axis a, "
		"radius R and half height H. The collider widens it by its sweep as for any other body.\n\n"
		"The collider notices a body's movement but not its rotation. "
		"A platen that turns out of its axis (angular velocity across the axis), or is free to, gets the box of its circumscribed sphere, "
		"which holds it at any orientation. Set such an angular velocity before the first step, or let the collider run again.\n\n"
		"A Platen without sizes and a sheared periodic cell are errors; "
		"YADE calls bound functors inside a parallel loop, where an error ends the program with its message.");
	// clang-format on
};
REGISTER_SERIALIZABLE(Bo1_Platen_Aabb);

class Ig2_Platen_Sphere_ScGeom : public IGeomFunctor {
public:
	bool go(const shared_ptr<Shape>& platen, const shared_ptr<Shape>& sphere, const State& platenState, const State& sphereState, const Vector3r& shift2,
	        const bool& force, const shared_ptr<Interaction>& contact) override;
	bool goReverse(const shared_ptr<Shape>& sphere, const shared_ptr<Shape>& platen, const State& sphereState, const State& platenState,
	               const Vector3r& shift2, const bool& force, const shared_ptr<Interaction>& contact) override;

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS(Ig2_Platen_Sphere_ScGeom,IGeomFunctor,
		"Makes the ScGeom of a Platen and a Sphere, in this order: the normal points from the platen to the sphere.\n\n"
		"Normal and penetration follow from the point of the cylinder that is nearest to the sphere's centre (face, side or rim; "
		"a centre inside the solid is pushed out through the nearest surface). The contact point lies half way through the overlap.\n\n"
		"Both reference radii are the sphere's, so that stiffnesses are those of a Box or of an equal sphere. "
		"The shear increment is the true relative velocity of the two bodies at the contact point, "
		"rotations of the platen about its own centre included (Ig2_Sphere_Sphere_ScGeom.avoidGranularRatcheting has no meaning here: "
		"it is made for two round bodies). Law2_ScGeom_FrictPhys_CundallStrack and its like must not take the torque on the platen from the radii "
		"(``sphericalBodies=False``) where that torque matters; for a platen whose rotation is blocked it does not.",
		((Real,interactionDetectionFactor,1,,
			"Contacts are made when the centre is nearer to the platen than this times the sphere's radius; above 1 for laws that act across a gap. "
			"Give Bo1_Sphere_Aabb::aabbEnlargeFactor the same value."))
	);
	// clang-format on
	FUNCTOR2D(Platen, Sphere);
	DEFINE_FUNCTOR_ORDER_2D(Platen, Sphere);

protected:
	virtual shared_ptr<ScGeom> makeGeom() const;
};
REGISTER_SERIALIZABLE(Ig2_Platen_Sphere_ScGeom);

class Ig2_Platen_Sphere_ScGeom6D : public Ig2_Platen_Sphere_ScGeom {
public:
	bool go(const shared_ptr<Shape>& platen, const shared_ptr<Shape>& sphere, const State& platenState, const State& sphereState, const Vector3r& shift2,
	        const bool& force, const shared_ptr<Interaction>& contact) override;

	// clang-format off
	YADE_CLASS_BASE_DOC(Ig2_Platen_Sphere_ScGeom6D,Ig2_Platen_Sphere_ScGeom,
		"As Ig2_Platen_Sphere_ScGeom, but makes a ScGeom6D, which follows the relative rotation too, for laws with contact moments.");
	// clang-format on
	FUNCTOR2D(Platen, Sphere);
	DEFINE_FUNCTOR_ORDER_2D(Platen, Sphere);

protected:
	shared_ptr<ScGeom> makeGeom() const override;
};
REGISTER_SERIALIZABLE(Ig2_Platen_Sphere_ScGeom6D);

} // namespace yade
