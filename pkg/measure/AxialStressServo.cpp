// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "AxialStressServo.hpp"

namespace yade {

YADE_PLUGIN((AxialStressServo));

PressureLoop AxialStressServo::loop() { return {"AxialStressServo", timeConstant, 1 / maxFactor, maxFactor, factor, axialStress, saturated, lastCorrection}; }

void AxialStressServo::prepare()
{
	if (!measure)
		throw std::runtime_error("AxialStressServo.measure = None: nothing tells the soil's stress; fix: AxialStressServo(measure=SoilMeasure(...))");
	if (!drive) throw std::runtime_error("AxialStressServo.drive = None: no platen to press with; fix: AxialStressServo(drive=PlatenDrive(...))");
	hexmembrane::requirePositive("AxialStressServo.stress", stress, "Pa");
	hexmembrane::requirePositive("AxialStressServo.tolerance", tolerance, "(no unit)");
	if (!math::isnan(timeLimit)) hexmembrane::requirePositive("AxialStressServo.timeLimit", timeLimit, "s");
	if (!(maxFactor > 1) || !math::isfinite(maxFactor))
		hexmembrane::reject("AxialStressServo.maxFactor", maxFactor, "leaves no room for corrections", "a number above 1");
	loop().require(scene->dt);
	if (!loop().closed())
		hexmembrane::reject("AxialStressServo.timeConstant", timeConstant, "leaves the loop open", "a time in s, or leave the engine out");
	measure->require(*scene, "AxialStressServo.measure");
}

void AxialStressServo::action() { stepOverBodies(*this); }

void AxialStressServo::step(StepView& view)
{
	if (drive->mode != "stress") return;
	// what the platen does not carry yet is no error of the factor
	if (drive->settled || math::isnan(lastCorrection))
		loop().close(*scene, stress, [&] { return measure->measure(*scene, view).middle(2, 2); });
	else
		lastCorrection = scene->time;
	drive->stress = factor * stress;
	requireReached();
}

void AxialStressServo::requireReached()
{
	if (changedTo != stress) {
		changedTo = stress;
		changeTime = scene->time;
		settled = false;
	}
	settled |= math::abs(axialStress - stress) <= tolerance * stress;
	if (settled || !(scene->time - changeTime > timeLimit)) return;
	throw std::runtime_error("AxialStressServo.timeLimit = " + hexmembrane::formatNumber(timeLimit) + ": the soil's axial stress is " +
	                         hexmembrane::formatNumber(axialStress) + " Pa of " + hexmembrane::formatNumber(stress) +
	                         " Pa after this time, at iteration " + std::to_string(scene->iter) +
	                         "; fix: is there a specimen between the platens? give a longer timeLimit, or the drive a larger maxVelocity");
}

} // namespace yade
