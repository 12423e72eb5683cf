// SPDX-License-Identifier: GPL-2.0-or-later
#include "LayoutProbe.hpp"

#include <core/Omega.hpp>
#include <core/Scene.hpp>
#include <pkg/common/ElastMat.hpp>
#include <pkg/common/Sphere.hpp>
#include <pkg/dem/FrictPhys.hpp>
#include <pkg/dem/ScGeom.hpp>

#include <stdexcept>
#include <string>

namespace yade {

namespace {

// Values that differ from each other and from every default.
class Counter {
public:
	explicit Counter(Real base) : last(base) {}
	Real real() { return last += 0.5; }
	int integer() { return int(real()); }
	Vector3r vector() { return Vector3r(real(), real(), real()); }
	Quaternionr rotation() { return Quaternionr(AngleAxisr(0.01 * real(), Vector3r::UnitY())); }

private:
	Real last;
};

const shared_ptr<Body>& bodyOf(const Scene& scene, Body::id_t id)
{
	if (!scene.bodies->exists(id)) throw std::invalid_argument("LayoutProbe: id = " + std::to_string(id) + ": no such body");
	return (*scene.bodies)[id];
}

template <class Part>
Part& partOf(const shared_ptr<Part>& part, const char* name)
{
	if (!part) throw std::invalid_argument(std::string("LayoutProbe: the object has no ") + name);
	return *part;
}

template <class Wanted, class Part>
Wanted& castOf(const shared_ptr<Part>& part, const char* name)
{
	const auto wanted = dynamic_cast<Wanted*>(part.get());
	if (!wanted) throw std::invalid_argument(std::string("LayoutProbe: the object has no ") + name);
	return *wanted;
}

Interaction& interactionOf(const Scene& scene, Body::id_t id1, Body::id_t id2)
{
	const auto& found = scene.interactions->find(id1, id2);
	if (!found) throw std::invalid_argument("LayoutProbe: id1, id2 = " + std::to_string(id1) + ", " + std::to_string(id2) + ": no such interaction");
	return *found;
}

} // namespace

void LayoutProbe::action()
{
	steps++;
	scene->forces.sync();
	resultant = Vector3r::Zero();
	for (const auto id : ids) resultant += scene->forces.getForce(id);
}

boost::python::dict LayoutProbe::readBody(Body::id_t id) const
{
	const Scene& world = *Omega::instance().getScene();
	const Body& body = *bodyOf(world, id);
	const State& state = partOf(body.state, "state");
	const Sphere& sphere = castOf<Sphere>(body.shape, "sphere as shape");
	const Bound& bound = partOf(body.bound, "bound");
	const FrictMat& material = castOf<FrictMat>(body.material, "FrictMat as material");
	boost::python::dict seen;
	seen["id"] = body.id;
	seen["groupMask"] = body.groupMask;
	seen["flags"] = body.flags;
	seen["clumpId"] = body.clumpId;
	seen["iterBorn"] = body.iterBorn;
	seen["timeBorn"] = body.timeBorn;
	seen["state.pos"] = state.pos;
	seen["state.ori"] = state.ori;
	seen["state.vel"] = state.vel;
	seen["state.mass"] = state.mass;
	seen["state.angVel"] = state.angVel;
	seen["state.angMom"] = state.angMom;
	seen["state.inertia"] = state.inertia;
	seen["state.refPos"] = state.refPos;
	seen["state.refOri"] = state.refOri;
	seen["state.blockedDOFs"] = state.blockedDOFs_vec_get();
	seen["state.isDamped"] = state.isDamped;
	seen["state.densityScaling"] = state.densityScaling;
	seen["shape.radius"] = sphere.radius;
	seen["shape.color"] = sphere.color;
	seen["shape.wire"] = sphere.wire;
	seen["shape.highlight"] = sphere.highlight;
	seen["bound.lastUpdateIter"] = bound.lastUpdateIter;
	seen["bound.refPos"] = bound.refPos;
	seen["bound.sweepLength"] = bound.sweepLength;
	seen["bound.color"] = bound.color;
	seen["bound.min"] = bound.min;
	seen["bound.max"] = bound.max;
	seen["material.id"] = material.id;
	seen["material.label"] = material.label;
	seen["material.density"] = material.density;
	seen["material.young"] = material.young;
	seen["material.poisson"] = material.poisson;
	seen["material.frictionAngle"] = material.frictionAngle;
	return seen;
}

boost::python::dict LayoutProbe::writeBody(Body::id_t id, Real base)
{
	const Scene& world = *Omega::instance().getScene();
	Body& body = *bodyOf(world, id);
	State& state = partOf(body.state, "state");
	Sphere& sphere = castOf<Sphere>(body.shape, "sphere as shape");
	Bound& bound = partOf(body.bound, "bound");
	FrictMat& material = castOf<FrictMat>(body.material, "FrictMat as material");
	Counter next(base);
	body.groupMask = next.integer();
	body.flags = Body::FLAG_ASPHERICAL;
	body.clumpId = next.integer();
	body.iterBorn = next.integer();
	body.timeBorn = next.real();
	state.pos = next.vector();
	state.ori = next.rotation();
	state.vel = next.vector();
	state.mass = next.real();
	state.angVel = next.vector();
	state.angMom = next.vector();
	state.inertia = next.vector();
	state.refPos = next.vector();
	state.refOri = next.rotation();
	state.blockedDOFs = State::DOF_Y | State::DOF_RX | State::DOF_RZ;
	state.isDamped = !state.isDamped;
	state.densityScaling = next.real();
	sphere.radius = next.real();
	sphere.color = next.vector();
	sphere.wire = !sphere.wire;
	sphere.highlight = !sphere.highlight;
	bound.lastUpdateIter = next.integer();
	bound.refPos = next.vector();
	bound.sweepLength = next.real();
	bound.color = next.vector();
	bound.min = next.vector();
	bound.max = next.vector();
	material.id = next.integer();
	material.label = "written in C++";
	material.density = next.real();
	material.young = next.real();
	material.poisson = next.real();
	material.frictionAngle = next.real();
	return readBody(id);
}

boost::python::dict LayoutProbe::readScene() const
{
	const Scene& world = *Omega::instance().getScene();
	boost::python::dict seen;
	seen["dt"] = world.dt;
	seen["iter"] = world.iter;
	seen["time"] = world.time;
	seen["speed"] = world.speed;
	seen["stopAtIter"] = world.stopAtIter;
	seen["stopAtTime"] = world.stopAtTime;
	seen["subStep"] = world.subStep;
	seen["periodic"] = world.isPeriodic;
	seen["trackEnergy"] = world.trackEnergy;
	seen["cell.hSize"] = world.cell->hSize;
	seen["cell.trsf"] = world.cell->trsf;
	seen["bodies.size"] = world.bodies->size();
	seen["intrs.size"] = world.interactions->size();
	seen["engines.size"] = world.engines.size();
	seen["material.size"] = world.materials.size();
	return seen;
}

boost::python::dict LayoutProbe::writeScene(Real base)
{
	Scene& world = *Omega::instance().getScene();
	Counter next(base);
	world.dt = next.real();
	world.iter = next.integer();
	world.time = next.real();
	world.speed = next.real();
	world.stopAtIter = next.integer();
	world.stopAtTime = next.real();
	world.subStep = next.integer();
	world.isPeriodic = !world.isPeriodic;
	world.trackEnergy = !world.trackEnergy;
	world.cell->hSize = next.vector().asDiagonal();
	world.cell->trsf = next.vector().asDiagonal();
	return readScene();
}

boost::python::dict LayoutProbe::readInteraction(Body::id_t id1, Body::id_t id2) const
{
	const Interaction& contact = interactionOf(*Omega::instance().getScene(), id1, id2);
	const ScGeom& geom = castOf<ScGeom>(contact.geom, "ScGeom as geom");
	const FrictPhys& phys = castOf<FrictPhys>(contact.phys, "FrictPhys as phys");
	boost::python::dict seen;
	seen["id1"] = contact.id1;
	seen["id2"] = contact.id2;
	seen["isReal"] = contact.isReal();
	seen["isActive"] = contact.isActive;
	seen["iterMadeReal"] = contact.iterMadeReal;
	seen["iterBorn"] = contact.iterBorn;
	seen["cellDist"] = contact.cellDist;
	seen["geom.normal"] = geom.normal;
	seen["geom.contactPoint"] = geom.contactPoint;
	seen["geom.refR1"] = geom.refR1;
	seen["geom.refR2"] = geom.refR2;
	seen["geom.penetrationDepth"] = geom.penetrationDepth;
	seen["geom.shearInc"] = geom.shearInc;
	seen["phys.kn"] = phys.kn;
	seen["phys.normalForce"] = phys.normalForce;
	seen["phys.ks"] = phys.ks;
	seen["phys.shearForce"] = phys.shearForce;
	seen["phys.tangensOfFrictionAngle"] = phys.tangensOfFrictionAngle;
	return seen;
}

boost::python::dict LayoutProbe::writeInteraction(Body::id_t id1, Body::id_t id2, Real base)
{
	Interaction& contact = interactionOf(*Omega::instance().getScene(), id1, id2);
	ScGeom& geom = castOf<ScGeom>(contact.geom, "ScGeom as geom");
	FrictPhys& phys = castOf<FrictPhys>(contact.phys, "FrictPhys as phys");
	Counter next(base);
	contact.isActive = !contact.isActive;
	contact.iterMadeReal = next.integer();
	contact.iterBorn = next.integer();
	contact.cellDist = Vector3i(next.integer(), next.integer(), next.integer());
	geom.normal = next.vector();
	geom.contactPoint = next.vector();
	geom.refR1 = next.real();
	geom.refR2 = next.real();
	geom.penetrationDepth = next.real();
	geom.shearInc = next.vector();
	phys.kn = next.real();
	phys.normalForce = next.vector();
	phys.ks = next.real();
	phys.shearForce = next.vector();
	phys.tangensOfFrictionAngle = next.real();
	return readInteraction(id1, id2);
}

boost::python::dict LayoutProbe::readSelf() const
{
	boost::python::dict seen;
	boost::python::list idList;
	for (const auto id : ids) idList.append(id);
	seen["dead"] = dead;
	seen["ompThreads"] = ompThreads;
	seen["label"] = label;
	seen["ids"] = idList;
	seen["steps"] = steps;
	return seen;
}

boost::python::dict LayoutProbe::writeSelf(Real base)
{
	Counter next(base);
	dead = !dead;
	ompThreads = next.integer();
	label = "writtenInCpp";
	ids = {next.integer(), next.integer(), next.integer()};
	steps = next.integer();
	return readSelf();
}

YADE_PLUGIN((LayoutProbe));

} // namespace yade
