// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "SoilMeasure.hpp"

#include "boundary/PlatenDrive.hpp"
#include "membrane/MembranePressure.hpp"
#include "membrane/MembraneRadialServo.hpp"
#include "SharedValues.hpp"

namespace yade {

/*! Closes a platen's stress, or a membrane's pressure, on the stress that the soil itself has. */
class SoilStressServo : public GlobalEngine, public Stepped {
public:
	void action() override;

	void prepare() override;
	void step(StepView& view) override;
	bool mayBeSeveral() const override { return true; }
	const HexMembrane* actsOn() const override { return measure ? measure->membrane.get() : nullptr; }

private:
	PressureLoop loop();
	void requireReached();
	//! What has arrived of the load that was asked for, as a share of it; 1 where nobody can tell.
	Real arrived() const;

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS(SoilStressServo,GlobalEngine,
		"Brings the axial or the radial stress in the middle half of the soil, from its own contacts (SoilMeasure), to a target: "
		"the axial one by the stress that a PlatenDrive in mode 'stress' holds, "
		"the radial one by the pressure that MembranePressure and MembraneRadialServo hold. Stands before those.\n\n"
		"A platen that carries σ3 Ae does not give the soil an axial stress of σ3: "
		"the membrane's inner surface encloses less than the platen's face, the membrane pulls at the O-rings, "
		"and rows beside the platens that are pressed radially have no axial share. "
		"A transmitted pressure of σ3 does not give it a radial stress of σ3 either: the sheet rests on grains that reach beyond the mean inner surface.\n\n"
		"An integral controller multiplies the load by a factor f: T df/dt = (a σ - σs)/(a σ) with σs the soil's stress, within 1/maxFactor and maxFactor, "
		"corrected 20 times within T; the load's engine gets f σ in every step. "
		"a is the share of f σ that has arrived at the platen or the sheet: what does not arrive yet is no error of the factor. "
		"Below a half of it the factor waits. "
		"It rests while the drive is in mode 'velocity'; ``dead=True`` leaves a pressure as it is.\n\n"
		"Errors: ``ValueError`` for parameters, ``RuntimeError`` for what is missing.\n\n"
		"Example::\n\n\tSoilStressServo(measure=SoilMeasure(membrane=m,bottomPlaten=0,topPlaten=1),drive=top,stress=100e3,timeConstant=.01)",
		((shared_ptr<SoilMeasure>,measure,,,"What is measured. Required."))
		((shared_ptr<PlatenDrive>,drive,,,"The platen's drive, which gets its stress from here: the axial stress is closed. Or give pressure."))
		((shared_ptr<MembranePressure>,pressure,,,"The main body's pressure, which is set from here: the radial stress is closed."))
		((shared_ptr<MembraneRadialServo>,beside,,,"With pressure: the servo beside the platens, which gets the same; none: there are no such rows."))
		((Real,stress,NaN,,"Stress that the soil is to have [Pa], compression positive, > 0. Required."))
		((Real,timeConstant,NaN,,"Time constant T [s], two time steps at least. Required. 10 times d sqrt(ρ/σ) is slow and safe."))
		((Real,maxFactor,1.5,,"Largest factor, and the inverse of the smallest [-]; above 1."))
		((Real,tolerance,HEXMEMBRANE_SERVO_TOLERANCE_DEFAULT,,"Relative error of the soil's stress below which the loop counts as settled [-], " HEXMEMBRANE_SERVO_TOLERANCE_RANGE "."))
		((Real,timeLimit,NaN,,"Time after a change of stress [s] within which it must have settled once, else the run stops with an error; NaN: none."))
		((Real,factor,1,Attr::readonly,"Present factor f [-]."))
		((Real,measured,NaN,Attr::readonly,"The soil's stress at the last correction [Pa], compression positive."))
		((bool,saturated,false,Attr::readonly,"The loop stands at one of its limits: the target cannot be reached."))
		((bool,settled,false,Attr::readonly,"Whether the soil's stress has been within the tolerance since stress changed."))
		((Real,lastCorrection,NaN,(Attr::readonly|Attr::hidden),"Time of the last correction [s]."))
		((Real,changedTo,NaN,Attr::hidden,""))
		((Real,changeTime,NaN,Attr::hidden,""))
	);
	// clang-format on
};
REGISTER_SERIALIZABLE(SoilStressServo);

} // namespace yade
