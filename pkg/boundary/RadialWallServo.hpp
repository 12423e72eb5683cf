// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "CylinderWall.hpp"

#include "compact/Stepped.hpp"
#include "SharedValues.hpp"

#include <core/Body.hpp>
#include <core/GlobalEngine.hpp>

namespace yade {

/*! Holds the mean radial stress on a CylinderWall by moving its radius. */
class RadialWallServo : public GlobalEngine, public Stepped {
public:
	void action() override;

	void prepare() override;
	void step(StepView& view) override;
	void requireReferenceScene() const override;

private:
	CylinderWall& requireWall() const;
	Real specimenHeight() const;
	void requireSettings() const;
	void requireReached(Real target);

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS(RadialWallServo,GlobalEngine,
		"Servo of the study's rigid wall: holds the mean radial stress on a CylinderWall at a target while only the radius moves. "
		"Stands after every engine that adds forces and before NewtonIntegrator.\n\n"
		"Mean radial stress σr = Σ Fn/(2 π R h) over the wall's contacts, h the specimen's present height: "
		"the distance of the facing sides of two Platens, or given.\n\n"
		"The radius is the one degree of freedom of a mass m on a dashpot c, pushed inwards by 2 π R h σ and back by the specimen, "
		"with the recipe of PlatenDrive: m = 4 K Δt², c = 2 ζ sqrt(K m) with K the summed stiffness of the wall's contacts, "
		"and the same limits of the velocity. Stable for any stiffness. While nothing touches it the wall closes at maxVelocity. "
		"Once it has reached its target and stopped closing, the dashpot lets the mean velocity of the last 100 steps pass, so that a wall that keeps moving carries its target all the same. "
		"A specimen of stiff grains that is sheared fast pushes the wall outwards faster than these limits: give maxRetreat then. "
		"A wall that would have to move faster still does not carry its target: see atLimit.\n\n"
		"With O.trackEnergy the work is booked as 'wallWork', negative like YADE's other work from outside. All state is saved.\n\n"
		"Errors: a missing or erased wall or platen, a body of another shape, values that are missing or have the wrong sign, "
		"contacts that do not tell their stiffness, a target not reached within timeLimit. Example::\n\n"
		"\tRadialWallServo(wall=id,stress=100e3,bottomPlaten=low,topPlaten=high,maxVelocity=.02)",
		((Body::id_t,wall,-1,,"Id of the CylinderWall body, required."))
		((Real,stress,NaN,,"Mean radial stress to hold [Pa], compression positive, > 0, required; may be changed at any time."))
		((Body::id_t,bottomPlaten,-1,,"Id of the lower Platen; with topPlaten it gives the specimen's height."))
		((Body::id_t,topPlaten,-1,,"Id of the upper Platen."))
		((Real,height,NaN,,"Height of the specimen [m], when no platens are given."))
		((Real,damping,HEXMEMBRANE_SERVO_DAMPING_DEFAULT,,"Damping ratio ζ, " HEXMEMBRANE_SERVO_DAMPING_RANGE "; 1 is critical for the contacts alone."))
		((Real,maxVelocity,NaN,,"Largest velocity of the radius [m/s], and the one of the approach. Required."))
		((Real,maxRetreat,NaN,,"Largest velocity of the radius outwards [m/s]; NaN: the limits inwards."))
		((Real,tolerance,HEXMEMBRANE_SERVO_TOLERANCE_DEFAULT,,"Relative error of the stress, " HEXMEMBRANE_SERVO_TOLERANCE_RANGE
			", below which the servo counts as settled."))
		((Real,timeLimit,NaN,,
			"Time [s] after the start or a change of the target within which the servo must have settled once, else the run stops with an error; NaN: "
			"none."))
		((Real,velocity,0,Attr::readonly,"Velocity of the radius, positive inwards [m/s]."))
		((Real,flow,0,Attr::readonly,"Mean velocity of the last 100 steps [m/s], positive inwards, that the dashpot lets pass; 0 until the target was reached."))
		((bool,atLimit,false,Attr::readonly,"Whether the wall had reached its stress and now moves at a limit of its velocity, so that the stress may be another than asked for."))
		((Real,radialStress,NaN,Attr::readonly,"Mean radial stress at the last step [Pa], compression positive."))
		((Real,stiffness,0,Attr::readonly,"Summed normal stiffness of the wall's contacts [N/m]."))
		((bool,settled,false,Attr::readonly,"Whether the stress is within the tolerance."))
		((Real,work,0,Attr::readonly,"Work done on the specimen [J], trapezoidal."))
		((Real,lastForce,0,Attr::hidden,""))
		((Real,lastRadius,NaN,Attr::hidden,""))
		((long,lastIter,-2,Attr::hidden,""))
		((Real,phaseTarget,NaN,Attr::hidden,""))
		((Real,phaseTime,0,Attr::hidden,""))
		((bool,phaseSettled,false,Attr::hidden,""))
		((bool,phaseReached,false,Attr::hidden,""))
		((int,energyIndex,-1,(Attr::hidden|Attr::noSave),""))
	);
	// clang-format on
};
REGISTER_SERIALIZABLE(RadialWallServo);

} // namespace yade
