// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "SoilMeasure.hpp"

#include "boundary/PlatenDrive.hpp"
#include "membrane/PressureLoop.hpp"

namespace yade {

/*! Closes a platen's stress on the axial stress that the soil itself has. */
class AxialStressServo : public GlobalEngine, public Stepped {
public:
	void action() override;

	void prepare() override;
	void step(StepView& view) override;
	const HexMembrane* actsOn() const override { return measure ? measure->membrane.get() : nullptr; }

private:
	PressureLoop loop();
	void requireReached();

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS(AxialStressServo,GlobalEngine,
		"Brings the axial stress in the middle half of the soil, from its own contacts (:yref:`SoilMeasure`), to a target, by the stress that a :yref:`PlatenDrive` in mode 'stress' holds. Stands before that drive.\n\n"
		"A platen that carries $\\sigma_3 A_e$ does not give the soil an axial stress of $\\sigma_3$: the membrane's inner surface encloses less than the platen's face, the membrane pulls at the O-rings, and rows beside the platens that are pressed radially have no axial share. "
		"An integral controller multiplies the drive's stress by a factor $f$: $T\\dot f=(\\sigma-\\sigma_a)/\\sigma$ with $\\sigma_a$ the soil's axial stress, within 1/:yref:`maxFactor<AxialStressServo.maxFactor>` and maxFactor, corrected 20 times within $T$; the drive gets $f\\sigma$ in every step. The factor waits while the drive is not :yref:`settled<PlatenDrive.settled>`: what the platen does not carry yet is no error of it. It rests while the drive is in mode 'velocity'.\n\n"
		"Errors: ``ValueError`` for parameters, ``RuntimeError`` for what is missing.\n\n"
		"Example::\n\n\tAxialStressServo(measure=SoilMeasure(membrane=m,bottomPlaten=0,topPlaten=1),drive=top,stress=100e3,timeConstant=.01)",
		((shared_ptr<SoilMeasure>,measure,,,"What is measured. Required."))
		((shared_ptr<PlatenDrive>,drive,,,"The platen's drive, which gets its stress from here. Required."))
		((Real,stress,NaN,,"Axial stress that the soil is to have [Pa], compression positive, > 0. Required."))
		((Real,timeConstant,NaN,,"Time constant $T$ [s], two time steps at least. Required. 10 times $d\\sqrt{\\rho/\\sigma}$ is slow and safe."))
		((Real,maxFactor,1.5,,"Largest factor, and the inverse of the smallest [-]; above 1."))
		((Real,tolerance,0.01,,"Relative error of the soil's axial stress below which the loop counts as settled [-], > 0."))
		((Real,timeLimit,NaN,,"Time after a change of :yref:`stress<AxialStressServo.stress>` [s] within which the loop must have settled once, else the run stops with an error; NaN: none."))
		((Real,factor,1,Attr::readonly,"Present factor $f$ [-]."))
		((Real,axialStress,NaN,Attr::readonly,"The soil's axial stress at the last correction [Pa], compression positive."))
		((bool,saturated,false,Attr::readonly,"The loop stands at one of its limits: the target cannot be reached."))
		((bool,settled,false,Attr::readonly,"Whether the soil's axial stress has been within the tolerance since stress changed."))
		((Real,lastCorrection,NaN,(Attr::readonly|Attr::hidden),"Time of the last correction [s]."))
		((Real,changedTo,NaN,Attr::hidden,""))
		((Real,changeTime,NaN,Attr::hidden,""))
	);
	// clang-format on
};
REGISTER_SERIALIZABLE(AxialStressServo);

} // namespace yade
