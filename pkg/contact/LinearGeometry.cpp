// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "LinearGeometry.hpp"

#include "LinearContact.hpp"

#include <core/Scene.hpp>
#include <pkg/common/Sphere.hpp>

#include <boost/make_shared.hpp>

#include <typeinfo>

namespace yade {

YADE_PLUGIN((Ig2_Sphere_Sphere_LinearScGeom));

bool Ig2_Sphere_Sphere_LinearScGeom::go(const shared_ptr<Shape>& sphere1, const shared_ptr<Shape>& sphere2, const State& state1, const State& state2,
                                        const Vector3r& shift2, const bool& force, const shared_ptr<Interaction>& contact)
{
	const Real r1 = static_cast<const Sphere&>(*sphere1).radius, r2 = static_cast<const Sphere&>(*sphere2).radius;
	Vector3r normal = (state2.pos + shift2) - state1.pos;
	const Real square = normal.squaredNorm();
	const bool isNew = !contact->geom;
	const Real reach = interactionDetectionFactor * (r1 + r2);
	if (square > reach * reach && !force && !contact->isReal()) return false;
	if (isNew) contact->geom = boost::make_shared<ScGeom>();
	ScGeom& geom = static_cast<ScGeom&>(*contact->geom);

	const Real distance = math::sqrt(square);
	normal /= distance;
	geom.penetrationDepth = r1 + r2 - distance;
	geom.contactPoint = state1.pos + (r1 - 0.5 * geom.penetrationDepth) * normal;
	geom.radius1 = r1;
	geom.radius2 = r2;
	// typeid: this is asked of every contact in every step, and a dynamic_cast is not cheap.
	const IPhys* phys = contact->phys.get();
	if (phys && typeid(*phys) == typeid(LinearPhys) && static_cast<const LinearPhys*>(phys)->normalOnly()) {
		geom.normal = normal;
		geom.shearInc = Vector3r::Zero();
	} else
		geom.precompute(state1, state2, scene, contact, normal, isNew, shift2, avoidGranularRatcheting);
	return true;
}

bool Ig2_Sphere_Sphere_LinearScGeom::goReverse(const shared_ptr<Shape>& sphere1, const shared_ptr<Shape>& sphere2, const State& state1, const State& state2,
                                               const Vector3r& shift2, const bool& force, const shared_ptr<Interaction>& contact)
{
	return go(sphere1, sphere2, state2, state1, -shift2, force, contact);
}

} // namespace yade
