// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "MembraneBonds.hpp"

#include "compact/Stepped.hpp"

#include "kernels/membrane/FacetContact.hpp"

#include <core/GlobalEngine.hpp>

#include <memory>

namespace yade {

/*! Contact of grains with the sheet between the membrane's particles, over flat arrays: all that it depends on are places. */
class MembraneFacetContact : public GlobalEngine, public Stepped {
public:
	void action() override;

	Real normalStiffness() const;
	Real usedOffset() const;
	Real elasticEnergy() const;
	Real criticalTimeStep() const;
	vector<Body::id_t> grains() const;
	vector<Vector3i> triangles() const;
	vector<Real> overlaps() const;
	long listsMade() const { return kernel ? kernel->listsMade() : 0; }

	void prepare() override;
	void step(StepView& view) override;
	void bookStored() override;
	void forEachContact(const VisitContact& visit) const override;
	void forEachSupport(const VisitSupport& visit) const override;
	const HexMembrane* actsOn() const override { return membrane.get(); }

private:
	using Contact = hexmembrane::FacetContact::Contact;

	void requireMembrane(const string& who) const;
	const hexmembrane::FacetContact& computed(const char* what) const;
	void compute(StepView& view);
	void tear(StepView& view);
	//! Force on the grain (N).
	Vector3r forceOf(const Contact& contact) const { return builtStiffness * contact.overlap * contact.normal; }

	// Caches: rebuilt from the attributes when they are missing or other than when they were built.
	std::unique_ptr<hexmembrane::FacetContact> kernel;
	Real builtStiffness = NaN, builtOffset = NaN;
	const HexMembrane* builtFor = nullptr;
	int energyIndex = -1, freedIndex = -1;
	int torn = -1;  //!< broken bonds that the kernel knows of; -1: it is new
	Real freed = 0; //!< by bonds that broke in this step (J)

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(MembraneFacetContact,GlobalEngine,
		"Contact of grains with the sheet between the particles of a HexMembrane: a grain does not press itself through a stretched mesh. "
		"Stands before NewtonIntegrator; no collider is needed.\n\n"
		"The sheet is the triangles of the particles' centres, thickened by the offset h. "
		"A grain of radius r whose centre is at the distance d from the nearest point of the sheet is pushed away from it with F = kn (r + h - d), "
		"without friction or damping. "
		"Where it reaches several triangles, by the overlaps o_i = r + h - d_i, "
		"the energy is kn O²/2 with O = (Σ o_i⁴)^(1/4) and each pushes by its part of the gradient, so that a hollow between triangles has no ridge. "
		"A triangle's corners take the reaction by the barycentric weights of its nearest point; forces and moments balance. "
		"A centre that is past the sheet by less than h is pushed back inwards.\n\n"
		"A triangle acts while its longest edge is above sqrt(3 ((0.9 R + r)² - (r + h)²)) with r the smallest grain's radius: "
		"below it the particles themselves keep such grains away. With h = R/4 that is a stretch of 1.10 for R/r = 1.5 and 1.33 for 0.8. "
		"It does not act beside a broken bond: a torn sheet leaks.\n\n"
		"Its contacts are counted wherever contacts are, each as one of every particle that takes a share. "
		"With O.trackEnergy the elastic energy is entered as 'elastFacet'. "
		"Forces depend on the places alone, to the last bit, and are the same for any number of threads. "
		"Grains are the spheres that are not of the membrane; their number and radii are read when lists are made.\n\n"
		"Errors: ``ValueError`` for parameters, ``RuntimeError`` for a membrane not generated, a body erased, "
		"a force that is not finite (with body id and iteration).\n\n"
		"Example::\n\n\tMembraneFacetContact(membrane=m,bonds=bonds)",
		((shared_ptr<HexMembrane>,membrane,,,"The membrane. Required."))
		((shared_ptr<MembraneBonds>,bonds,,,"The membrane's bonds, when they may break. None: the sheet does not tear."))
		((Real,kn,NaN,,"Stiffness kn of a contact [N/m], > 0; NaN: that of the membrane's material, a LinearMat, in contact with itself."))
		((Real,offset,NaN,,"Half thickness h of the sheet [m], > 0 and below 0.9 R; NaN: R/4. "
			"With it a sheet that is not stretched is never reached by grains down to R/3.8; smaller ones touch it at rest."))
		,/*ctor*/,
		.add_property("normalStiffness",&MembraneFacetContact::normalStiffness,"Stiffness of a contact [N/m], as given or from the material.")
		.add_property("usedOffset",&MembraneFacetContact::usedOffset,"h [m], as given or R/4.")
		.add_property("grains",&MembraneFacetContact::grains,
			"Ids of the grains that touched at the last step, ascending, once for each triangle that a grain reached.")
		.add_property("triangles",&MembraneFacetContact::triangles,"The triangle that each of grains touched, as indices into HexMembrane.ids.")
		.add_property("overlaps",&MembraneFacetContact::overlaps,"Force of each over kn [m]: the overlap r + h - d where the grain reached one triangle.")
		.add_property("listsMade",&MembraneFacetContact::listsMade,
			"Times that the lists of triangles and near grains were made since the engine was made or loaded.")
		.def("elasticEnergy",&MembraneFacetContact::elasticEnergy,"Elastic energy of all contacts [J] at the last step.")
		.def("criticalTimeStep",&MembraneFacetContact::criticalTimeStep,
			"Critical time step [s] of the contacts of the last step alone, 2/ω with ω² <= 2 kn max(1/mg, w/m), "
			"mg the lightest grain's mass that touches and w the largest sum of shares of a particle of mass m: a lower bound. "
			"inf while nothing touches; a contact that is made later shortens it.")
	);
	// clang-format on
};
REGISTER_SERIALIZABLE(MembraneFacetContact);

} // namespace yade
