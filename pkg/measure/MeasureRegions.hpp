// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/measure/SphereRegions.hpp"
#include "membrane/HexMembrane.hpp"

namespace yade {

/*! What spherical regions of the soil hold, as PFC's measurement spheres, in either tier and with any law of spheres. */
class MeasureRegions : public Serializable {
public:
	boost::python::dict measure(const boost::python::object& centres, const boost::python::object& radii, const boost::python::object& diameters) const;
	boost::python::tuple members(const boost::python::object& centres, const boost::python::object& radii) const;
	static boost::python::object grid(const Vector3r& low, const Vector3r& high, Real spacing);

private:
	//! Ids of the grains: spheres that are neither of the membrane nor excluded.
	vector<Body::id_t> grainsOf(const Scene& scene) const;
	hexmembrane::SphereRegions regionsOf(const Scene& scene, const vector<Body::id_t>& ids) const;

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(MeasureRegions,Serializable,
		"Measurement regions as PFC's measurement spheres: porosity, coordination, sliding, stress, "
		"velocity gradient and sizes of the grains in spheres anywhere, which may overlap. "
		"In either tier, and with every law of spheres whose contacts derive from NormShearPhys. "
		"Grains are all spheres but those of the membrane and those that are excluded. What a region has beyond the specimen counts as void.\n\n"
		"Places and velocities are the present ones, contacts those of the last step.\n\n"
		"* Porosity: grains cut by the region's surface count with the exact lens; "
		"overlaps of grains in contact are taken away once, whole when their contact point is inside (PFC). "
		"What three grains share is taken away once too often; three equal ones share nothing while overlaps are below 13 % of the diameter.\n"
		"* Coordination: mean number of active contacts, with all partners, of the grains with centres inside (PFC). "
		"SoilMeasure.stress counts contacts among grains only.\n"
		"* Sliding: share of the contacts of two grains in compression, contact points inside, "
		"whose tangential force is at friction times the normal force (1e-6). Bonded contacts do not slide.\n"
		"* Stress: V σ_ij = Σ F_i l_j, compression positive, l the part of the branch inside the region, V the region's volume (I. "
		"Goldhirsch, Granular Matter 12, 2010, with the region as coarse-graining function). "
		"Its mean over all places is the mean stress of the assembly exactly. To all but grains the branch ends at the contact point.\n"
		"* Velocity gradient: dv_i/dx_j, extension positive, least squares over the grains with centres inside (PFC). Strain rate: "
		"-(A + Aᵀ)/2, A the rate of α,, compression positive.\n\n"
		"Errors: ``ValueError`` for a radius that is not positive, a region outside the box round the grains, an array of another shape; "
		"``RuntimeError`` for clumps, periodic cells, and contacts that do not tell their forces.\n\n"
		"Example::\n\n"
		"\tregions=MeasureRegions(membrane=m)\n\tcentres=MeasureRegions.grid((-.02,-.02,0),(.02,.02,.08),spacing=.008)\n\tn=regions.measure(centres,.006)['porosity']",
		((shared_ptr<HexMembrane>,membrane,,,"A membrane whose particles are no grains; None: there is none."))
		((int,exclude,0,,"Spheres whose groupMask has a bit of this mask are no grains; 0: all are."))
		,/*ctor*/,
		.def("measure",&MeasureRegions::measure,(boost::python::arg("centres"),boost::python::arg("radii"),boost::python::arg("diameters")=boost::python::list()),
			"What regions hold. :param centres: [m], (N, 3). :param radii: [m], (N,) or one number for all, > 0. :param diameters: "
				"rising borders of bins of grain diameter [m], (B+1,); a grain on a border belongs to the upper bin, one beyond the ends to none; empty: "
				"no sizes.\n\n"
			"Returns a dict of arrays, one row a region: 'grains', with centres inside; 'contacts', active, with points inside; "
				"'porosity' [-], 1 where no grain reaches; 'coordination' [-], nan: no grain's centre inside; "
			"'sliding' [-], nan: no contact of two grains in compression inside, or one whose law does not tell its friction; "
				"'stress' [Pa], (N, 3, 3), nan: no branch inside; 'velocity' [m/s], (N, 3), mean of the grains with centres inside, nan: none; "
			"'velocityGradient' and 'strainRate' [1/s], (N, 3, 3), nan: less than four grains inside, or all in a plane; "
				"'sizes' [m³], (N, B), volumes of grains inside by bins, cut ones with the lens, overlaps not taken away.")
		.def("members",&MeasureRegions::members,(boost::python::arg("centres"),boost::python::arg("radii")),
			"Grains with their centres inside: (start, (N+1,); ids). Those of region k are ``ids[start[k]:start[k+1]]``.")
		.def("grid",&MeasureRegions::grid,(boost::python::arg("low"),boost::python::arg("high"),boost::python::arg("spacing")),
			"Centres [m], (N, 3), of equal cells that fill the box from low to high [m], cells at least spacing [m] wide, x fastest. "
			"Each cell's middle is one.").staticmethod("grid")
	);
	// clang-format on
};
REGISTER_SERIALIZABLE(MeasureRegions);

} // namespace yade
