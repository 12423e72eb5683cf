// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "HexMembrane.hpp"
#include "kernels/membrane/PaddedRings.hpp"
#include "kernels/membrane/RadialForce.hpp"

#include <core/GlobalEngine.hpp>

#include <functional>

namespace yade {

/*! Radial force on each particle beside the platens (group 2), open or closed loop. */
class MembraneRadialServo : public GlobalEngine {
public:
	void action() override;

	// In parts, for an engine that steps the membrane itself: prepare() once, then computeForces() each step.
	//! \throws std::invalid_argument, std::runtime_error for what is set wrong
	void prepare();
	//! Corrects the factor when it is due, by the mean pressure that group 2 transmits; then `force` on its rings at these positions.
	void computeForces(const hexmembrane::PaddedRings& positions, const std::function<Real()>& transmittedNow);
	//! Enters `work` into the scene's energies, once an iteration.
	void bookWork();

	vector<int> rows;               //!< rings of group 2, after prepare()
	hexmembrane::PaddedRings force; //!< on them, after computeForces()

private:
	void correct(Real measured);

	hexmembrane::PaddedRings positions; //!< all particles
	hexmembrane::AreaRule rule = hexmembrane::AreaRule::tributary;
	int energyIndex = -1;

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS(MembraneRadialServo,GlobalEngine,
		"Confining pressure on the rows beside the platens (group 2 of a :yref:`HexMembrane`): a horizontal force on each particle toward the present axis of its ring, $F=f\\,\\sigma_3 A\\,n_r$ (Eq. 2 of the source study). Stands before :yref:`NewtonIntegrator`.\n\n"
		"Area $A$ of a particle: 'tributary' (default), its share of the ring's present inner surface, $2\\pi(\\bar r-R)/n$ times half the distance of the neighbouring rings; 'cube', the source study's $(2R)^2$, 15.47 % more than the lattice has.\n\n"
		"Open loop with gain 0: $f=1$. With a gain the servo closes the loop: every :yref:`iterPeriod<MembraneRadialServo.iterPeriod>` steps $f$ grows by gain times the relative error of the mean pressure that group 2 transmits (:yref:`HexMembrane.transmittedPressure`), "
		"within 0 and :yref:`maxFactor<MembraneRadialServo.maxFactor>`. An integrating controller: choose gain and period so that the contacts answer between two corrections (0.05 every 50 steps is slow and safe).\n\n"
		"Positive pressure pushes toward the axis. With :yref:`O.trackEnergy<Omega.trackEnergy>` minus the work is entered as 'radialServoWork'.\n\n"
		"Errors: ``ValueError`` for parameters, ``RuntimeError`` for a membrane not generated or without group 2, a body erased.\n\n"
		"Example::\n\n\tMembraneRadialServo(membrane=m,pressure=100e3)",
		((shared_ptr<HexMembrane>,membrane,,,"The membrane. Required."))
		((Real,pressure,NaN,,"Pressure $\\sigma_3$ [Pa], positive inwards; may be changed at any time. Required."))
		((string,areaRule,"tributary",,"'tributary' or 'cube', see above."))
		((Real,gain,0,,"Relative correction a period; 0: open loop [-]."))
		((int,iterPeriod,50,,"Steps between two corrections [-]."))
		((Real,maxFactor,2,,"Largest factor $f$ that the closed loop may reach [-]."))
		((Real,factor,1,Attr::readonly,"Present factor $f$ [-]."))
		((bool,saturated,false,Attr::readonly,"The closed loop stands at one of its limits: the target cannot be reached."))
		((Real,transmitted,NaN,Attr::readonly,"Mean transmitted pressure of group 2 at the last correction [Pa] (closed loop only)."))
		((Real,area,NaN,Attr::readonly,"Sum of the particles' areas at the last step [m²]."))
		((Real,work,0,Attr::readonly,"Work done by the forces so far [J], trapezoidal."))
		((vector<Vector3r>,lastForces,,(Attr::readonly|Attr::hidden),"Forces of the last step, for the work."))
		((vector<Vector3r>,lastPositions,,(Attr::readonly|Attr::hidden),"Positions of the last step, for the work."))
		((long,lastIter,-2,(Attr::readonly|Attr::hidden),"Iteration of the last step, for the work: what happens while the engine is dead is not its doing."))
	);
	// clang-format on
};
REGISTER_SERIALIZABLE(MembraneRadialServo);

} // namespace yade
