// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "CylinderWall.hpp"

#include "compact/BoundaryRegistry.hpp"

#include <core/Aabb.hpp>
#include <core/Scene.hpp>
#include "kernels/base/Check.hpp"

namespace yade {

YADE_PLUGIN((CylinderWall)(Bo1_CylinderWall_Aabb)(Ig2_CylinderWall_Sphere_ScGeom));

void CylinderWall::requireComplete() const
{
	hexmembrane::requirePositive("CylinderWall.radius", radius, "m");
	hexmembrane::requirePositive("CylinderWall.height", height, "m");
}

hexmembrane::CylinderBoundary CylinderWall::boundary(const State& state) const { return {state.pos, radius, 0.5 * height}; }

namespace {

const CompactBoundary<CylinderWall> cylinderWallInCompactTier("radius, height", [](const CylinderWall& wall, const State& state) {
	wall.requireComplete();
	return hexmembrane::boundaryShape(wall.boundary(state));
});

} // namespace

void Bo1_CylinderWall_Aabb::go(const shared_ptr<Shape>& shape, shared_ptr<Bound>& bound, const Se3r& se3, const Body*)
{
	const CylinderWall& wall = static_cast<const CylinderWall&>(*shape);
	wall.requireComplete();
	if (scene->isPeriodic)
		throw std::runtime_error(
		        "Bo1_CylinderWall_Aabb: a CylinderWall in a periodic cell is not supported; fix: use a scene without periodic boundaries");
	if (!bound) bound = shared_ptr<Bound>(new Aabb);
	const Vector3r half(wall.radius, wall.radius, 0.5 * wall.height);
	bound->min = se3.position - half;
	bound->max = se3.position + half;
}

bool Ig2_CylinderWall_Sphere_ScGeom::go(const shared_ptr<Shape>& shape, const shared_ptr<Shape>& sphere, const State& wallState, const State& sphereState,
                                        const Vector3r& shift2, const bool& force, const shared_ptr<Interaction>& contact)
{
	const CylinderWall& wall = static_cast<const CylinderWall&>(*shape);
	const Real radius = static_cast<const Sphere&>(*sphere).radius;
	const hexmembrane::BoundaryTouch touch = wall.boundary(wallState).touch({sphereState.pos + shift2, radius});
	if (!contact->isReal() && !force && touch.overlap < 0) return false;

	const bool isNew = !contact->geom;
	if (isNew) contact->geom = shared_ptr<ScGeom>(new ScGeom);
	const bool avoidGranularRatcheting = false; // made for two round bodies
	static_cast<ScGeom&>(*contact->geom)
	        .doIg2Work(touch.point, touch.overlap, radius, radius, wallState, sphereState, scene, contact, touch.normal, shift2, isNew,
	                   avoidGranularRatcheting);
	return true;
}

bool Ig2_CylinderWall_Sphere_ScGeom::goReverse(const shared_ptr<Shape>& sphere, const shared_ptr<Shape>& wall, const State& sphereState, const State& wallState,
                                               const Vector3r& shift2, const bool& force, const shared_ptr<Interaction>& contact)
{
	contact->swapOrder();
	return go(wall, sphere, wallState, sphereState, -shift2, force, contact);
}

} // namespace yade
