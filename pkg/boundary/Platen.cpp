// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "Platen.hpp"

#include "compact/BoundaryRegistry.hpp"

#include <core/Aabb.hpp>
#include <core/Scene.hpp>
#include "kernels/base/Check.hpp"

#include <stdexcept>

namespace yade {

YADE_PLUGIN((Platen)(Bo1_Platen_Aabb)(Ig2_Platen_Sphere_ScGeom)(Ig2_Platen_Sphere_ScGeom6D));

hexmembrane::SolidCylinder Platen::solid(const Se3r& se3) const { return {se3.position, se3.orientation * Vector3r::UnitZ(), radius, 0.5 * height}; }

void Platen::requireComplete() const
{
	hexmembrane::requirePositive("Platen.radius", radius, "m");
	hexmembrane::requirePositive("Platen.height", height, "m");
}

void Platen::postLoad(Platen&)
{
	try {
		// NaN is "not given yet": attributes are set one by one.
		if (!math::isnan(radius)) hexmembrane::requirePositive("Platen.radius", radius, "m");
		if (!math::isnan(height)) hexmembrane::requirePositive("Platen.height", height, "m");
	} catch (const std::invalid_argument&) {
		radius = acceptedRadius;
		height = acceptedHeight;
		throw;
	}
	acceptedRadius = radius;
	acceptedHeight = height;
}

namespace {

const CompactBoundary<Platen> platenInCompactTier("radius, height", [](const Platen& platen, const State& state) {
	platen.requireComplete();
	return hexmembrane::boundaryShape(hexmembrane::PlatenBoundary{platen.solid(state.se3)});
});

// Whether the axis may have another direction by the time of the collider's next run.
bool mayTip(const State& state, const Vector3r& axis)
{
	if ((state.blockedDOFs & State::DOF_RXRYRZ) != State::DOF_RXRYRZ) return true;
	return state.angVel.cross(axis).norm() > 1e-12 * state.angVel.norm();
}

} // namespace

void Bo1_Platen_Aabb::go(const shared_ptr<Shape>& shape, shared_ptr<Bound>& bound, const Se3r& se3, const Body* body)
{
	const Platen& platen = static_cast<const Platen&>(*shape);
	platen.requireComplete();
	if (scene->isPeriodic && scene->cell->hasShear())
		throw std::runtime_error("Bo1_Platen_Aabb: a Platen in a sheared periodic cell is not supported; fix: use a scene without periodic boundaries");
	if (!bound) bound = shared_ptr<Bound>(new Aabb);
	const hexmembrane::SolidCylinder solid = platen.solid(se3);
	Vector3r half = hexmembrane::platenHalfExtent(solid);
	if (mayTip(*body->state, solid.axis)) half = Vector3r::Constant(math::sqrt(solid.radius * solid.radius + solid.halfHeight * solid.halfHeight));
	bound->min = se3.position - half;
	bound->max = se3.position + half;
}

shared_ptr<ScGeom> Ig2_Platen_Sphere_ScGeom::makeGeom() const { return shared_ptr<ScGeom>(new ScGeom); }

bool Ig2_Platen_Sphere_ScGeom::go(const shared_ptr<Shape>& platen, const shared_ptr<Shape>& sphere, const State& platenState, const State& sphereState,
                                  const Vector3r& shift2, const bool& force, const shared_ptr<Interaction>& contact)
{
	const Real radius = static_cast<const Sphere&>(*sphere).radius;
	const hexmembrane::PlatenContact found =
	        hexmembrane::platenContact(static_cast<const Platen&>(*platen).solid(platenState.se3), sphereState.pos + shift2, radius);
	if (!contact->isReal() && !force && found.penetration < (1 - interactionDetectionFactor) * radius) return false;

	const bool isNew = !contact->geom;
	if (isNew) contact->geom = makeGeom();
	// The velocities at the contact point itself, not those of two rolling spheres: the platen is flat, and its centre may be anywhere.
	const bool avoidGranularRatcheting = false;
	static_cast<ScGeom&>(*contact->geom)
	        .doIg2Work(found.point, found.penetration, radius, radius, platenState, sphereState, scene, contact, found.normal, shift2, isNew,
	                   avoidGranularRatcheting);
	return true;
}

bool Ig2_Platen_Sphere_ScGeom::goReverse(const shared_ptr<Shape>& sphere, const shared_ptr<Shape>& platen, const State& sphereState, const State& platenState,
                                         const Vector3r& shift2, const bool& force, const shared_ptr<Interaction>& contact)
{
	contact->swapOrder();
	return go(platen, sphere, platenState, sphereState, -shift2, force, contact);
}

shared_ptr<ScGeom> Ig2_Platen_Sphere_ScGeom6D::makeGeom() const { return shared_ptr<ScGeom>(new ScGeom6D); }

bool Ig2_Platen_Sphere_ScGeom6D::go(const shared_ptr<Shape>& platen, const shared_ptr<Shape>& sphere, const State& platenState, const State& sphereState,
                                    const Vector3r& shift2, const bool& force, const shared_ptr<Interaction>& contact)
{
	const bool isNew = !contact->geom;
	if (!Ig2_Platen_Sphere_ScGeom::go(platen, sphere, platenState, sphereState, shift2, force, contact)) return false;
	static_cast<ScGeom6D&>(*contact->geom).precomputeRotations(platenState, sphereState, isNew);
	return true;
}

} // namespace yade
