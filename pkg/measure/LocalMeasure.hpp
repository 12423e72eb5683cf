// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "SoilMeasure.hpp"

#include "kernels/measure/CylinderTube.hpp"

namespace yade {

/*! Volume, void ratio, strain, rotation, stress and non-affine motion of each grain, in either tier. */
class LocalMeasure : public Serializable {
public:
	// Python-facing
	void setReference(const boost::python::object& places);
	boost::python::object reference_get() const;
	boost::python::dict measure(bool advance);
	boost::python::dict mesh() const;
	static boost::python::object triangulation(const vector<Body::id_t>& ids);

private:
	//! Where everything is.
	struct Places {
		vector<Body::id_t> ids; // of the grains
		vector<hexmembrane::PowerSite> grains;
		std::array<Real, 2> faces;
		vector<Vector3r> sheet; // the membrane's particles
		// or the wall
		Vector3r axis = Vector3r::Zero();
		Real wallRadius = NaN;
		hexmembrane::CylinderLattice lattice{};
	};
	//! The same with its cells.
	struct Instant : Places {
		vector<Vector3r> inner;
		std::shared_ptr<const hexmembrane::PowerCells> cells;
		vector<std::array<int, 3>> triangles;
	};
	Places placesNow(const Scene& scene) const;
	Places placesFrom(const Scene& scene, const boost::python::dict& given) const;
	Instant with(Places places) const;
	Instant look(const Scene& scene) const { return with(placesNow(scene)); }
	//! Of each grain, times its cell's volume (N m).
	vector<Matrix3r> stresses(const Scene& scene, const Instant& now) const;
	void addStrain(const Instant& now, boost::python::dict& values) const;
	void requireSoil(const Scene& scene) const;

	std::shared_ptr<const Instant> reference;

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(LocalMeasure,Serializable,
		"What happens inside a specimen in its HexMembrane or CylinderWall, grain by grain. The grains are all spheres that are not of the membrane.\n\n"
		"Cells: a point between the platens' faces, inside the membrane's inner surface or the wall, belongs to the grain with the least power, "
		"|x - c|² - r². The cells' volumes add up to enclosedVolume, or to the cylinder's.\n\n"
		"A wall is taken for triangles whose points are 1.6 radii of the smallest grain apart. "
		"They enclose the cylinder's volume exactly and are within 3 R/n² of it, n points in a ring. "
		"Their points move outward with the wall, and vertically between the faces in proportion.\n\n"
		"Strain: displacements between two states are linear in the tetrahedra of a mesh of grains, "
		"points of the inner surface and projections of the grains on the platens' faces (a power triangulation, "
		"see ``kernels/measure/PowerCells.hpp``); the gradient is averaged over the grain's cell in the first state. "
		"Weighted with those volumes, the mean is the integral of u_i n_j over the boundary.\n\n"
		"Stress: V σ_ij = Σ F_i l_j over the grain's contacts, compression positive, F the force on the partner, "
		"l from the grain's centre to the contact point. Weighted with the volumes, the mean is the 'whole' of SoilMeasure.stress.\n\n"
		"A grain without a part of the volume (it escaped, or lies within others) has a cell of 0 and NaN for what is divided by it. "
		"Contact forces are those of the last step. The reference state is not saved with the scene; reference is what to save.\n\n"
		"Errors: ``ValueError`` for no soil, ``RuntimeError`` for a membrane that ends between the faces, grains that differ from the reference state's.\n\n"
		"Example::\n\n"
		"\tlocal=LocalMeasure(soil=SoilMeasure(membrane=m,bottomPlaten=0,topPlaten=1))\n\tlocal.setReference()\n\tO.run(10000,True)\n\tgrains=local.measure(advance=True)\n\tvolumetric=grains['volumetric']",
		((shared_ptr<SoilMeasure>,soil,,,"Membrane or wall, and platens, that the grains are in. Required."))
		,/*ctor*/,
		.def("setReference",&LocalMeasure::setReference,(boost::python::arg("places")=boost::python::object()),
			"Makes the present state the one that strain counts from; or one of before: a value of reference.")
		.add_property("reference",&LocalMeasure::reference_get,
			"Places in the state that strain counts from, None without one; to be saved and given to setReference in the same scene. A dict of arrays: "
			"'ids' of the grains; 'centres' [m], (N, 3); 'faces' [m], (2,); 'sheet' [m], (n, 3), centres of the membrane's particles, none in a wall; "
			"'wall', empty in a membrane, else x, y and radius of the wall [m], points in a ring, rows of triangles.")
		.def("measure",&LocalMeasure::measure,(boost::python::arg("advance")=false),
			"A dict of arrays, one row a grain: 'ids'; 'volume' [m³] of the cell; 'voidRatio' [-], the cell over the whole sphere, less 1; "
				"'stress' [Pa], (N, 3, 3), compression positive. "
			"With a reference state also: 'referenceVolume' [m³]; 'gradient' [-], (N, 3, 3), du_i/dx_j over the cell of the reference state; "
				"'volumetric' [-], its trace, compression negative; 'deviatoric' [-], sqrt(2/3 e_ij e_ij) of the strain's deviator; "
				"'rotation' [rad], (N, 3), half the curl; "
			"'nonAffine' [m²], what the best affine fit leaves of the neighbours' displacements relative to the grain's, "
				"mean square (Falk and Langer's D²min over the number of neighbours). advance: the present state becomes the reference, at no cost.")
		.def("mesh",&LocalMeasure::mesh,
			"The present mesh, a dict: 'corners' [m], (n, 3), grains first, then the inner surface's points in the membrane's order, then feet; "
			"'tetrahedra', (m, 4); 'times', (m,), how often each counts: signed volume det/6 times this adds up to the volume before the faces cut it; "
			"'feet', (k,), the grain of each foot as an index; 'triangles', (t, 3), of the inner surface.")
		.def("triangulation",&LocalMeasure::triangulation,boost::python::arg("ids"),
			"The power (regular, weighted Delaunay) triangulation of spheres: tetrahedra of indices into ids, (m, 4).").staticmethod("triangulation")
	);
	// clang-format on
};
REGISTER_SERIALIZABLE(LocalMeasure);

} // namespace yade
