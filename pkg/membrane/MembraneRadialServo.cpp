// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "MembraneRadialServo.hpp"

#include "Scatter.hpp"
#include "kernels/Check.hpp"
#include "kernels/RadialForce.hpp"
#include "kernels/WorkMeter.hpp"

namespace yade {

YADE_PLUGIN((MembraneRadialServo));

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
	rows.clear();
	for (int k = 0; k < membrane->rings; ++k)
		if (membrane->groupOfRing(k) == 2) rows.push_back(k);
	if (rows.empty())
		throw std::runtime_error(
		        "MembraneRadialServo.membrane: it has no rows beside the platens (group 2); fix: HexMembrane(platenRows=2), or leave this engine out");
}

void MembraneRadialServo::correct()
{
	transmitted = membrane->transmittedPressure(2);
	if (pressure == 0) return;
	const Real wanted = factor + gain * (pressure - transmitted) / pressure;
	factor = std::min(std::max(wanted, 0.), maxFactor);
	saturated = factor != wanted;
}

void MembraneRadialServo::action()
{
	prepare();
	const auto rule = hexmembrane::areaRuleFromName(areaRule);
	membrane->gather(*scene, "MembraneRadialServo", positions);
	if (gain > 0 && scene->iter % iterPeriod == 0) correct();

	const auto tube = membrane->stencil();
	vector<Vector3r> force, x;
	area = 0;
	for (int k : rows) {
		const Real a = hexmembrane::particleArea(tube, positions, k, membrane->sphereRadius, rule);
		const auto centre = hexmembrane::ringShape(tube, positions, k).centre;
		for (int i = 0; i < tube.perRing; ++i) {
			const int v = tube.at(k, i);
			x.push_back(positions[v]);
			force.push_back(factor * pressure * a * hexmembrane::towardAxis(positions[v], centre));
			if (!isFinite(force.back())) throwNotFinite("MembraneRadialServo: force", membrane->ids[v], *scene);
			scene->forces.addForce(membrane->ids[v], force.back());
		}
		area += a * tube.perRing;
	}
	work += hexmembrane::trapezoidalWork(lastForces, lastPositions, force, x);
	lastForces.swap(force);
	lastPositions.swap(x);
	if (scene->trackEnergy) scene->energy->add(-work, "radialServoWork", energyIndex, /*reset*/ true);
}

} // namespace yade
