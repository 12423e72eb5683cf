// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "HexMembrane.hpp"

#include "compact/Stepped.hpp"

#include "kernels/membrane/BondForce.hpp"
#include "kernels/contact/ContactLaw.hpp"

#include <core/GlobalEngine.hpp>

#include <memory>

namespace yade {

/*! The membrane's own mechanics over flat arrays: gathers the particles once a step, runs the bond kernel, adds the forces. */
class MembraneBonds : public GlobalEngine, public Stepped {
public:
	void action() override;

	Real elasticEnergy();
	Real criticalTimeStep() const;
	vector<Real> normalForces();
	int brokenCount() const;
	Real normalStiffness() const { return law().kn; }
	Real shearStiffness() const { return law().ks; }
	vector<Real> axialTension(const vector<Real>& heights);
	Real radialShare(int group);

	void prepare() override;
	void step(StepView& view) override;
	void bookStored() override;
	Sheet sheet() override;
	void forEachBond(const VisitBond& visit) const override;
	const HexMembrane* actsOn() const override { return membrane.get(); }
	void requireReferenceScene() const override;

private:
	hexmembrane::BondLaw law() const;
	void requireStepped(const char* what) const;

	// Caches: rebuilt from the attributes when they are missing or other than when they were built.
	std::unique_ptr<hexmembrane::BondForce> kernel;
	hexmembrane::PaddedRings stepped; //!< compact tier: positions that the last step's forces belong to
	hexmembrane::BondLaw built;
	const HexMembrane* builtFor = nullptr;
	vector<Real> restLength;
	//! What the bonds remember: the saved attributes.
	hexmembrane::BondState state() { return {restLength, shearForces, broken}; }
	int energyIndex = -1;

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(MembraneBonds,GlobalEngine,
		"Bonds between the six neighbours of every particle of a HexMembrane, without Interaction objects. Stands before NewtonIntegrator.\n\n"
		"Normal force N = kn (d - L0), tension positive, about the generated distance L0 = 2 R; "
		"with ks > 0 an incremental shear force that includes both spins. "
		"Stiffness either directly as kn and ks, or as young, thickness and poisson of the sheet through the lattice's closed form "
		"E t = 2 sqrt(3) kn (kn + ks)/(3 kn + ks), ν = (kn - ks)/(3 kn + ks); ν lies in [0, 1/3], rubber's 0.5 cannot be had by any such lattice. "
		"With ks = 0 (ν = 1/3) rotations are neither needed nor computed.\n\n"
		"Strengths are PFC's linear contact bond: a bond whose tension exceeds tensileStrength loses both forces; "
		"one whose shear exceeds shearStrength keeps what friction holds in compression; a broken bond carries compression only. "
		"With O.trackEnergy the elastic energy is entered as 'elastMembrane'.\n\n"
		"Bending stiffness: MembraneBending. There is no thickness change. Forces are the same to the last bit for any number of threads; "
		"the sums over contacts that they are added to are not.\n\n"
		"Errors: ``ValueError`` for parameters, ``RuntimeError`` for a membrane not generated, a body erased, "
		"a force that is not finite (with body id and iteration).\n\n"
		"Example::\n\n\tMembraneBonds(membrane=m,young=1.4e6,thickness=.3e-3,poisson=1/3.)",
		((shared_ptr<HexMembrane>,membrane,,,"The membrane. Required."))
		((Real,kn,NaN,,"Normal stiffness of a bond [N/m], with ks; or give young, thickness, poisson: normalStiffness tells what they come to."))
		((Real,ks,NaN,,"Shear stiffness of a bond [N/m]; NaN with kn given: 0."))
		((Real,young,NaN,,"Young's modulus E of the sheet [Pa]."))
		((Real,thickness,NaN,,"Thickness t of the sheet [m]. Only the product E t enters."))
		((Real,poisson,NaN,,"Poisson's ratio ν of the sheet in its plane [-], 0 to 1/3."))
		((Real,tensileStrength,std::numeric_limits<Real>::infinity(),,"Tension at which a bond breaks [N] (PFC: cb_tenf)."))
		((Real,shearStrength,std::numeric_limits<Real>::infinity(),,"Shear force at which a bond breaks [N] (PFC: cb_shearf)."))
		((Real,friction,0,,"Friction coefficient of broken bonds [-]."))
		((bool,tensionOnly,false,,"Carry no compression: a thin latex sheet wrinkles instead. With ks = 0 only."))
		((vector<Vector3r>,shearForces,,Attr::readonly,"Shear force [N] on the first particle of each bond (empty with ks = 0)."))
		((vector<int>,broken,,,"0, or 1 for a broken bond, in the order of HexMembrane.bonds (empty: none is, and nothing can break). "
			"May be given before the first step, for a slit: a bond that is neither 0 nor 1 is a ValueError."))
		,/*ctor*/,
		.def("elasticEnergy",&MembraneBonds::elasticEnergy,"Elastic energy of all bonds [J] at the last step.")
		.def("normalForces",&MembraneBonds::normalForces,"Normal force of each bond at the last step [N], tension positive, in the order of HexMembrane.bonds.")
		.def("axialTension",&MembraneBonds::axialTension,(boost::python::arg("heights")),
			"Axial force [N] that the membrane carries through the horizontal plane at each of the heights [m], at the last step: "
			"the axial parts of the normal and shear forces of all bonds that cross it, tension positive. A thin tube: 2 π r Nz. "
			"Broken bonds count with what they still carry.")
		.def("radialShare",&MembraneBonds::radialShare,(boost::python::arg("group")=3),
			"Pressure [Pa] that the membrane's own forces add to what reaches the soil at a group (0: all of groups 2 and 3), at the last step: "
			"the sum of the bonds' forces on its particles towards their ring's axis, "
			"over the same smooth inner area as HexMembrane.transmittedPressure. Positive presses inwards; a thin tube: Nθ/r with r the inner radius. "
			"At rest the transmitted pressure is the applied one plus this.")
		.def("criticalTimeStep",&MembraneBonds::criticalTimeStep,"Critical time step [s] of the bonds alone, 2/ω with ω² = max(6 kn + 2 ks, 30 ks)/m: "
			"exact for the free flat lattice, where the second term is all particles spinning alike, and below the tube's own. "
			"Contacts make it shorter, and so does a strain ε of the bonds, "
			"which adds some 2 kn ε to the first term and multiplies the second by (1 + ε)².")
		.add_property("normalStiffness",&MembraneBonds::normalStiffness,"Normal stiffness of a bond [N/m], as given or from young, thickness and poisson.")
		.add_property("shearStiffness",&MembraneBonds::shearStiffness,"Shear stiffness of a bond [N/m], likewise.")
		.add_property("brokenCount",&MembraneBonds::brokenCount,"Number of broken bonds.")
	);
	// clang-format on
};
REGISTER_SERIALIZABLE(MembraneBonds);

} // namespace yade
