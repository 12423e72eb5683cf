// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <lib/serialization/Serializable.hpp>

namespace yade {

/*! A dense random packing of given radii in a vertical cylinder; the arithmetic is in kernels/SpherePacking.hpp.
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

private:
	//! This, after checking that there are results. \throws std::runtime_error
	const CylinderPacking& generated() const;

public:
	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(CylinderPacking,Serializable,
		"Dense random packing of spheres of given radii inside a vertical cylinder (axis +z, flat ends), free of overlaps, evenly dense, isotropic, sizes mixed, without gravity. "
		"Reproducible: the same input and :yref:`seed<CylinderPacking.seed>` give the same bits with the same program.\n\n"
		"Method: centres are drawn uniformly; spheres of reduced size are pushed apart as frictionless soft spheres (FIRE minimiser, Bitzek et al., Phys. Rev. Lett. 97, 170201, 2006) and grown step by step; a jammed packing is loosened, shaken and grown again. "
		"Porosity here is 1 - (volume of the spheres)/(pi radius^2 height), walls included.\n\n"
		"Limits: random close packing of these sizes less the walls' share. For a uniform sand in a cylinder twice as high as wide about 0.38 with 7,000 grains and 0.40 with 1,200; denser is a RuntimeError that names what was reached. "
		"There are no contacts afterwards (no overlap, no force): a consolidation makes them.\n\n"
		"Errors: ValueError for bad input, before anything is changed; RuntimeError for a porosity out of reach and for results read before :yref:`generate<CylinderPacking.generate>`.\n\n"
		"Example: ``p = CylinderPacking(radius=.02, height=.08, radii=[.0017]*2000, porosity=.42, seed=7); p.generate(); O.bodies.append([utils.sphere(c, r) for c, r in zip(p.centres, p.sizes)])``",
		((Real,radius,NaN,,"Radius of the cylinder [m]. Required."))
		((Real,height,NaN,,"Height of the cylinder [m]. Required."))
		((Vector3r,origin,Vector3r::Zero(),,"Centre of the cylinder's bottom face [m]."))
		((vector<Real>,radii,,,"Radii of the spheres [m], in any order. Required. With a porosity, only their proportions count."))
		((Real,porosity,NaN,,"Porosity wanted, 0 to 1 [-]: all radii are multiplied by one factor, :yref:`scale<CylinderPacking.scale>`, to meet it exactly. NaN: radii are kept as they are."))
		((long,seed,1,,"Seed of the random numbers [-], >= 0."))
		((Real,tolerance,1e-4,,"Room left round touching spheres over the mean radius [-], in (0, 0.01]. Smaller is slower in dense packings."))
		((int,shakes,8,,"How often a jammed packing is loosened, shaken and grown again before it is given up [-], >= 0."))
		((vector<Vector3r>,packedCentres,,Attr::hidden,"See centres."))
		((vector<Real>,packedRadii,,Attr::hidden,"See sizes."))
		((Real,packedPorosity,NaN,Attr::hidden,"See porosityReached."))
		((Real,packedOverlap,NaN,Attr::hidden,"See maxOverlap."))
		((Real,packedScale,NaN,Attr::hidden,"See scale."))
		((int,packedShakes,0,Attr::hidden,"See shakesUsed.")),
		/*ctor*/,
		.def("generate",&CylinderPacking::generate,"Makes the packing; a failure leaves the results of before as they were.")
		.add_property("centres",boost::python::make_function(&CylinderPacking::centres,boost::python::return_value_policy<boost::python::return_by_value>()),"Centres of the spheres [m], list of Vector3 in the order of :yref:`radii<CylinderPacking.radii>`. After generate().")
		.add_property("sizes",boost::python::make_function(&CylinderPacking::sizes,boost::python::return_value_policy<boost::python::return_by_value>()),"Radii of the spheres as packed [m]: radii times scale. After generate().")
		.add_property("porosityReached",&CylinderPacking::porosityReached,"Porosity of the packing [-]. After generate().")
		.add_property("maxOverlap",&CylinderPacking::overlapLeft,"Largest overlap of two spheres, or of a sphere with the wall, over the mean radius [-]: 0 unless rounding says otherwise. After generate().")
		.add_property("scale",&CylinderPacking::scale,"Common factor on the radii [-]. After generate().")
		.add_property("shakesUsed",&CylinderPacking::shakesUsed,"How often the packing jammed and was shaken [-]: 0 far from the densest state. After generate().")
	);
	// clang-format on
};
REGISTER_SERIALIZABLE(CylinderPacking);

} // namespace yade
