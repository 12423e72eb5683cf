// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "SharedValues.hpp"

#include <lib/serialization/Serializable.hpp>

namespace yade {

/*! A dense random packing of given radii in a vertical cylinder; the arithmetic is in kernels/packing/SpherePacking.hpp and, under stress, in
 * kernels/packing/StressedPacking.hpp.
 *
 * Results are kept apart from what was asked: they are those of the last generate(), they are saved, and reading them before is an error. */
class CylinderPacking : public Serializable {
public:
	void generate();

	const vector<Vector3r>& centres() const { return generated().packedCentres; }
	const vector<Real>& sizes() const { return generated().packedRadii; }
	Real porosityReached() const { return generated().packedPorosity; }
	Real overlapLeft() const { return generated().packedOverlap; }
	Real scale() const { return generated().packedScale; }
	int shakesUsed() const { return generated().packedShakes; }
	Real radialStress() const { return stressed().packedRadial; }
	Real axialStress() const { return stressed().packedAxial; }
	Real coordination() const { return stressed().packedCoordination; }
	Real rattlers() const { return stressed().packedRattlers; }
	Real frictionReached() const { return stressed().packedFriction; }

private:
	//! This, after checking that there are results. \throws std::runtime_error
	const CylinderPacking& generated() const;
	//! This, after checking that the results are those of a packing under stress. \throws std::runtime_error
	const CylinderPacking& stressed() const;

public:
	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(CylinderPacking,Serializable,
		"Dense random packing of spheres of given radii inside a vertical cylinder (axis +z, flat ends), "
		"free of overlaps or in equilibrium under a small isotropic stress, evenly dense, isotropic, sizes mixed, without gravity. "
		"Reproducible: the same input and seed give the same bits with the same program.\n\n"
		"Method: centres are drawn uniformly; spheres of reduced size are pushed apart as frictionless soft spheres (FIRE minimiser, Bitzek et al., "
		"Phys. Rev. Lett. 97, 170201, 2006) and grown step by step; a jammed packing is loosened, shaken and grown again. "
		"Porosity here is 1 - (volume of the spheres)/(pi radius^2 height), walls included.\n\n"
		"Limits: random close packing of these sizes less the walls' share. "
		"For a uniform sand in a cylinder twice as high as wide about 0.38 with 7,000 grains and 0.40 with 1,200; "
		"denser is a RuntimeError that names what was reached. "
		"Without a stress there are no contacts afterwards (no overlap, no force): a consolidation makes them.\n\n"
		"With a stress the packing starts looser and its grains grow inside fixed smooth walls, as linear frictional spheres, slowly. "
		"Where the stress exceeds the wanted one, friction is lowered until they give way; at the end it has its own value again. "
		"So any porosity between the packing without friction and the one that keeps its friction is reached at the wanted stress (mean within 3 %, "
		"porosity within porosityTolerance, unbalanced ratio 1e-3); beyond is a RuntimeError that names the porosity reached. "
		"Without friction there is one porosity at a stress, which a porosity of NaN takes as it comes. "
		"With 7,000 grains of a uniform sand and a friction of 0.4 that is 0.384 to 0.432. Shear forces of the contacts are not handed over: "
		"without them the stress stays within a few percent.\n\n"
		"Errors: ValueError for bad input, before anything is changed; RuntimeError for a porosity out of reach and for results read before generate.\n\n"
		"Example: ``p = CylinderPacking(radius=.02, height=.08, radii=[.0017]*2000, porosity=.42, seed=7); p.generate(); "
		"O.bodies.append([utils.sphere(c, r) for c, r in zip(p.centres, p.sizes)])``",
		((Real,radius,NaN,,"Radius of the cylinder [m]. Required."))
		((Real,height,NaN,,"Height of the cylinder [m]. Required."))
		((Vector3r,origin,Vector3r::Zero(),,"Centre of the cylinder's bottom face [m]."))
		((vector<Real>,radii,,,"Radii of the spheres [m], in any order. Required. With a porosity, only their proportions count."))
		((Real,porosity,NaN,,"Porosity wanted, 0 to 1 [-]: all radii are multiplied by one factor, scale, to meet it exactly. NaN: radii are kept as they are; "
			"with a stress, which needs a porosity, the packing's own where there is no friction."))
		((long,seed,HEXMEMBRANE_PACKING_SEED_DEFAULT,,"Seed of the random numbers [-], " HEXMEMBRANE_PACKING_SEED_RANGE "."))
		((Real,tolerance,1e-4,,"Room left round touching spheres over the mean radius [-], in (0, 0.01]. Smaller is slower in dense packings."))
		((int,shakes,8,,"How often a jammed packing is loosened, shaken and grown again before it is given up [-], >= 0."))
		((Real,stress,0,,"Mean pressure on the walls wanted [Pa], compression positive, at most 0.01 emod. 0: a packing without contacts."))
		((Real,emod,NaN,,"PFC's effective modulus of the contacts [Pa], required with a stress: as LinearMat.emod of grains and walls."))
		((Real,stiffnessRatio,HEXMEMBRANE_STIFFNESS_RATIO_DEFAULT,,"kn/ks of the contacts [-], " HEXMEMBRANE_STIFFNESS_RATIO_RANGE "."))
		((Real,friction,NaN,,"Coefficient of friction between the grains of the finished packing [-], required with a stress. The walls are smooth."))
		((Real,rollingFriction,HEXMEMBRANE_ROLLING_FRICTION_DEFAULT,,"Coefficient of rolling friction μr between the grains of the finished packing [-], " HEXMEMBRANE_ROLLING_FRICTION_RANGE
			": moment at most μr r1 r2/(r1 + r2) Fn. With it looser packings hold."))
		((Real,porosityTolerance,1e-3,,"By how much the porosity of a packing under stress may differ from the wanted one [-], in (0, 0.1)."))
		((vector<Vector3r>,packedCentres,,Attr::hidden,"See centres."))
		((vector<Real>,packedRadii,,Attr::hidden,"See sizes."))
		((Real,packedPorosity,NaN,Attr::hidden,"See porosityReached."))
		((Real,packedOverlap,NaN,Attr::hidden,"See maxOverlap."))
		((Real,packedScale,NaN,Attr::hidden,"See scale."))
		((int,packedShakes,0,Attr::hidden,"See shakesUsed."))
		((bool,packedStressed,false,Attr::hidden,"Whether the results are those of a packing under stress."))
		((Real,packedRadial,NaN,Attr::hidden,"See radialStress."))
		((Real,packedAxial,NaN,Attr::hidden,"See axialStress."))
		((Real,packedCoordination,NaN,Attr::hidden,"See coordination."))
		((Real,packedRattlers,NaN,Attr::hidden,"See rattlers."))
		((Real,packedFriction,NaN,Attr::hidden,"See frictionReached.")),
		/*ctor*/,
		.def("generate",&CylinderPacking::generate,"Makes the packing; a failure leaves the results of before as they were.")
		.add_property("centres",boost::python::make_function(&CylinderPacking::centres,boost::python::return_value_policy<boost::python::return_by_value>()),
			"Centres of the spheres [m], list of Vector3 in the order of radii. After generate().")
		.add_property("sizes",boost::python::make_function(&CylinderPacking::sizes,boost::python::return_value_policy<boost::python::return_by_value>()),
			"Radii of the spheres as packed [m]: radii times scale. After generate().")
		.add_property("porosityReached",&CylinderPacking::porosityReached,"Porosity of the packing [-]. After generate().")
		.add_property("maxOverlap",&CylinderPacking::overlapLeft,"Largest overlap of two spheres, or of a sphere with the wall, over the mean radius [-]: "
			"0 without a stress, else what the largest contact force asks for. After generate().")
		.add_property("scale",&CylinderPacking::scale,"Common factor on the radii [-]. After generate().")
		.add_property("shakesUsed",&CylinderPacking::shakesUsed,
			"How often the packing jammed and was shaken [-]: 0 far from the densest state. After generate().")
		.add_property("radialStress",&CylinderPacking::radialStress,"Mean pressure on the cylinder's side [Pa]. After generate() with a stress.")
		.add_property("axialStress",&CylinderPacking::axialStress,"Mean pressure on the cylinder's ends [Pa]. After generate() with a stress.")
		.add_property("coordination",&CylinderPacking::coordination,"Mean number of contacts of a grain with grains [-]. After generate() with a stress.")
		.add_property("rattlers",&CylinderPacking::rattlers,"Share of the grains without any contact [-]. After generate() with a stress.")
		.add_property("frictionReached",&CylinderPacking::frictionReached,"Down to which friction was lowered on the way [-]. After generate() with a stress.")
	);
	// clang-format on
};
REGISTER_SERIALIZABLE(CylinderPacking);

} // namespace yade
