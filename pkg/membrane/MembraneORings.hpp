// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "HexMembrane.hpp"

#include "compact/Stepped.hpp"
#include "SharedValues.hpp"

#include <core/GlobalEngine.hpp>

namespace yade {

/*! Holds the O-ring rows (group 1) in space or lets them ride with the platens. */
class MembraneORings : public GlobalEngine, public Stepped {
public:
	void action() override;

	void prepare() override;
	void step(StepView& view) override;
	void bookWorks() override;
	const HexMembrane* actsOn() const override { return membrane.get(); }

	Real work_get() const { return meter->work; }

private:
	const Body& platen(Body::id_t id, const char* name) const;

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(MembraneORings,GlobalEngine,
		"Motion of the O-ring rows (group 1) of a HexMembrane. Their particles are blocked in all degrees of freedom; "
		"this engine sets their velocity every step. Stands after all engines that add forces and after the platens' drives, "
		"and before NewtonIntegrator.\n\n"
		"mode 'fixed': held in space throughout (the source study). 'platens': "
		"the lower rows move with bottomPlaten, the upper ones with topPlaten, as O-rings on the caps of a triaxial cell do. "
		"(A platen whose velocity the integrator changes in the same step leads them by one step's velocity change; this does not accumulate.)\n\n"
		"The grip on a particle is what moves it in spite of the forces f that bonds and contacts exert on it, m dv/dt - f; "
		"its work is booked, and with O.trackEnergy minus the work is entered as 'oRingWork'. "
		"Gripped particles are taken out of local damping (State.isDamped): "
		"nothing damps a prescribed motion, but NewtonIntegrator would book it in 'nonviscDamp'.\n\n"
		"Errors: ``ValueError`` for an unknown mode, ``RuntimeError`` for a membrane not generated, a platen that is not there, "
		"a place behind NewtonIntegrator.\n\n"
		"Example::\n\n\tMembraneORings(membrane=m,mode='platens',bottomPlaten=lower,topPlaten=upper)",
		((shared_ptr<HexMembrane>,membrane,,,"The membrane. Required."))
		((string,mode,HEXMEMBRANE_O_RING_MODE_DEFAULT,,"'fixed' or 'platens'."))
		((Body::id_t,bottomPlaten,-1,,"Id of the body that the lower rows ride on (mode 'platens')."))
		((Body::id_t,topPlaten,-1,,"Id of the body that the upper rows ride on (mode 'platens')."))
		((shared_ptr<WorkMeter>,meter,new WorkMeter,(Attr::readonly|Attr::hidden),"Work of the grip."))
		,/*ctor*/,
		.add_property("work",&MembraneORings::work_get,
			"Work done by the O-rings on the membrane so far [J]: against the forces on its gripped particles, trapezoidal in force and displacement, "
			"and what these particles gained in kinetic energy; positive when the O-rings stretch the membrane.")
	);
	// clang-format on
};
REGISTER_SERIALIZABLE(MembraneORings);

} // namespace yade
