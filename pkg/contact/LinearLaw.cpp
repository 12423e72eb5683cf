// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "LinearLaw.hpp"

#include <core/Scene.hpp>

namespace yade {

YADE_PLUGIN((Law2_ScGeom_LinearPhys_Linear));

bool Law2_ScGeom_LinearPhys_Linear::go(shared_ptr<IGeom>& geometry, shared_ptr<IPhys>& physics, Interaction* contact)
{
	const ScGeom& geom = static_cast<const ScGeom&>(*geometry);
	LinearPhys& phys = static_cast<LinearPhys&>(*physics);
	if (!phys.normalOnly()) return advance(geom, phys, *contact);
	if (geom.penetrationDepth < 0) return false;
	phys.normalForce = phys.kn * geom.penetrationDepth * geom.normal;
	if (scene->trackEnergy) book({phys.kn * geom.penetrationDepth, false, hexmembrane::BondBreak::none, {}}, phys, phys.memory(geom.normal));
	pushApart(geom, phys, *contact);
	return true;
}

bool Law2_ScGeom_LinearPhys_Linear::advance(const ScGeom& geom, LinearPhys& phys, const Interaction& contact)
{
	const hexmembrane::ContactLaw law = phys.law();
	hexmembrane::ContactMemory<Real> memory = phys.memory(geom.normal);
	memory.forEachTurning([&](Vector3r& load) { geom.rotate(load); });
	Vector3r spinDifference = Vector3r::Zero();
	if (hexmembrane::feelsSpin(law) && !phys.bonded)
		spinDifference = Body::byId(contact.getId2(), scene)->state->angVel - Body::byId(contact.getId1(), scene)->state->angVel;
	const auto motion = hexmembrane::contactMotion<Real>(geom.penetrationDepth, geom.shearIncrement(), spinDifference, geom.normal, scene->dt);
	const hexmembrane::ContactStep step = hexmembrane::advanceContact(law, motion, memory, phys.bonded);
	phys.remember(memory);
	phys.normalForce = step.normal * geom.normal;
	if (step.bond == hexmembrane::BondBreak::tension) {
#pragma omp atomic
		tensileBreaks++;
	} else if (step.bond == hexmembrane::BondBreak::shear) {
#pragma omp atomic
		shearBreaks++;
	}
	if (scene->trackEnergy) book(step, phys, memory);
	if (step.open) return false;
	push(geom, phys, contact);
	return true;
}

void Law2_ScGeom_LinearPhys_Linear::pushApart(const ScGeom& geom, const LinearPhys& phys, const Interaction& contact) const
{
	if (!phys.spheres) return push(geom, phys, contact);
	scene->forces.addForce(contact.getId1(), -phys.normalForce);
	scene->forces.addForce(contact.getId2(), phys.normalForce);
}

void Law2_ScGeom_LinearPhys_Linear::push(const ScGeom& geom, const LinearPhys& phys, const Interaction& contact) const
{
	const Body::id_t id1 = contact.getId1(), id2 = contact.getId2();
	const Vector3r force = phys.normalForce + phys.shearForce;
	Vector3r torque1, torque2;
	if (phys.spheres) {
		// The contact point lies half way through the overlap, on the line of centres, where the normal force has no moment.
		const Vector3r turning = geom.normal.cross(phys.shearForce);
		torque1 = -(geom.radius1 - 0.5 * geom.penetrationDepth) * turning;
		torque2 = -(geom.radius2 - 0.5 * geom.penetrationDepth) * turning;
	} else {
		const Vector3r &centre1 = Body::byId(id1, scene)->state->pos, &centre2 = Body::byId(id2, scene)->state->pos;
		const Vector3r shift = scene->isPeriodic ? scene->cell->intrShiftPos(contact.cellDist) : Vector3r::Zero();
		torque1 = -(geom.contactPoint - centre1).cross(force);
		torque2 = (geom.contactPoint - centre2 - shift).cross(force);
	}
	scene->forces.addForce(id1, -force);
	scene->forces.addForce(id2, force);
	const Vector3r moment = hexmembrane::momentOf(phys.memory(geom.normal));
	scene->forces.addTorque(id1, torque1 - moment);
	scene->forces.addTorque(id2, torque2 + moment);
}

// YADE makes a name at its first use, which moves the table under the other threads of the interaction loop: all names at once, one thread at a time.
void Law2_ScGeom_LinearPhys_Linear::nameEnergies()
{
#pragma omp critical(hexmembraneContactEnergies)
	if (!named) {
		scene->energy->findId("elastPotential", elasticIndex, /*reset*/ true);
		size_t w = 0;
		const hexmembrane::ContactWorks works;
		hexmembrane::ContactWorks::forEach(works, [&](const char* name, Real) { scene->energy->findId(name, workIndices.at(w++)); });
#pragma omp atomic write
		named = 1;
	}
}

void Law2_ScGeom_LinearPhys_Linear::book(const hexmembrane::ContactStep& step, const LinearPhys& phys, const hexmembrane::ContactMemory<Real>& memory)
{
	int known;
#pragma omp atomic read
	known = named;
	if (!known) nameEnergies();
	const Real elastic = hexmembrane::contactEnergy(phys.law(), step.normal, memory);
	scene->energy->add(elastic, "elastPotential", elasticIndex, /*reset*/ true);
	size_t w = 0;
	hexmembrane::ContactWorks::forEach(step.works, [&](const char* name, Real work) {
		if (work != 0) scene->energy->add(work, name, workIndices[w]);
		++w;
	});
}

} // namespace yade
