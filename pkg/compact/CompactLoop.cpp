// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "CompactLoop.hpp"

#include "kernels/base/Check.hpp"
#include "kernels/membrane/RadialForce.hpp"

#include <core/Scene.hpp>

namespace yade {

YADE_PLUGIN((CompactLoop));

namespace {

// The number of threads of every parallel loop below it, while it lives.
class ThreadCount {
public:
	explicit ThreadCount(int wished) : before(omp_get_max_threads())
	{
		if (wished > 0) omp_set_num_threads(std::min(wished, before));
	}
	~ThreadCount() { omp_set_num_threads(before); }
	ThreadCount(const ThreadCount&) = delete;
	ThreadCount& operator=(const ThreadCount&) = delete;

private:
	const int before;
};

} // namespace

void CompactLoop::prepareEngines()
{
	hexmembrane::requireNonNegative("CompactLoop.damping", damping, "1");
	if (damping >= 1) hexmembrane::reject("CompactLoop.damping", damping, "takes all of every force that drives a motion", "a number below 1");
	if (substeps < 1) hexmembrane::reject("CompactLoop.substeps", substeps, "must be at least 1", "100, say");
	if (!math::isnan(skin)) hexmembrane::requirePositive("CompactLoop.skin", skin, "m");
	hexmembrane::requirePositive("O.dt", scene->dt, "s");
	bonds = nullptr;
	pressure = nullptr;
	radialServo = nullptr;
	oRings = nullptr;
	wallServo = nullptr;
	drives.clear();
	const auto only = [](auto*& slot, auto* engine, const char* name) {
		if (slot) throw std::runtime_error(string("CompactLoop.engines: has two ") + name + "; fix: one at most");
		slot = engine;
	};
	for (const auto& engine : engines) {
		if (!engine) throw std::runtime_error("CompactLoop.engines: holds None; fix: give engines only");
		if (engine->dead) continue;
		engine->scene = scene;
		if (auto* e = dynamic_cast<MembraneBonds*>(engine.get()))
			only(bonds, e, "MembraneBonds");
		else if (auto* e = dynamic_cast<MembranePressure*>(engine.get()))
			only(pressure, e, "MembranePressure");
		else if (auto* e = dynamic_cast<MembraneRadialServo*>(engine.get()))
			only(radialServo, e, "MembraneRadialServo");
		else if (auto* e = dynamic_cast<MembraneORings*>(engine.get()))
			only(oRings, e, "MembraneORings");
		else if (auto* e = dynamic_cast<RadialWallServo*>(engine.get()))
			only(wallServo, e, "RadialWallServo");
		else if (auto* e = dynamic_cast<PlatenDrive*>(engine.get()))
			drives.push_back(e);
		else
			throw std::runtime_error(
			        "CompactLoop.engines: a " + engine->getClassName() +
			        " cannot be stepped inside; fix: put it into O.engines, where it acts between iterations, or use the reference tier");
	}
	if (!bonds && (pressure || radialServo || oRings))
		throw std::runtime_error("CompactLoop.engines: a membrane's engine without MembraneBonds; fix: add the bonds, they hold the membrane");
	if (!bonds) return;
	bonds->prepare();
	if (pressure) {
		pressure->prepare();
		if (pressure->membrane != bonds->membrane)
			throw std::runtime_error(
			        "CompactLoop.engines: MembranePressure is for another membrane or for a mesh; fix: the membrane of MembraneBonds");
	}
	if (radialServo) {
		radialServo->prepare();
		if (radialServo->membrane != bonds->membrane)
			throw std::runtime_error("CompactLoop.engines: MembraneRadialServo is for another membrane; fix: the membrane of MembraneBonds");
	}
	if (oRings && oRings->membrane != bonds->membrane)
		throw std::runtime_error("CompactLoop.engines: MembraneORings is for another membrane; fix: the membrane of MembraneBonds");
}

long CompactLoop::stepsToDo() const
{
	long steps = substeps;
	if (scene->stopAtIter > scene->iter) steps = std::min(steps, scene->stopAtIter - scene->iter);
	if (scene->stopAtTime > scene->time)
		steps = std::min(steps, std::max(1L, static_cast<long>(std::ceil((scene->stopAtTime - scene->time) / scene->dt * (1 - 1e-12)))));
	return steps;
}

void CompactLoop::action()
{
	const ThreadCount count(ompThreads);
	threads = omp_get_max_threads();
	prepareEngines();
	takeScene();
	const long steps = stepsToDo();
	try {
		for (long s = 0; s < steps; ++s) {
			step(s + 1 == steps);
			if (s + 1 == steps) break;
			++scene->iter; // YADE counts the last one itself
			scene->time += scene->dt;
		}
	} catch (...) {
		giveScene(); // as it is, for whoever looks for the cause
		throw;
	}
	giveScene();
	if (!scene->trackEnergy) {
		flat.sums = {};
		flat.dampedWork = rows.dampedWork = 0;
	}
}

void CompactLoop::step(bool last)
{
	if (!flat.listsHold()) {
		if (bonds) rows.giveVelocities(flat.motions.data() + flat.grains());
		flat.makeLists();
	}
	flat.computeLoads(scene->dt, threads);
	if (bonds) membraneForces();
	const bool energies = scene->trackEnergy;
	Real elastic = 0;
	if (energies && last) {
		elastic = flat.elasticEnergy();
		if (bonds) bonds->bookEnergy();
	}
	driveBoundaries();
	moveAll();
	if (energies && last) bookEnergies(elastic);
}

void CompactLoop::membraneForces()
{
	const hexmembrane::PaddedRings& x = bonds->bondKernel().position;
	bonds->computeForces();
	terms.clear();
	if (pressure) {
		hexmembrane::TubePressure& kernel = *pressure->membraneKernel();
		hexmembrane::requireFinite("MembranePressure.pressure", pressure->pressure, "Pa");
		pressure->closeLoop([this]() { return transmittedByGroup(3); });
		kernel.compute(pressure->applied(), x);
		terms.push_back({&kernel.force, kernel.firstRing(), kernel.lastRing()});
	}
	if (radialServo) {
		radialServo->computeForces(x, [this]() { return transmittedByGroup(2); });
		// the rings of group 2, below and above the main body
		const auto& rings = radialServo->rows;
		const int lower = static_cast<int>(rings.size()) / 2;
		terms.push_back({&radialServo->force, rings.front(), rings[lower - 1]});
		terms.push_back({&radialServo->force, rings[lower], rings.back()});
	}
}

// As HexMembrane::transmittedPressure, from the arrays: what the particles press on others, inwards, over their rings' area.
Real CompactLoop::transmittedByGroup(int group) const
{
	const auto tube = collectedMembrane->stencil();
	const hexmembrane::PaddedRings& x = bonds->bondKernel().position;
	Real force = 0, area = 0;
	for (int k = 0; k < tube.rings; ++k) {
		if (collectedMembrane->groupOfRing(k) != group) continue;
		const Vector3r centre = hexmembrane::ringShape(tube, x, k).centre;
		area += tube.perRing * hexmembrane::particleArea(tube, x, k, collectedMembrane->sphereRadius, hexmembrane::AreaRule::tributary);
		for (int i = 0; i < tube.perRing; ++i) {
			const int m = tube.at(k, i);
			const Vector3r onParticle = flat.onParticle[m].force + flat.loads[flat.grains() + m].force;
			force -= onParticle.dot(hexmembrane::towardAxis(x.get(k, i), centre));
		}
	}
	return force / area;
}

void CompactLoop::driveBoundaries()
{
	for (PlatenDrive* drive : drives) {
		const auto at = std::find(boundaryIds.begin(), boundaryIds.end(), drive->platen);
		const size_t b = at - boundaryIds.begin();
		if (at == boundaryIds.end()) {
			drive->advance(Vector3r::Zero(), [](const Vector3r&) { return 0; }); // says what is wrong with it
			continue;
		}
		drive->advance(flat.onBoundary[b].load.force, [&](const Vector3r& unit) { return flat.boundaryContacts[b].stiffness(unit); });
	}
	if (wallServo) {
		const auto at = std::find(boundaryIds.begin(), boundaryIds.end(), wallServo->wall);
		const size_t b = at - boundaryIds.begin();
		if (at == boundaryIds.end())
			wallServo->advance(0, 0);
		else
			wallServo->advance(flat.onBoundary[b].normalForce, flat.onBoundary[b].normalStiffness);
	}
}

void CompactLoop::moveAll()
{
	const Real dt = lastDt = scene->dt;
	const bool energies = scene->trackEnergy;
	const int lostGrain = flat.moveGrains(dt, damping, energies, threads);
	if (lostGrain >= 0) stopLost(lostGrain);
	if (bonds) {
		if (oRings) std::tie(rows.below, rows.above) = oRings->velocities();
		hexmembrane::BondForce& kernel = bonds->bondKernel();
		const int grains = flat.grains();
		const hexmembrane::MembraneMotion::Contacts contacts{flat.onParticle, flat.loads.data() + grains,  flat.loadedParticles(),
		                                                     grains,          flat.places.data() + grains, flat.motions.data() + grains};
		int lost = rows.move(dt, damping, 0.5 * flat.skin(), kernel.force, terms, contacts, kernel.position, energies, threads);
		if (rotatingMembrane()) {
			for (int k = 0; k < collectedMembrane->rings; ++k)
				for (int a = 0; a < 3; ++a)
					std::copy(rows.velocity.row(a, k), rows.velocity.row(a, k) + collectedMembrane->perRing, kernel.velocity.row(a, k));
			for (int k = 0; k < collectedMembrane->rings; ++k) kernel.velocity.wrap(k);
			const int lostSpin = rows.moveSpins(dt, damping, flat.inertia.back(), kernel.torque, flat.loads.data() + grains, kernel.spin,
			                                    flat.motions.data() + grains, energies);
			if (lost < 0) lost = lostSpin;
		}
		if (lost >= 0) stopLost(flat.id[grains + lost]);
		flat.noteSpeed(rows.fastest, dt);
		bookWorks();
	}
	// boundaries move as NewtonIntegrator moves blocked bodies: at the velocity that they were given
	for (size_t b = 0; b < boundaryIds.size(); ++b) {
		State& state = *(*scene->bodies)[boundaryIds[b]]->state;
		if (state.blockedDOFs != State::DOF_ALL)
			throw std::runtime_error("CompactLoop: boundary " + std::to_string(boundaryIds[b]) +
			                         " is free to move; fix: dynamic=False, or give it a PlatenDrive");
		state.se3.position += state.vel * dt;
		const Real before = flat.boundaries[b].solid.radius;
		flat.noteSpeed(state.vel.norm(), dt);
		refreshBoundary(b);
		flat.noteSpeed(std::abs(flat.boundaries[b].solid.radius - before) / dt, dt);
	}
	flat.endStep();
}

// Works up to the present positions; the half that leads on from them waits for the next step.
void CompactLoop::bookWorks()
{
	aheadWork.resize(3, 0.);
	const auto book = [&](size_t slot, Real& work, Real before, Real after) {
		work += aheadWork[slot] + before;
		aheadWork[slot] = after;
	};
	size_t t = 0;
	if (pressure) {
		book(0, pressure->work, terms[0].before, terms[0].after);
		++t;
	}
	if (radialServo) book(1, radialServo->work, terms[t].before + terms[t + 1].before, terms[t].after + terms[t + 1].after);
	if (oRings) book(2, oRings->work, rows.oRingBefore, rows.oRingAfter);
}

void CompactLoop::bookEnergies(Real elastic)
{
	auto& energy = *scene->energy;
	energy.add(elastic, "elastPotential", elasticIx, /*reset*/ true);
	energy.add(flat.sums.slip, "plastDissip", slipIx);
	energy.add(flat.sums.roll, "rollDissip", rollIx);
	energy.add(flat.sums.bond, "bondDissip", bondIx);
	energy.add(flat.kinetic + (bonds ? rows.kinetic : 0), "kinetic", kineticIx, /*reset*/ true);
	energy.add(flat.dampedWork + (bonds ? rows.dampedWork : 0), "nonviscDamp", dampIx);
	flat.sums = {};
	flat.dampedWork = rows.dampedWork = 0;
	if (pressure) pressure->bookWork();
	if (radialServo) radialServo->bookWork();
	if (oRings) oRings->bookEnergy();
}

void CompactLoop::stopLost(Body::id_t id)
{
	if (bonds) rows.giveVelocities(flat.motions.data() + flat.grains());
	const auto at = std::find(flat.id.begin(), flat.id.end(), id);
	const auto& motion = flat.motions[at - flat.id.begin()];
	const auto& place = flat.places[at - flat.id.begin()];
	const auto text = [](const Vector3r& v) {
		return "(" + hexmembrane::formatNumber(v[0]) + ", " + hexmembrane::formatNumber(v[1]) + ", " + hexmembrane::formatNumber(v[2]) + ")";
	};
	throw std::runtime_error("CompactLoop: body " + std::to_string(id) + " at iteration " + std::to_string(scene->iter) +
	                         " is not finite or moves half a skin (" + hexmembrane::formatNumber(0.5 * flat.skin()) +
	                         " m) in one step, the run has lost its stability; position " + text(place.centre) + " m, velocity " + text(motion.velocity) +
	                         " m/s; fix: load the last checkpoint and use a shorter time step, or look for overlaps and forces that are too large there");
}

} // namespace yade
