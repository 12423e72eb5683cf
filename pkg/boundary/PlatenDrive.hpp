// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "Platen.hpp"

#include "compact/Stepped.hpp"
#include "SharedValues.hpp"

#include <core/Body.hpp>
#include <core/GlobalEngine.hpp>

#include <string>

namespace yade {

class PlatenDrive : public GlobalEngine, public Stepped {
public:
	void action() override;

	void prepare() override;
	void step(StepView& view) override;
	bool mayBeSeveral() const override { return true; }
	void requireReferenceScene() const override;
	//! Share of the target force that the platen carried in its last step, NaN when that was none under stress.
	Real carried() const { return phaseMode == "stress" ? force / phaseTarget : NaN; }

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS(PlatenDrive,GlobalEngine,
		"Moves one Platen along a fixed direction, at a given velocity or so that it carries a given stress, and records what it meets. "
		"All degrees of freedom of the body are blocked and its velocity is set every step, so NewtonIntegrator only advances its position.\n\n"
		"Place: after every engine that adds forces, before NewtonIntegrator (the other order is an error).\n\n"
		"**Velocity.** v(t) = v0 + (v1 - v0) (1 - cos(π t/T))/2 from the velocity v0 of that moment to velocity v1 within T = rampTime. "
		"A new velocity, stress, mode, area or direction starts a new ramp, from the present velocity. "
		"A velocity, stress or area that changes while a ramp runs adds a ramp of its own from that moment, and ramps that run together add up: "
		"the velocity has no jump, and one that is set every step is followed T/2 behind.\n\n"
		"**Stress.** The platen is a body of mass m on a dashpot c, pushed by σ A and pushed back by the specimen: m dv/dt = σ A - F - c v. "
		"With K the stiffness of its contacts along the direction (summed every step) and Δt the step, m = 4 K Δt² and c = 2 ζ sqrt(K m), "
		"which is stable for any stiffness. With M the mass of the touching spheres, v <= 0.05 σ A/sqrt(K M) and v <= 0.1 σ A/(K Δt): "
		"what the platen meets answers with a twentieth of the target at most, and at most a tenth arrives in a step. "
		"While nothing touches it the platen advances at maxVelocity. "
		"Within rampTime the force goes from that of the moment to σ A and the velocity from that of the moment to the servo's. "
		"A platen that has to keep moving carries c v = 4 ζ K Δt v less than the target; at rest the error vanishes.\n\n"
		"**Records**, positive when the specimen is compressed: force, displacement, work. "
		"In the way of leapfrog, positions and contact forces belong to the same instant, so W += (F(n) + F(n+1)) (x(n+1) - x(n))/2. "
		"With O.trackEnergy the work is booked as ``platenWork``, negative like YADE's other work from outside. The state is saved: "
		"a run that is saved and loaded goes on as if it had not been.\n\n"
		"A platen may be tilted before the first step; it keeps its tilt. One that is turned between two steps is an error: "
		"its work would be booked nowhere.\n\n"
		"Errors in the first step that has them: a missing or erased body, one that is no Platen or a clump's, an unknown mode, "
		"values that are missing, not finite or have the wrong sign. Example::\n\n"
		"\tPlatenDrive(platen=top,direction=(0,0,-1),mode='stress',stress=100e3,rampTime=.01)",
		((Body::id_t,platen,-1,,"Id of the Platen body, required."))
		((Vector3r,direction,Vector3r(NaN,NaN,NaN),,"Direction into the specimen, any length but zero, required: (0,0,-1) for a top platen."))
		((std::string,mode,"velocity",,"'velocity' or 'stress'."))
		((Real,velocity,NaN,,"Velocity along the direction [m/s], positive compresses; required in mode 'velocity'."))
		((Real,stress,NaN,,"Axial stress to hold [Pa], compression positive, > 0; required in mode 'stress'."))
		((Real,area,NaN,,"Area that the stress acts on [m²]; NaN: the face, π R²."))
		((Real,mass,NaN,,"Mass of the platen in mode 'stress' [kg]; NaN: 4 K Δt²."))
		((Real,damping,HEXMEMBRANE_SERVO_DAMPING_DEFAULT,,"Damping ratio ζ in mode 'stress', " HEXMEMBRANE_SERVO_DAMPING_RANGE
			"; 1 is critical for the contacts alone."))
		((Real,contactStiffness,NaN,,"Stiffness K of all contacts together in mode 'stress' [N/m], for contact laws whose IPhys is no NormPhys; NaN: "
			"Σ kn (n·d)² + ks (1 - (n·d)²) over the contacts."))
		((Real,maxVelocity,NaN,,"Largest velocity in mode 'stress' [m/s], and the one of the approach; NaN: "
			"1e-3 sqrt(σ/ρ), 6 mm/s for sand at 100 kPa, with ρ the median by volume of the densities of the scene's movable spheres: "
			"that of the grains, also beside a membrane of another density."))
		((Real,rampTime,0,,"Duration of every change [s], >= 0; 0: at once."))
		((Real,tolerance,HEXMEMBRANE_SERVO_TOLERANCE_DEFAULT,,"Relative error of the force, " HEXMEMBRANE_SERVO_TOLERANCE_RANGE
			", below which the servo counts as settled."))
		((Real,timeLimit,NaN,,"Time after a change [s] within which mode 'stress' must have settled once, else the run stops with an error; NaN: none."))
		((Real,force,NaN,Attr::readonly,"Force on the platen against the direction [N], positive when the specimen pushes back, of the last step."))
		((Real,displacement,0,Attr::readonly,"Way along the direction since the first step [m]."))
		((Real,work,0,Attr::readonly,"Work done on the specimen [J]."))
		((Real,stiffness,0,Attr::readonly,"Stiffness K of the contacts in mode 'stress' [N/m], 0 while nothing touches."))
		((bool,settled,false,Attr::readonly,"Whether, in mode 'stress', the ramp is over and the force is within the tolerance."))
		// Since mode or direction changed, or the target while no ramp was running: what it goes to, how long that takes, how old it is, where it
		// started. The ramps that are running (see kernels/boundary/OverlappingRamps.hpp), and how old the last change is.
		((std::string,phaseMode,"",Attr::hidden,""))
		((Vector3r,phaseDirection,Vector3r::Zero(),Attr::hidden,""))
		((Real,phaseTarget,NaN,Attr::hidden,""))
		((Real,phaseDuration,0,Attr::hidden,""))
		((Real,phaseTime,0,Attr::hidden,""))
		((Real,phaseVelocity,0,Attr::hidden,""))
		((vector<Vector3r>,ramps,,Attr::hidden,""))
		((Real,changeTime,0,Attr::hidden,""))
		((Real,phaseApproach,NaN,Attr::hidden,""))
		((bool,phaseSettled,false,Attr::hidden,""))
		// The step before this one.
		((long,lastIter,-2,Attr::hidden,""))
		((Vector3r,lastPosition,Vector3r::Zero(),Attr::hidden,""))
		((Quaternionr,lastOrientation,Quaternionr::Identity(),Attr::hidden,""))
		((int,energyIndex,-1,(Attr::hidden|Attr::noSave),""))
	);
	// clang-format on

private:
	State& requirePlaten() const;
	void requireSettings() const;
	Real target(const Platen& shape) const;
	void record(const State& state, Real newForce, const Vector3r& unit);
	void beginPhase(Real newTarget, const State& state, const Vector3r& unit);
	void changeTarget(Real newTarget);
	Real approachVelocity() const;
	Real servoStep(Real velocityNow, Real touchingMass);
	void requireReached(Real newTarget);
};
REGISTER_SERIALIZABLE(PlatenDrive);

} // namespace yade
