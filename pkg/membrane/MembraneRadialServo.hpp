// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "HexMembrane.hpp"
#include "PressureLoop.hpp"
#include "PressureRamp.hpp"

#include "compact/Stepped.hpp"
#include "kernels/membrane/PaddedRings.hpp"
#include "kernels/membrane/RadialForce.hpp"
#include "SharedValues.hpp"

#include <core/GlobalEngine.hpp>

namespace yade {

/*! Radial force on each particle beside the platens (group 2), open or closed loop. */
class MembraneRadialServo : public GlobalEngine, public Stepped {
public:
	void action() override;

	void prepare() override;
	void step(StepView& view) override;
	void bookWorks() override;
	const HexMembrane* actsOn() const override { return membrane.get(); }

	//! Pressure that the ramps have come to (Pa).
	Real ramped() const { return rampedPressure(pressure, rampTime, rampTarget, ramps); }
	Real work_get() const { return meter->work; }

private:
	PressureLoop loop();

	vector<int> rows;               //!< rings of group 2, after prepare()
	hexmembrane::PaddedRings force; //!< on them
	hexmembrane::AreaRule rule = hexmembrane::AreaRule::tributary;

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(MembraneRadialServo,GlobalEngine,
		"Confining pressure on the rows beside the platens (group 2 of a HexMembrane): "
		"a horizontal force on each particle toward the present axis of its ring, F = f σ3 A nr (Eq. 2 of the source study). "
		"Stands before NewtonIntegrator.\n\n"
		"Area A of a particle: 'tributary' (default), its share of the ring's present inner surface, 2 π (r - R)/n, "
		"with r the ring's mean radius times half the distance of the neighbouring rings; "
		"'cube', the source study's (2 R)², 15.47 % more than the lattice has.\n\n"
		"Open loop with an infinite timeConstant T (default): f = 1. With a finite one an integral controller closes the loop, "
		"T df/dt = (σ3 - pt)/σ3 with pt the mean pressure that group 2 transmits (HexMembrane.transmittedPressure), "
		"within 0 and maxFactor. It is corrected 20 times within T. Choose T so that the contacts answer meanwhile: 4 times d sqrt(ρ/p) is slow and safe.\n\n"
		"Positive pressure pushes toward the axis. With O.trackEnergy minus the work is entered as 'radialServoWork'.\n\n"
		"Errors: ``ValueError`` for parameters, ``RuntimeError`` for a membrane not generated or without group 2, a body erased.\n\n"
		"Example::\n\n\tMembraneRadialServo(membrane=m,pressure=100e3)",
		((shared_ptr<HexMembrane>,membrane,,,"The membrane. Required."))
		((Real,pressure,NaN,,"Pressure σ3 [Pa], positive inwards; may be changed at any time. Required."))
		((Real,rampTime,0,,"Duration of every change of the pressure [s], as MembranePressure.rampTime; give both the same."))
		((string,areaRule,HEXMEMBRANE_AREA_RULE_DEFAULT,,"'tributary' or 'cube', see above."))
		((Real,timeConstant,std::numeric_limits<Real>::infinity(),,"Time constant T of the closed loop [s], two time steps at least; inf: open loop."))
		((Real,maxFactor,2,,"Largest factor f that the closed loop may reach [-]."))
		((Real,factor,1,Attr::readonly,"Present factor f [-]."))
		((bool,saturated,false,Attr::readonly,"The closed loop stands at one of its limits: the target cannot be reached."))
		((Real,transmitted,NaN,Attr::readonly,"Mean transmitted pressure of group 2 at the last correction [Pa] (closed loop only)."))
		((Real,area,NaN,Attr::readonly,"Sum of the particles' areas at the last step [m²]."))
		((Real,rampTarget,0,(Attr::readonly|Attr::hidden),"Pressure asked for at the last step [Pa]."))
		((vector<Vector3r>,ramps,,(Attr::readonly|Attr::hidden),"Changes that are under way: size [Pa], age [s], duration [s]."))
		((Real,lastCorrection,NaN,(Attr::readonly|Attr::hidden),"Time of the last correction [s]."))
		((shared_ptr<WorkMeter>,meter,new WorkMeter,(Attr::readonly|Attr::hidden),"Work of the forces."))
		,/*ctor*/,
		.add_property("work",&MembraneRadialServo::work_get,"Work done by the forces so far [J], trapezoidal.")
	);
	// clang-format on
};
REGISTER_SERIALIZABLE(MembraneRadialServo);

} // namespace yade
