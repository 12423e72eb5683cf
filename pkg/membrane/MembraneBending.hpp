// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "MembraneBonds.hpp"

#include "compact/Stepped.hpp"

#include "kernels/membrane/BendingForce.hpp"

#include <core/GlobalEngine.hpp>

#include <memory>

namespace yade {

/*! Bending stiffness of the sheet over flat arrays: all that it depends on are positions and how the membrane was generated. */
class MembraneBending : public GlobalEngine, public Stepped {
public:
	void action() override;

	Real elasticEnergy() const;
	Real criticalTimeStep() const;
	Real springStiffness() const;
	vector<Real> axialTension(const vector<Real>& heights) const;
	Real radialShare(int group) const;

	void prepare() override;
	void step(StepView& view) override;
	void bookStored() override;
	void addAnswer(const hexmembrane::PaddedRings& displacement, hexmembrane::PaddedRings& sum) const override;
	const HexMembrane* actsOn() const override { return membrane.get(); }

private:
	void requireMembrane(const string& who) const;
	void requireStepped(const char* what) const;

	// Caches: rebuilt from the attributes when they are missing or other than when they were built.
	std::unique_ptr<hexmembrane::BendingForce> kernel;
	Real built = NaN;
	const HexMembrane* builtFor = nullptr;
	int energyIndex = -1, freedIndex = -1;
	void tear(StepView& view);
	int torn = -1;  //!< broken bonds that the kernel knows of; -1: it is new
	Real freed = 0; //!< by bonds that broke in this step (J)

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(MembraneBending,GlobalEngine,
		"Bending stiffness of a HexMembrane, beside MembraneBonds. Stands before NewtonIntegrator.\n\n"
		"A linear plate on the lattice, E = kb/2 Σ |B x_i - b0_i|² with B x_i = x_i - (x_1 + ... "
		"+ x_6)/6 over the six neighbours and b0 that of the generated membrane, which is free of moments. "
		"The forces are -kb Bᵀ (B x - b0). For neighbours at the distance s = 2 R the energy of an area is that of a plate, "
		"D/2 (κ1 + κ2)² with D = kb s²/(8 sqrt(3)). "
		"The two end rings have no six neighbours: the ends carry no moment.\n\n"
		"b0 keeps its direction in space, so what turns the surface by an angle a meets a pressure of the order a D/Rc³, "
		"with Rc the radius through the centres: 0.5 Pa for latex of 0.3 mm (D = 4e-6 N m, Rc = 20 mm). "
		"The term D (1 - ν) of the Gaussian curvature is left out: it acts at free edges only, and a saddle with κ1 = -κ2 costs nothing.\n\n"
		"With O.trackEnergy the elastic energy is entered as 'elastBending'. Forces are the same to the last bit for any number of threads.\n\n"
		"Errors: ``ValueError`` for parameters, ``RuntimeError`` for a membrane not generated, a body erased, "
		"a force that is not finite (with body id and iteration).\n\n"
		"Example::\n\n\tMembraneBending(membrane=m,stiffness=5e-5)",
		((shared_ptr<HexMembrane>,membrane,,,"The membrane. Required."))
		((Real,stiffness,NaN,,"Bending stiffness D of the plate [N m], at least 0; of a sheet of thickness t: E t³/(12 (1 - ν²)). Required."))
		((shared_ptr<MembraneBonds>,bonds,,,
			"The membrane's bonds, when they may break: a particle that has lost a bond bends nothing any more. None: the sheet does not tear."))
		,/*ctor*/,
		.add_property("springStiffness",&MembraneBending::springStiffness,"kb = 8 sqrt(3) D/(2 R)² [N/m].")
		.def("elasticEnergy",&MembraneBending::elasticEnergy,"Elastic energy of the bending [J] at the last step.")
		.def("axialTension",&MembraneBending::axialTension,(boost::python::arg("heights")),
			"Axial force [N] that the bending carries through the horizontal plane at each of the heights [m], at the last step, tension positive: "
			"minus the axial forces on the particles that are not below it now; adds to MembraneBonds.axialTension.")
		.def("radialShare",&MembraneBending::radialShare,(boost::python::arg("group")=3),
			"Pressure [Pa] that the bending adds to what reaches the soil at a group (0: all of groups 2 and 3), inwards positive: "
			"the forces of the last step over the present area; adds to MembraneBonds.radialShare.")
		.def("criticalTimeStep",&MembraneBending::criticalTimeStep,
			"Critical time step [s] of the bending alone, 2/ω with ω² = 2.25 kb/m; inf without stiffness. A lower bound; "
			"that of bending and bonds together has at least the sum of both ω².")
	);
	// clang-format on
};
REGISTER_SERIALIZABLE(MembraneBending);

} // namespace yade
