// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "MembraneRadialServo.hpp"

#include "base/GatherBodies.hpp"
#include "kernels/base/Check.hpp"

namespace yade {

YADE_PLUGIN((MembraneRadialServo));

namespace {

hexmembrane::AreaRule areaRuleFromName(const string& name)
{
	hexmembrane::requireOneOf(hexmembrane::shared::area_rule, "MembraneRadialServo.areaRule", name);
	return name == "cube" ? hexmembrane::AreaRule::cube : hexmembrane::AreaRule::tributary;
}

} // namespace

void MembraneRadialServo::prepare()
{
	if (!membrane)
		throw std::runtime_error("MembraneRadialServo.membrane = None: no membrane to act on; fix: MembraneRadialServo(membrane=HexMembrane(...))");
	membrane->requireGenerated("MembraneRadialServo");
	hexmembrane::requireFinite("MembraneRadialServo.pressure", pressure, "Pa");
	hexmembrane::requireNonNegative("MembraneRadialServo.rampTime", rampTime, "s");
	loop().require(scene->dt);
	if (loop().closed()) hexmembrane::requirePositive("MembraneRadialServo.maxFactor", maxFactor, "1");
	rule = areaRuleFromName(areaRule);
	rows.clear();
	for (int k = 0; k < membrane->rings; ++k)
		if (membrane->groupOfRing(k) == 2) rows.push_back(k);
	if (rows.empty())
		throw std::runtime_error(
		        "MembraneRadialServo.membrane: it has no rows beside the platens (group 2); fix: HexMembrane(platenRows=2), or leave this engine out");
}

PressureLoop MembraneRadialServo::loop() { return {"MembraneRadialServo", timeConstant, 0, maxFactor, factor, transmitted, saturated, lastCorrection}; }

void MembraneRadialServo::action() { stepOverBodies(*this); }

void MembraneRadialServo::step(StepView& view)
{
	followPressure(pressure, rampTime, scene->dt, rampTarget, ramps);
	loop().close(*scene, ramped(), [&] { return membrane->transmitted(view, 2, "MembraneRadialServo"); });
	const Real applied = factor * ramped();
	const hexmembrane::PaddedRings& x = view.positions(*membrane);
	const auto tube = membrane->stencil();
	if (!force.fits(tube.perRing, tube.rings)) force = hexmembrane::PaddedRings(tube.perRing, tube.rings);
	area = 0;
	for (int k : rows) {
		const Real a = hexmembrane::particleArea(tube, x, k, membrane->sphereRadius, rule);
		const auto centre = hexmembrane::ringShape(tube, x, k).centre;
		for (int i = 0; i < tube.perRing; ++i) {
			force.set(k, i, applied * a * hexmembrane::towardAxis(x.get(k, i), centre));
			if (!isFinite(force.get(k, i))) throwNotFinite("MembraneRadialServo: force", membrane->ids[tube.at(k, i)], *scene);
		}
		area += a * tube.perRing;
	}
	const int lower = static_cast<int>(rows.size()) / 2; // as many below the main body as above it
	view.addForces(*membrane, {{rows.front(), rows[lower - 1]}, {rows[lower], rows.back()}}, force, nullptr, meter.get());
}

void MembraneRadialServo::bookWorks() { meter->book(*scene, "radialServoWork"); }

} // namespace yade
