// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "SoilStressServo.hpp"

namespace yade {

YADE_PLUGIN((SoilStressServo));

PressureLoop SoilStressServo::loop() { return {"SoilStressServo", timeConstant, 1 / maxFactor, maxFactor, factor, measured, saturated, lastCorrection}; }

void SoilStressServo::prepare()
{
	if (!measure)
		throw std::runtime_error("SoilStressServo.measure = None: nothing tells the soil's stress; fix: SoilStressServo(measure=SoilMeasure(...))");
	if (static_cast<bool>(drive) == static_cast<bool>(pressure))
		hexmembrane::reject("SoilStressServo.drive", string(drive ? "given together with pressure" : "None"), "what to press with is not clear",
		                    "either drive=PlatenDrive(...) or pressure=MembranePressure(...)");
	if (drive && beside) hexmembrane::reject("SoilStressServo.beside", string("given"), "a platen's drive has none", "leave it out, or give pressure");
	if (pressure && (pressure->rampTime > 0 || (beside && beside->rampTime > 0)))
		hexmembrane::reject("SoilStressServo.pressure", string("has a rampTime"), "a ramp delays what the servo sets in every correction",
		                    "rampTime = 0 there, and raise SoilStressServo.stress in steps");
	hexmembrane::requirePositive("SoilStressServo.stress", stress, "Pa");
	hexmembrane::requireIn(hexmembrane::shared::servo_tolerance, "SoilStressServo.tolerance", tolerance, "(no unit)");
	if (!math::isnan(timeLimit)) hexmembrane::requirePositive("SoilStressServo.timeLimit", timeLimit, "s");
	if (!(maxFactor > 1) || !math::isfinite(maxFactor))
		hexmembrane::reject("SoilStressServo.maxFactor", maxFactor, "leaves no room for corrections", "a number above 1");
	loop().require(scene->dt);
	if (!loop().closed()) hexmembrane::reject("SoilStressServo.timeConstant", timeConstant, "leaves the loop open", "a time in s, or leave the engine out");
	measure->require(*scene, "SoilStressServo.measure");
}

void SoilStressServo::action() { stepOverBodies(*this); }

Real SoilStressServo::arrived() const
{
	if (drive) return drive->carried();
	if (pressure->timeConstant == std::numeric_limits<Real>::infinity()) return 1; // an open loop measures nothing
	return pressure->transmitted / pressure->pressure;
}

void SoilStressServo::step(StepView& view)
{
	if (drive && drive->mode != "stress") return;
	// with less of the load the soil's stress is mostly what it had before
	constexpr Real telling = 0.5;
	const Real share = arrived();
	if (share >= telling || math::isnan(lastCorrection))
		loop().close(*scene, share * stress, [&] {
			const Matrix3r middle = measure->measure(*scene, view).middle;
			return drive ? middle(2, 2) : 0.5 * (middle(0, 0) + middle(1, 1));
		});
	else
		lastCorrection = scene->time;
	if (drive) drive->stress = factor * stress;
	if (pressure) pressure->pressure = factor * stress;
	if (beside) beside->pressure = factor * stress;
	requireReached();
}

void SoilStressServo::requireReached()
{
	if (changedTo != stress) {
		changedTo = stress;
		changeTime = scene->time;
		settled = false;
	}
	settled |= math::abs(measured - stress) <= tolerance * stress;
	if (settled || !(scene->time - changeTime > timeLimit)) return;
	throw std::runtime_error("SoilStressServo.timeLimit = " + hexmembrane::formatNumber(timeLimit) + ": the soil's " + string(drive ? "axial" : "radial") +
	                         " stress is " + hexmembrane::formatNumber(measured) + " Pa of " + hexmembrane::formatNumber(stress) +
	                         " Pa after this time, at iteration " + std::to_string(scene->iter) +
	                         "; fix: is there a specimen between the platens? give a longer timeLimit, or what presses a larger maxVelocity");
}

} // namespace yade
