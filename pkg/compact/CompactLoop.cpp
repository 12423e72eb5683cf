// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "CompactLoop.hpp"

#include "base/NamedFields.hpp"

#include <core/Scene.hpp>
#include <lib/pyutil/gil.hpp>

namespace yade {

YADE_PLUGIN((CompactLoop));
CREATE_LOGGER(CompactLoop);

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

/*! An instant as the engines see it: the arrays, and what engines have asked for in this step. */
class CompactLoop::View : public StepView {
public:
	View(CompactLoop& l, bool lastStep) : loop(l), state(*l.state), last(lastStep) {}

	const hexmembrane::PaddedRings& positions(const HexMembrane&) override { return *state.sheet.position; }
	void refresh(const Sheet&) override {} // the rows are where the particles are moved
	bool leavesInstant() const override { return last; }
	void addForces(const HexMembrane&, const vector<RingRange>& rings, const hexmembrane::PaddedRings& force, const hexmembrane::PaddedRings* torque,
	               WorkMeter* meter) override
	{
		if (meter) takeOver(*meter, rings);
		for (const RingRange& range : rings) {
			loop.terms.push_back({&force, range.first, range.last, meter != nullptr, {}});
			loop.meters.push_back(meter);
		}
		if (torque) loop.torques.push_back(torque);
	}
	void grip(const HexMembrane&, const vector<std::pair<int, Vector3r>>& rings, WorkMeter& meter) override
	{
		vector<RingRange> list;
		for (const auto& [ring, velocity] : rings) list.push_back({ring, ring});
		takeOver(meter, list);
		for (const auto& [ring, velocity] : rings) {
			loop.grips.push_back({ring, velocity, {}});
			loop.gripMeters.push_back(&meter);
		}
	}
	hexmembrane::SphereRows grains(const HexMembrane&) override { return {state.spheres.places.data(), state.spheres.id.data(), state.spheres.grains()}; }
	hexmembrane::Travel travel() const override { return state.spheres.travel(); }
	void addForce(int grain, const Vector3r& force) override { state.spheres.loads[grain].force += force; }
	MovingRows moving(const vector<Body::id_t>&) override
	{
		const hexmembrane::SphereAssembly& spheres = state.spheres;
		return {spheres.places.data(), spheres.motions.data(), spheres.id.data(), spheres.grains(), spheres.travel().order};
	}
	void addLoad(int row, const hexmembrane::Load& load) override { state.spheres.loads[row] += load; }
	vector<Vector3r> contactForces(const HexMembrane&) override
	{
		return loop.withEngines(state.contactForces(state.spheres.places, state.spheres.shapes()));
	}
	ContactSums contacts(Body::id_t boundary) override
	{
		const int b = require(boundary);
		const hexmembrane::BoundaryLoad& load = state.spheres.onBoundary[b];
		return {load.load.force + loop.outsideOn[b], load.normalForce, load.normalStiffness, load.count, ""};
	}
	Real stiffness(Body::id_t boundary, const Vector3r& along) override { return state.spheres.boundaryContacts[require(boundary)].stiffness(along); }
	Real touchingMass(Body::id_t boundary) override
	{
		Real sum = 0;
		state.spheres.boundaryContacts[require(boundary)].forEachTouching([&](int sphere, const auto&) { sum += state.spheres.mass[sphere]; });
		return sum;
	}
	void forEachContact(const VisitContact& visit) override { loop.visitWithEngines(state.spheres.places, state.spheres.shapes(), visit); }

private:
	void takeOver(WorkMeter& meter, const vector<RingRange>& rings) const
	{
		const int n = state.sheet.stencil.perRing;
		vector<int> list;
		meter.takeOver(loop.scene->iter, [&](size_t point) {
			if (list.empty())
				for (const RingRange& range : rings)
					for (int k = range.first; k <= range.last; ++k) list.push_back(k);
			return state.sheet.position->get(list.at(point / n), static_cast<int>(point % n));
		});
	}
	int require(Body::id_t boundary) const
	{
		const int b = state.boundaryIndex(boundary);
		if (b < 0) refuseBody(boundary, "is no boundary that the loop has read", "give the id of a boundary's body: " + BoundaryRegistry::names());
		return b;
	}

	CompactLoop& loop;
	CompactState& state;
	const bool last; //!< of the iteration
};

// Labels are names in Python, as YADE makes them of the labels in O.engines; also of engines that have just been loaded.
void CompactLoop::postLoad(CompactLoop&)
{
	labelled.clear();
	labelEngines();
}

void CompactLoop::labelEngines()
{
	vector<string> labels;
	for (const auto& engine : engines) labels.push_back(engine ? engine->label : "");
	if (labels == labelled) return;
	labelled = labels;
	const gilLock lock;
	boost::python::object builtins = boost::python::import("builtins");
	for (const auto& engine : engines)
		if (engine && !engine->label.empty()) builtins.attr(engine->label.c_str()) = engine;
}

bool CompactLoop::canStep(const shared_ptr<Engine>& engine) { return dynamic_cast<const Stepped*>(engine.get()); }

boost::python::list CompactLoop::contract()
{
	boost::python::list rows;
	for (const ReadingRow& row : readingContract()) rows.append(boost::python::make_tuple(row.of, row.attribute, row.treatment, row.what));
	return rows;
}

void CompactLoop::warnReaders()
{
	if (exportPeriod > 0 || warned) return;
	for (const auto& engine : scene->engines)
		if (engine->getClassName() == "VTKRecorder" && !engine->dead) {
			LOG_WARN("CompactLoop: contacts are not in O.interactions, which VTKRecorder reads; fix: CompactLoop.exportPeriod = 1, or leave "
			         "contacts out of its recorders");
			warned = true;
		}
}

void CompactLoop::prepareEngines()
{
	hexmembrane::requireIn(hexmembrane::shared::local_damping, "CompactLoop.damping", damping, "1");
	hexmembrane::requireIn(hexmembrane::shared::substeps, "CompactLoop.substeps", substeps, "steps");
	if (exportPeriod < 0) hexmembrane::reject("CompactLoop.exportPeriod", exportPeriod, "must not be negative", "0 for never, or a number of iterations");
	if (!math::isnan(skin)) hexmembrane::requirePositive("CompactLoop.skin", skin, "m");
	hexmembrane::requirePositive("O.dt", scene->dt, "s");
	requireCompactScene(*scene, *this, engines);
	warnReaders();
	labelEngines();
	stepped.clear();
	std::set<string> classes;
	const HexMembrane* held = nullptr;
	for (const auto& engine : engines) {
		if (!engine) throw std::runtime_error("CompactLoop.engines: holds None; fix: give engines only");
		if (engine->dead) continue;
		const string name = engine->getClassName();
		auto* one = dynamic_cast<Stepped*>(engine.get());
		if (!one)
			throw std::runtime_error(
			        "CompactLoop.engines: a " + name +
			        " cannot be stepped inside; fix: put it into O.engines, where it acts between iterations, or use the reference tier");
		if (std::count(engines.begin(), engines.end(), engine) > 1)
			throw std::runtime_error("CompactLoop.engines: has two " + name + ", the same engine twice; fix: leave one out");
		if (!classes.insert(name).second && !one->mayBeSeveral())
			throw std::runtime_error("CompactLoop.engines: has two " + name + "; fix: one at most");
		engine->scene = scene;
		one->prepare();
		one->requireCompactScene();
		if (one->sheet().membrane) held = one->sheet().membrane;
		stepped.push_back(one);
	}
	for (Stepped* one : stepped)
		if (one->actsOn() && one->actsOn() != held)
			throw std::runtime_error(
			        "CompactLoop.engines: " + dynamic_cast<Engine*>(one)->getClassName() +
			        " acts on a membrane without MembraneBonds in the list; fix: add the bonds of that membrane, they hold it together");
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
	++iterations;
	if (exportPeriod > 0 && iterations % exportPeriod == 0) exportContacts();
	if (!scene->trackEnergy) {
		state->spheres.sums = {};
		state->spheres.dampedWork = state->motion.dampedWork = 0;
	}
}

void CompactLoop::step(bool last)
{
	hexmembrane::SphereAssembly& spheres = state->spheres;
	if (!spheres.listsHold()) {
		if (state->sheet.ids) state->motion.giveVelocities(state->velocity(), spheres.motions.data() + spheres.grains());
		const int lost = spheres.nowhere();
		if (lost >= 0) stopLost(lost);
		spheres.makeLists();
	}
	spheres.computeLoads(scene->dt, threads);
	if (last) stepShapes = spheres.shapes();
	terms.clear();
	meters.clear();
	grips.clear();
	gripMeters.clear();
	torques.clear();
	View view(*this, last);
	for (Stepped* one : stepped) one->step(view);
	const bool energies = scene->trackEnergy && last;
	Real elastic = 0;
	if (energies) {
		elastic = spheres.elasticEnergy();
		for (Stepped* one : stepped) one->bookStored();
	}
	moveAll();
	if (energies) bookEnergies(elastic);
}

void CompactLoop::moveAll()
{
	lastDt = scene->dt;
	const int lost = state->spheres.moveGrains(lastDt, damping, scene->trackEnergy, threads);
	if (lost >= 0) stopLost(lost);
	if (state->sheet.ids) moveSheet();
	moveBoundaries();
	state->spheres.endStep();
}

void CompactLoop::moveSheet()
{
	hexmembrane::SphereAssembly& spheres = state->spheres;
	const Sheet& sheet = state->sheet;
	const int grains = spheres.grains();
	const bool energies = scene->trackEnergy;
	const hexmembrane::MembraneMotion::Contacts contacts{spheres.onParticle,
	                                                     spheres.loads.data() + grains,
	                                                     spheres.loadedParticles(),
	                                                     grains,
	                                                     spheres.places.data() + grains,
	                                                     spheres.motions.data() + grains};
	int lost = state->motion.move(lastDt, damping, 0.5 * spheres.skin(), terms, grips, contacts, *sheet.position, state->velocity(), energies, threads);
	if (sheet.spin && state->spinInertia > 0) {
		const int lostSpin = state->motion.moveSpins(lastDt, damping, state->spinInertia, torques, spheres.loads.data() + grains, *sheet.spin,
		                                             spheres.motions.data() + grains, energies);
		if (lost < 0) lost = lostSpin;
	}
	if (lost >= 0) stopLost(spheres.id[grains + lost]);
	spheres.noteWay(state->motion.fastest * lastDt);
	addWorks(terms, meters);
	addWorks(grips, gripMeters);
}

// Works up to the present positions. What belongs to one meter stands together.
template <typename Part>
void CompactLoop::addWorks(const vector<Part>& parts, const vector<WorkMeter*>& owners)
{
	hexmembrane::MembraneMotion::HalfWorks sum;
	for (size_t p = 0; p < parts.size(); ++p) {
		sum += parts[p].work;
		if (p + 1 < parts.size() && owners[p + 1] == owners[p]) continue;
		if (owners[p]) owners[p]->add(scene->iter, sum);
		sum = {};
	}
}

// As NewtonIntegrator moves blocked bodies: at the velocities that they were given.
void CompactLoop::moveBoundaries()
{
	for (size_t b = 0; b < state->boundaryIds.size(); ++b) {
		State& body = *(*scene->bodies)[state->boundaryIds[b]]->state;
		body.se3.position += body.vel * lastDt;
		const Real angle = body.angVel.norm() * lastDt;
		if (angle > 0) {
			body.se3.orientation = Quaternionr(AngleAxisr(angle, body.angVel.normalized())) * body.se3.orientation;
			body.se3.orientation.normalize();
		}
		state->refreshBoundary(*scene, static_cast<int>(b));
	}
}

void CompactLoop::bookEnergies(Real elastic)
{
	auto& energy = *scene->energy;
	hexmembrane::SphereAssembly& spheres = state->spheres;
	energy.add(elastic, "elastPotential", elasticIx, /*reset*/ true);
	size_t w = 0;
	workIndices.resize(8, -1);
	hexmembrane::ContactWorks::forEach(spheres.sums.works, [&](const char* name, Real work) { energy.add(work, name, workIndices[w++]); });
	energy.add(spheres.kinetic + state->motion.kinetic, "kinetic", kineticIx, /*reset*/ true);
	energy.add(spheres.dampedWork + state->motion.dampedWork, "nonviscDamp", dampIx);
	spheres.sums = {};
	spheres.dampedWork = state->motion.dampedWork = 0;
	for (Stepped* one : stepped) one->bookWorks();
}

void CompactLoop::stopLost(Body::id_t id)
{
	hexmembrane::SphereAssembly& spheres = state->spheres;
	if (state->sheet.ids) state->motion.giveVelocities(state->velocity(), spheres.motions.data() + spheres.grains());
	const size_t at = std::find(spheres.id.begin(), spheres.id.end(), id) - spheres.id.begin();
	const auto text = [](const Vector3r& v) {
		return "(" + hexmembrane::formatNumber(v[0]) + ", " + hexmembrane::formatNumber(v[1]) + ", " + hexmembrane::formatNumber(v[2]) + ")";
	};
	throw std::runtime_error("CompactLoop: body " + std::to_string(id) + " at iteration " + std::to_string(scene->iter) +
	                         " is not finite or moves half a skin (" + hexmembrane::formatNumber(0.5 * spheres.skin()) +
	                         " m) in one step, the run has lost its stability; position " + text(spheres.places[at].centre) + " m, velocity " +
	                         text(spheres.motions[at].velocity) +
	                         " m/s; fix: load the last checkpoint and use a shorter time step, or look for overlaps and forces that are too large there");
}

} // namespace yade
