// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "compact/Stepped.hpp"
#include "kernels/measure/SlabStress.hpp"
#include "membrane/HexMembrane.hpp"

namespace yade {

/*! Stress of the soil between two platens, from its own contacts, in either tier. */
class SoilMeasure : public Serializable {
public:
	//! Calls a visitor for each touching contact of an instant.
	using EachContact = std::function<void(const VisitContact&)>;

	//! Of one instant; compression positive.
	struct Stress {
		Matrix3r whole = Matrix3r::Zero(), middle = Matrix3r::Zero(), boundary = Matrix3r::Zero(); //!< (Pa)
		Real volume = 0, middleVolume = 0;                                                         //!< (m3)
		int grains = 0, grainContacts = 0;                                                         //!< contacts: of two grains, with a normal force
		Real contactForce = 0;                                                                     //!< mean of all contacts' forces (N)
	};
	//! `sheet`: places of the membrane's particles, of no consequence without one.
	Stress measure(const Scene& scene, const EachContact& contacts, const vector<Vector3r>& sheet) const;
	Stress measure(const Scene& scene, StepView& view) const;
	//! Throws when something is not set or does not exist; `who` asks.
	void require(const Scene& scene, const string& who) const;
	//! Heights of the platens' faces (m).
	std::array<Real, 2> faces(const Scene& scene) const;
	//! By body id: whether it is a grain, a sphere that is not of the membrane.
	vector<char> grainsOf(const Scene& scene) const;

	// Python-facing, of the last step
	boost::python::dict stress() const;
	boost::python::tuple profile(int slabs) const;
	boost::python::tuple faces_get() const;
	boost::python::dict contacts() const;
	boost::python::object coordinationNumbers(const vector<Body::id_t>& ids) const;

private:
	//! Between rising heights, one less than heights (m3).
	vector<Real> volumes(const Scene& scene, const vector<Vector3r>& sheet, const vector<Real>& heights) const;
	vector<Vector3r> sheetNow() const;

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(SoilMeasure,Serializable,
		"Stress of the soil between two platens, inside a HexMembrane or a CylinderWall, from its own contacts. "
		"The soil is all spheres that are not of the membrane.\n\n"
		"Mean stress: V σ_ij = Σ F_i l_j over the contacts of the grains, compression positive; "
		"F the contact force on the second body, l the branch from the first body's centre to the second's; "
		"to membrane, platens and wall it ends at the contact point (K. Bagi, Stress and strain in granular assemblies, Mech. Mater. 22, 1996). "
		"V is the volume between the platens' faces inside the membrane's inner surface (where its pressure acts) or the wall. "
		"The middle half lies between the heights 1/4 and 3/4; a branch that crosses such a plane counts with the part inside.\n\n"
		"The same from the boundary alone (Gauss): V σ_ij = -Σ f_i x_j over the contacts of the soil with everything else, "
		"f the force on the soil at the point x, platens' friction included. "
		"The two differ by Σ f_i x_j over the grains' resultants, which inertia takes: a check of the instant and not of the contact law.\n\n"
		"Contact forces and volume are those of the last step.\n\n"
		"Errors: ``ValueError`` for neither or both of membrane and wall, ``RuntimeError`` for a body that does not exist or is of another shape.\n\n"
		"Example::\n\n\tmeasure=SoilMeasure(membrane=m,bottomPlaten=0,topPlaten=1)\n\tsigma=measure.stress()['middle']",
		((shared_ptr<HexMembrane>,membrane,,,"The membrane round the soil; or give wall."))
		((Body::id_t,wall,-1,,"Id of the CylinderWall round the soil; -1: a membrane."))
		((Body::id_t,bottomPlaten,-1,,"Id of the lower Platen. Required."))
		((Body::id_t,topPlaten,-1,,"Id of the upper one. Required."))
		,/*ctor*/,
		.def("stress",&SoilMeasure::stress,"A dict: 'whole', 'middle' and 'boundary', stress tensors [Pa] as (3, 3) arrays, compression positive: "
			"of the whole volume, of its middle half, and of the whole volume by the boundary alone; 'volume' and 'middleVolume' [m³]; "
			"'coordination' [-], twice the contacts of two grains with a normal force over the number of grains; "
			"'contactForce' [N], mean size of all contacts' forces, membrane and platens included.")
		.def("profile",&SoilMeasure::profile,(boost::python::arg("slabs")=16),"Stress along the height: (edges [m], (n+1,); volumes [m³], (n,); "
			"stress tensors [Pa], (n, 3, 3)) of n equal slabs from the lower platen's face. "
			"Weighted with the volumes they add up to the whole specimen's stress exactly.")
		.def("contacts",&SoilMeasure::contacts,"The touching contacts of the grains, in no certain order, as a dict of arrays with one row each: "
			"'ids', (N, 2), of which the first is a grain; 'kind', (N,): the other one is 0 a grain, 1 of the membrane, 2 the lower platen, 3 the upper one, "
			"4 any other body, such as the wall; 'ends' [m], (N, 2, 3): the grain's centre, and the other one's, "
			"or the contact point where that is no grain; 'normalForce' [N], (N,), compression positive; 'shearForce' [N], (N,), its size. "
			"A contact with a triangle of the sheet has a row for each corner that carries it, with the corner's share of the force.")
		.def("coordinationNumbers",&SoilMeasure::coordinationNumbers,boost::python::arg("ids"),
			"Contacts of each body that carry a normal force, all partners: integers, (N,).")
		.add_property("faces",&SoilMeasure::faces_get,"Heights of the lower and the upper platen's face [m].")
	);
	// clang-format on
};
REGISTER_SERIALIZABLE(SoilMeasure);

} // namespace yade
