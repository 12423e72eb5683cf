// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "HexMembrane.hpp"

#include <core/GlobalEngine.hpp>

namespace yade {

/*! Holds the O-ring rows (group 1) in space or lets them ride with the platens. */
class MembraneORings : public GlobalEngine {
public:
	void action() override;

	//! Velocities of the lower and the upper rows. \throws std::invalid_argument, std::runtime_error for what is set wrong
	std::pair<Vector3r, Vector3r> velocities() const;

private:
	const Body& platen(Body::id_t id, const char* name) const;

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS(MembraneORings,GlobalEngine,
		"Motion of the O-ring rows (group 1) of a :yref:`HexMembrane`. Their particles are blocked in all degrees of freedom; this engine sets their velocity every step. Stands after the platens' drives and before :yref:`NewtonIntegrator`.\n\n"
		"mode 'fixed': held in space throughout (the source study). 'platens': the lower rows move with bottomPlaten, the upper ones with topPlaten, as O-rings on the caps of a triaxial cell do. "
		"(A platen whose velocity the integrator changes in the same step leads them by one step's velocity change; this does not accumulate.)\n\n"
		"Errors: ``ValueError`` for an unknown mode, ``RuntimeError`` for a membrane not generated, a platen that is not there.\n\n"
		"Example::\n\n\tMembraneORings(membrane=m,mode='platens',bottomPlaten=lower,topPlaten=upper)",
		((shared_ptr<HexMembrane>,membrane,,,"The membrane. Required."))
		((string,mode,"fixed",,"'fixed' or 'platens'."))
		((Body::id_t,bottomPlaten,-1,,"Id of the body that the lower rows ride on (mode 'platens')."))
		((Body::id_t,topPlaten,-1,,"Id of the body that the upper rows ride on (mode 'platens')."))
	);
	// clang-format on
};
REGISTER_SERIALIZABLE(MembraneORings);

} // namespace yade
