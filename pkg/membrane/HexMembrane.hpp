// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <core/Body.hpp>
#include <core/Material.hpp>
#include <core/Scene.hpp>
#include <lib/serialization/Serializable.hpp>

#include "kernels/membrane/HexLattice.hpp"
#include "kernels/membrane/PaddedRings.hpp"
#include "kernels/membrane/SurfaceMeasure.hpp"
#include "SharedValues.hpp"

namespace yade {

class StepView;

/*! The membrane as a set of ordinary sphere bodies plus what is known of their arrangement. The engines of this folder share one of these. */
class HexMembrane : public Serializable {
public:
	//! Appends the bodies to the current scene. Nothing is appended when anything is wrong.
	vector<Body::id_t> generate();

	//! Throws unless generate() has run; `who` asks.
	void requireGenerated(const string& who) const;
	//! Connectivity for the kernels.
	hexmembrane::HexStencil stencil() const { return {perRing, rings}; }
	//! Group (1, 2 or 3) of ring k.
	int groupOfRing(int k) const;

	//! Present centres of all particles. Throws when a body is gone; `who` asks.
	void gather(const Scene& scene, const string& who, vector<Vector3r>& positions) const;
	//! The same as wrapped rows; the field is made when it does not fit.
	void gather(const Scene& scene, const string& who, hexmembrane::PaddedRings& positions) const;
	//! A body of the membrane. Throws when it is gone.
	const shared_ptr<Body>& body(const Scene& scene, int index, const string& who) const;
	//! All triangles as local indices.
	vector<std::array<int, 3>> triangleList() const;

	//! Mean pressure (Pa) that the particles of a group (0: all) press on bodies which are not of the membrane.
	Real transmittedPressure(int group) const;
	//! The same of all groups at once: 0, 2 (where there are rows beside the platens) and 3.
	boost::python::dict transmittedByGroup() const;
	//! The same ring by ring (Pa).
	vector<Real> transmittedByRing() const;
	//! Sum of the normal contact forces of all that is not membrane on each particle (N), from O.interactions and the engines.
	vector<Vector3r> contactForces(const Scene& scene, const string& who) const;
	//! The pressure that a group transmits in this instant (Pa).
	Real transmitted(StepView& view, int group, const string& who) const;
	//! Volumes (m3) inside the inner surface between rising heights, one less than heights, with the particles at x.
	vector<Real> volumesBetween(const vector<Vector3r>& x, const vector<Real>& heights) const;
	//! Points of the inner surface (m), one a particle, with the particles at x.
	vector<Vector3r> innerPoints(const vector<Vector3r>& x) const { return surfacePoints("inner", x); }
	//! The particles' places in this instant.
	vector<Vector3r> positionsIn(StepView& view) const;
	//! Mean pressure (Pa) that forces on the particles (N, positive inwards) are over the inner area of a group (0: all of groups 2 and 3).
	Real groupPressure(int group, const vector<Vector3r>& x, const vector<Vector3r>& forces, const string& who) const;

	// Python-facing
	vector<int> groups_get() const;
	vector<Vector3i> triangles_get() const;
	vector<Vector2i> bonds_get() const;
	vector<Vector3r> positions_get() const;
	Real surfaceArea(const string& surface, Real zBottom, Real zTop) const;
	Real enclosedVolume(Real zBottom, Real zTop, const string& surface) const;
	Real meanRadius(Real zBottom, Real zTop, const string& surface) const;
	vector<Body::id_t> outside(const vector<Body::id_t>& bodies) const;

private:
	hexmembrane::HexLatticeSpec spec() const;
	void checkGrain(Real sphereRadius) const;
	//! Centres, or the points one radius further in along the vertex normals.
	vector<Vector3r> surfacePoints(const string& surface, vector<Vector3r> x) const;
	static vector<Vector3r> pressing(vector<Vector3r> onParticles);
	//! Of the last step, in either tier (N).
	vector<Vector3r> pressingNow(const string& who) const;
	//! Area and volume of that surface between two heights (NaN: to the end rings); `argument` is the lower one's name in a complaint.
	hexmembrane::TubeSlab slab(const string& surface, const vector<Vector3r>& x, Real zBottom, Real zTop, const char* argument) const;
	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(HexMembrane,Serializable,
		"A flexible membrane: hexagonal rings of equal spheres round an upright cylindrical specimen. generate appends them as ordinary Sphere bodies; "
		"MembraneBonds, MembranePressure, MembraneRadialServo and MembraneORings act on them.\n\n"
		"Whole numbers of touching spheres close each ring exactly, and rings stand at the stress-free distance 2 R sqrt(1 - 1/(4 cos²(π/(2 n)))), "
		"so that every neighbour is 2 R away and the generated membrane is free of stress. "
		"Row groups as in the source study: 1 O-ring rows beyond the specimen's ends, 2 rows beside the platens, 3 the main body.\n\n"
		"Membrane spheres must not collide with each other: give them a mask and set it as Collider.avoidSelfInteractionMask. "
		"A frictionless material is usual (friction 0 in the source study).\n\n"
		"Errors (``ValueError``, nothing appended): sizes that are missing, negative, NaN; "
		"a membrane too coarse to close (fewer than 6 spheres a ring) or, with smallestGrain, too coarse to hold the grains (Eq. 1); "
		"group rows that overlap.\n\n"
		"Example::\n\n\tmembrane=HexMembrane(specimenRadius=.02,specimenHeight=.08,particleRadius=.001)\n\tids=membrane.generate()",
		((Real,specimenRadius,NaN,,"Radius of the specimen [m]. Required."))
		((Real,specimenHeight,NaN,,"Height of the specimen [m]. Required."))
		((Real,particleRadius,NaN,,"Wanted radius R of the membrane's spheres [m]. Required. See sphereRadius for the one that closes the ring."))
		((Vector3r,origin,Vector3r::Zero(),,"Centre of the specimen's lower end [m]; the axis points along z."))
		((string,placement,HEXMEMBRANE_PLACEMENT_DEFAULT,,
			"'outside': the membrane's inner surface touches the specimen, the sphere radius is fitted to it. 'centred': "
			"sphere centres on the specimen's surface (the source study), the radius is kept and the ring's follows, R/sin(π/n)."))
		((int,oRingRows,HEXMEMBRANE_O_RING_ROWS_DEFAULT,,"Rows beyond each end of the specimen (group 1) [-], " HEXMEMBRANE_O_RING_ROWS_RANGE "."))
		((int,platenRows,HEXMEMBRANE_PLATEN_ROWS_DEFAULT,,"Rows at each end of the specimen, beside the platens (group 2) [-], " HEXMEMBRANE_PLATEN_ROWS_RANGE "."))
		((Real,smallestGrain,NaN,,"Radius of the smallest grain r [m]. When given, R <= 3/(2 sqrt(3) - 3) r is required (Eq. 1: "
			"no grain through a gap of three touching spheres)."))
		((bool,allowCoarse,false,,"Turn a violation of Eq. 1 into a warning."))
		((bool,rotations,false,,
			"Leave the spheres free to rotate. Off: their spins are blocked, as central bonds (ks = 0) and a frictionless surface need none. "
			"Bonds with ks > 0 require it."))
		((Real,density,NaN,,"Density of the spheres [kg/m³]; NaN: that of the material."))
		((shared_ptr<Material>,material,,,"Material of the spheres; the last of ``O.materials`` when not given."))
		((int,mask,1,,"Body.mask of the spheres."))
		((Vector3r,color,Vector3r(.35,.55,.8),,"Color of the spheres."))
		((vector<Body::id_t>,ids,,Attr::readonly,"Ids of the bodies, ring by ring from the bottom: particle *i* of ring *k* at *k* perRing + *i*."))
		((int,perRing,0,Attr::readonly,"Spheres a ring."))
		((int,rings,0,Attr::readonly,"Number of rings, O-ring rows included."))
		((Real,sphereRadius,NaN,Attr::readonly,"Radius of the spheres [m]; with 'outside' within 1/(2 perRing) of particleRadius, with 'centred' equal to it."))
		((Real,centreRadius,NaN,Attr::readonly,"Radius of the cylinder through the generated centres [m]."))
		((Real,innerRadius,NaN,Attr::readonly,"Radius of the generated inner surface, centreRadius - sphereRadius [m]."))
		((Real,ringSpacing,NaN,Attr::readonly,"Distance of neighbouring rings when generated [m]."))
		,/*ctor*/,
		.def("generate",&HexMembrane::generate,"Append the bodies to the current scene and return their ids. Once only.")
		.add_property("groups",&HexMembrane::groups_get,"Group of each particle: 1 O-ring, 2 beside a platen, 3 main body.")
		.add_property("triangles",&HexMembrane::triangles_get,"Triangles of neighbouring particles as indices into ids, counter-clockwise seen from outside.")
		.add_property("bonds",&HexMembrane::bonds_get,"Pairs of bonded particles as indices into ids.")
		.add_property("positions",&HexMembrane::positions_get,"Present centres [m].")
		.def("surfaceArea",&HexMembrane::surfaceArea,(boost::python::arg("surface")="inner",boost::python::arg("zBottom")=NaN,boost::python::arg("zTop")=NaN),
			"Present area [m²] of the 'inner' surface or of that through the 'centre's, between two heights (NaN: to the end rings).")
		.def("enclosedVolume",&HexMembrane::enclosedVolume,(boost::python::arg("zBottom")=NaN,boost::python::arg("zTop")=NaN,boost::python::arg("surface")="inner"),
			"Present volume [m³] enclosed by the membrane's 'inner' (or 'centre') surface and horizontal planes at two heights, the platens' faces (NaN: "
			"at the end rings).")
		.def("meanRadius",&HexMembrane::meanRadius,(boost::python::arg("zBottom")=NaN,boost::python::arg("zTop")=NaN,boost::python::arg("surface")="inner"),
			"Present mean distance [m] of the particles from their ring's centroid, rings between two heights (for Eq. 6); 'inner': "
			"less the sphere radius.")
		.def("outside",&HexMembrane::outside,(boost::python::arg("ids")),
			"Those of the bodies whose centres are outside the surface through the membrane's centres, for bodies between its ends.")
		.def("transmittedPressure",&HexMembrane::transmittedPressure,(boost::python::arg("group")=0),
			"Pressure [Pa] that arrives: radial part (towards the centroid of the ring) of the normal contact forces on all other bodies (grains, "
			"platens' sides), over the present smooth inner area of the particles of a group (0: "
			"all of groups 2 and 3), 2 π (r - R) a ring times half the distance of its neighbours. "
			"Smooth and radial, since a membrane that sags between grains has more surface than the cylinder that the pressure is asked for (8 % more "
			"for R/r = 0.8 at 100 kPa). Positive presses inwards. From the contacts of the last step.")
		.def("transmittedByGroup",&HexMembrane::transmittedByGroup,
			"The same for all groups at once, in the time of one: a dict of group (0, 2 where there are platenRows, 3) to pressure [Pa].")
		.def("transmittedByRing",&HexMembrane::transmittedByRing,
			"The same for each ring from the bottom, O-ring rows included: a list of rings pressures [Pa]. "
			"An end ring counts half the distance to its one neighbour twice.")
	);
	// clang-format on
	DECLARE_LOGGER;
};
REGISTER_SERIALIZABLE(HexMembrane);

} // namespace yade
