// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "MembraneRadialServo.hpp"

#include "GatherBodies.hpp"
#include "kernels/base/Check.hpp"
#include "kernels/base/IntegralController.hpp"
#include "kernels/base/TrapezoidalWork.hpp"

namespace yade {

YADE_PLUGIN((MembraneRadialServo));

namespace {

hexmembrane::AreaRule areaRuleFromName(const string& name)
{
	if (name == "tributary") return hexmembrane::AreaRule::tributary;
	if (name == "cube") return hexmembrane::AreaRule::cube;
	hexmembrane::reject("MembraneRadialServo.areaRule", "'" + name + "'", "unknown", "'tributary' or 'cube'");
}

} // namespace

void MembraneRadialServo::prepare()
{
	if (!membrane)
		throw std::runtime_error("MembraneRadialServo.membrane = None: no membrane to act on; fix: MembraneRadialServo(membrane=HexMembrane(...))");
	membrane->requireGenerated("MembraneRadialServo");
	hexmembrane::requireFinite("MembraneRadialServo.pressure", pressure, "Pa");
	hexmembrane::requireNonNegative("MembraneRadialServo.gain", gain, "1");
	if (gain > 0) {
		hexmembrane::requirePositive("MembraneRadialServo.maxFactor", maxFactor, "1");
		if (iterPeriod < 1) hexmembrane::reject("MembraneRadialServo.iterPeriod", iterPeriod, "must be at least one step", "50, say");
	}
	rule = areaRuleFromName(areaRule);
	rows.clear();
	for (int k = 0; k < membrane->rings; ++k)
		if (membrane->groupOfRing(k) == 2) rows.push_back(k);
	if (rows.empty())
		throw std::runtime_error(
		        "MembraneRadialServo.membrane: it has no rows beside the platens (group 2); fix: HexMembrane(platenRows=2), or leave this engine out");
}

void MembraneRadialServo::correct(Real measured)
{
	transmitted = measured;
	factor = hexmembrane::correctedFactor(factor, gain, pressure, measured, 0, maxFactor, saturated);
}

void MembraneRadialServo::computeForces(const hexmembrane::PaddedRings& x, const std::function<Real()>& transmittedNow)
{
	if (gain > 0 && scene->iter % iterPeriod == 0) correct(transmittedNow());
	const auto tube = membrane->stencil();
	if (!force.fits(tube.perRing, tube.rings)) force = hexmembrane::PaddedRings(tube.perRing, tube.rings);
	area = 0;
	for (int k : rows) {
		const Real a = hexmembrane::particleArea(tube, x, k, membrane->sphereRadius, rule);
		const auto centre = hexmembrane::ringShape(tube, x, k).centre;
		for (int i = 0; i < tube.perRing; ++i) {
			force.set(k, i, factor * pressure * a * hexmembrane::towardAxis(x.get(k, i), centre));
			if (!isFinite(force.get(k, i))) throwNotFinite("MembraneRadialServo: force", membrane->ids[tube.at(k, i)], *scene);
		}
		area += a * tube.perRing;
	}
}

void MembraneRadialServo::action()
{
	prepare();
	membrane->gather(*scene, "MembraneRadialServo", positions);
	computeForces(positions, [this]() { return membrane->transmittedPressure(2); });
	vector<Vector3r> f, x;
	for (int k : rows)
		for (int i = 0; i < membrane->perRing; ++i) {
			f.push_back(force.get(k, i));
			x.push_back(positions.get(k, i));
			scene->forces.addForce(membrane->ids[k * membrane->perRing + i], f.back());
		}
	work += hexmembrane::WorkMeter{lastIter, lastForces, lastPositions}.record(scene->iter, f, x);
	bookWork();
}

void MembraneRadialServo::bookWork()
{
	if (scene->trackEnergy) scene->energy->add(-work, "radialServoWork", energyIndex, /*reset*/ true);
}

} // namespace yade
