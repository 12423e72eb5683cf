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

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS(PlatenDrive,GlobalEngine,"Moves one :yref:`Platen` along a fixed direction, at a given velocity or so that it carries a given stress, and records what it meets. All degrees of freedom of the body are blocked and its velocity is set every step, so :yref:`NewtonIntegrator` only advances its position.\n\nPlace: after every engine that adds forces, before :yref:`NewtonIntegrator` (the other order is an error).\n\n**Velocity.** $v(t)=v_0+(v_1-v_0)\\frac12(1-\\cos\\pi t/T)$ from the velocity $v_0$ of that moment to :yref:`velocity<PlatenDrive.velocity>` $v_1$ within $T=$ :yref:`rampTime<PlatenDrive.rampTime>`. A new velocity, stress, mode, area or direction starts a new ramp, from the present velocity. A velocity, stress or area that changes while a ramp runs adds a ramp of its own from that moment, and ramps that run together add up: the velocity has no jump, and one that is set every step is followed $T/2$ behind.\n\n**Stress.** The platen is a body of mass $m$ on a dashpot $c$, pushed by $\\sigma A$ and pushed back by the specimen: $m\\dot v=\\sigma A-F-cv$. With $K$ the stiffness of its contacts along the direction (summed every step) and $\\Delta t$ the step, $m=4K\\Delta t^2$ and $c=2\\zeta\\sqrt{Km}$, which is stable for any stiffness; and $v\\le 0.01\\sigma A/(K\\Delta t)$, so that at most 1 % of the target arrives in a step. While nothing touches it the platen advances at :yref:`maxVelocity<PlatenDrive.maxVelocity>`. Within :yref:`rampTime<PlatenDrive.rampTime>` the force goes from that of the moment to $\\sigma A$ and the velocity from that of the moment to the servo's. A platen that has to keep moving carries $cv=4\\zeta K\\Delta t\\,v$ less than the target; at rest the error vanishes.\n\n**Records**, positive when the specimen is compressed: :yref:`force<PlatenDrive.force>`, :yref:`displacement<PlatenDrive.displacement>`, :yref:`work<PlatenDrive.work>`. In the way of leapfrog, positions and contact forces belong to the same instant, so $W\\mathrel{+}=\\frac12(F_n+F_{n+1})(x_{n+1}-x_n)$. With :yref:`O.trackEnergy<Omega.trackEnergy>` the work is booked as ``platenWork``, negative like YADE's other work from outside. The state is saved: a run that is saved and loaded goes on as if it had not been.\n\nA platen may be tilted before the first step; it keeps its tilt. One that is turned between two steps is an error: its work would be booked nowhere.\n\nErrors in the first step that has them: a missing or erased body, one that is no Platen or a clump's, an unknown mode, values that are missing, not finite or have the wrong sign. Example::\n\n\tPlatenDrive(platen=top,direction=(0,0,-1),mode='stress',stress=100e3,rampTime=.01)",
		((Body::id_t,platen,-1,,"Id of the :yref:`Platen` body, required."))
		((Vector3r,direction,Vector3r(NaN,NaN,NaN),,"Direction into the specimen, any length but zero, required: (0,0,-1) for a top platen."))
		((std::string,mode,"velocity",,"'velocity' or 'stress'."))
		((Real,velocity,NaN,,"Velocity along the direction [m/s], positive compresses; required in mode 'velocity'."))
		((Real,stress,NaN,,"Axial stress to hold [Pa], compression positive, > 0; required in mode 'stress'."))
		((Real,area,NaN,,"Area that the stress acts on [m²]; NaN: the face, $\\pi R^2$."))
		((Real,mass,NaN,,"Mass of the platen in mode 'stress' [kg]; NaN: $4K\\Delta t^2$."))
		((Real,damping,HEXMEMBRANE_SERVO_DAMPING_DEFAULT,,"Damping ratio $\\zeta$ in mode 'stress', " HEXMEMBRANE_SERVO_DAMPING_RANGE "; 1 is critical for the contacts alone."))
		((Real,contactStiffness,NaN,,"Stiffness $K$ of all contacts together in mode 'stress' [N/m], for contact laws whose IPhys is no :yref:`NormPhys`; NaN: $\\sum k_n(n\\cdot d)^2+k_s(1-(n\\cdot d)^2)$ over the contacts."))
		((Real,maxVelocity,NaN,,"Largest velocity in mode 'stress' [m/s], and the one of the approach; NaN: $10^{-3}\\sqrt{\\sigma/\\rho}$, 6 mm/s for sand at 100 kPa, with $\\rho$ the median by volume of the densities of the scene's movable spheres: that of the grains, also beside a membrane of another density."))
		((Real,rampTime,0,,"Duration of every change [s], >= 0; 0: at once."))
		((Real,tolerance,HEXMEMBRANE_SERVO_TOLERANCE_DEFAULT,,"Relative error of the force, " HEXMEMBRANE_SERVO_TOLERANCE_RANGE ", below which the servo counts as :yref:`settled<PlatenDrive.settled>`."))
		((Real,timeLimit,NaN,,"Time after a change [s] within which mode 'stress' must have settled once, else the run stops with an error; NaN: none."))
		((Real,force,NaN,Attr::readonly,"Force on the platen against the direction [N], positive when the specimen pushes back, of the last step. |yupdate|"))
		((Real,displacement,0,Attr::readonly,"Way along the direction since the first step [m]. |yupdate|"))
		((Real,work,0,Attr::readonly,"Work done on the specimen [J]. |yupdate|"))
		((Real,stiffness,0,Attr::readonly,"Stiffness K of the contacts in mode 'stress' [N/m], 0 while nothing touches. |yupdate|"))
		((bool,settled,false,Attr::readonly,"Whether, in mode 'stress', the ramp is over and the force is within the tolerance. |yupdate|"))
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
	Real servoStep(Real velocityNow);
	void requireReached(Real newTarget);
};
REGISTER_SERIALIZABLE(PlatenDrive);

} // namespace yade
