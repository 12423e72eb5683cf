// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <core/Body.hpp>
#include <core/GlobalEngine.hpp>

#include <string>

namespace yade {

class RunawayGuard : public GlobalEngine {
public:
	bool isActivated() override;
	void action() override;

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS(RunawayGuard,GlobalEngine,"Stops a run that has lost a body, with the body's id and the iteration in the message: "
		"when a position, velocity or angular velocity is not finite, when a sphere moves more than maxStep of its own radius in one step, "
		"or when any body is faster than maxVelocity. Of several bodies the one of the lowest id is named, whatever the number of threads.\n\n"
		"It writes nothing, and so cannot overwrite a good state with a bad one: "
		"whoever saves states puts the name of the last one into checkpoint, and the message passes it on.\n\n"
		"Place: last in ``O.engines``, after NewtonIntegrator. It holds no state from step to step.",
		((int,iterPeriod,10,,"Bodies are looked at every so many iterations, >= 1."))
		((Real,maxStep,0.1,,"Largest way of a sphere in one step, over its radius, > 0; NaN: not looked at."))
		((Real,maxVelocity,NaN,,"Largest velocity of any body [m/s], > 0; NaN: not looked at."))
		((std::string,checkpoint,"",,"File of the last state that was kept, for the message."))
	);
	// clang-format on

private:
	std::string complaint(const Body& body) const;
};
REGISTER_SERIALIZABLE(RunawayGuard);

} // namespace yade
