// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "HexMembrane.hpp"

#include "compact/Stepped.hpp"

#include "kernels/membrane/SelfContact.hpp"

#include <core/GlobalEngine.hpp>

#include <memory>

namespace yade {

/*! Contact of a folded membrane with itself, over flat arrays: all that it depends on are positions. */
class MembraneSelfContact : public GlobalEngine, public Stepped {
public:
	void action() override;

	Real normalStiffness() const;
	Real elasticEnergy() const;
	Real criticalTimeStep() const;
	vector<Real> axialTension(const vector<Real>& heights) const;
	Real radialShare(int group) const;
	vector<Vector2i> pairs() const;
	long listsMade() const { return kernel ? kernel->listsMade() : 0; }

	void prepare() override;
	void step(StepView& view) override;
	void bookStored() override;
	void forEachBond(const VisitBond& visit) const override;
	const HexMembrane* actsOn() const override { return membrane.get(); }

private:
	void requireMembrane(const string& who) const;
	const hexmembrane::SelfContact& computed(const char* what) const;

	// Caches: rebuilt from the attributes when they are missing or other than when they were built.
	std::unique_ptr<hexmembrane::SelfContact> kernel;
	Real built = NaN;
	const HexMembrane* builtFor = nullptr;
	int energyIndex = -1;

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(MembraneSelfContact,GlobalEngine,
		"Contact of a HexMembrane with itself: a sheet that folds does not pass through itself. Stands before NewtonIntegrator; no collider is needed.\n\n"
		"Particles that are no bonded neighbours and whose centres are nearer than 2 R push each other apart with F = kn (2 R - d), "
		"without friction or damping. "
		"In an open sheet, whose second neighbours are 3.46 R apart, nothing touches. "
		"Neighbours in the lattice are left to MembraneBonds, broken bonds too.\n\n"
		"With O.trackEnergy the elastic energy is entered as 'elastSelfContact'. "
		"Forces depend on the positions alone, to the last bit, and are the same for any number of threads.\n\n"
		"Errors: ``ValueError`` for parameters, ``RuntimeError`` for a membrane not generated, a body erased, "
		"a force that is not finite (with body id and iteration).\n\n"
		"Example::\n\n\tMembraneSelfContact(membrane=m)",
		((shared_ptr<HexMembrane>,membrane,,,"The membrane. Required."))
		((Real,kn,NaN,,"Stiffness kn of a contact [N/m], > 0; NaN: that of the membrane's material, a LinearMat, in contact with itself. "
			"Under a pressure p two layers overlap by about 4 R² p/kn."))
		,/*ctor*/,
		.add_property("normalStiffness",&MembraneSelfContact::normalStiffness,"Stiffness of a contact [N/m], as given or from the material.")
		.add_property("pairs",&MembraneSelfContact::pairs,"Pairs of particles that touched at the last step, as indices into HexMembrane.ids, sorted.")
		.add_property("listsMade",&MembraneSelfContact::listsMade,"Times that the list of near pairs was made since the engine was made or loaded.")
		.def("elasticEnergy",&MembraneSelfContact::elasticEnergy,"Elastic energy of all contacts [J] at the last step.")
		.def("axialTension",&MembraneSelfContact::axialTension,(boost::python::arg("heights")),
			"Axial force [N] that the contacts carry through the horizontal plane at each of the heights [m], at the last step, tension positive: "
			"minus the axial forces on the particles that are not below it now; adds to MembraneBonds.axialTension.")
		.def("radialShare",&MembraneSelfContact::radialShare,(boost::python::arg("group")=3),
			"Pressure [Pa] that the contacts add to what reaches the soil at a group (0: all of groups 2 and 3), inwards positive: "
			"the forces of the last step over the present area; adds to MembraneBonds.radialShare.")
		.def("criticalTimeStep",&MembraneSelfContact::criticalTimeStep,
			"Critical time step [s] of the contacts of the last step alone, 2/ω with ω² <= 2 c kn/m and c the most contacts of one particle: "
			"a lower bound. inf while nothing touches; a fold that forms later shortens it.")
	);
	// clang-format on
};
REGISTER_SERIALIZABLE(MembraneSelfContact);

} // namespace yade
