// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "HexMembrane.hpp"

#include "kernels/membrane/PressureForce.hpp"
#include "kernels/membrane/TubePressure.hpp"

#include <core/GlobalEngine.hpp>

#include <functional>

namespace yade {

/*! Follower pressure on group 3 of a membrane or on any triangulated set of bodies. */
class MembranePressure : public GlobalEngine {
public:
	void action() override;

	Real area() const;
	Vector3r resultant() const;
	vector<Vector3r> forces() const;

	// In parts, for an engine that steps the membrane itself: prepare() once, then the kernel each step.
	//! \throws std::invalid_argument, std::runtime_error for what is set wrong
	void prepare();
	//! Corrects the factor when it is due, by the mean pressure that group 3 transmits.
	void closeLoop(const std::function<Real()>& transmittedNow);
	//! factor pressure (Pa): what is on the triangles.
	Real applied() const { return factor * pressure; }
	//! The kernel of a membrane; none for a mesh of one's own.
	hexmembrane::TubePressure* membraneKernel() { return tube.get(); }
	//! Enters `work` into the scene's energies, once an iteration.
	void bookWork();

private:
	void prepareMembrane();
	void prepareMesh();
	void computeMesh();
	Vector3r forceOn(int vertex) const;
	Vector3r positionOf(int vertex) const;
	void requireStepped(const char* what) const;

	// Caches, rebuilt from the attributes
	std::unique_ptr<hexmembrane::TubePressure> tube; //!< of a membrane
	hexmembrane::PaddedRings rows;                   //!< its positions
	hexmembrane::PressureForce mesh;                 //!< of a mesh of one's own
	vector<Body::id_t> vertexIds;                    //!< bodies that are the vertices of the mesh
	vector<int> loaded;                              //!< vertices that receive their force
	vector<Vector3r> positions, force;               //!< of all vertices
	vector<Vector3r> loadedForces, loadedPositions;  //!< of the loaded ones
	const HexMembrane* builtFor = nullptr;
	string builtSurface;
	vector<Body::id_t> builtIds;
	vector<Vector3i> builtTriangles;
	Real builtOffset = NaN;
	int energyIndex = -1;

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(MembranePressure,GlobalEngine,
		"Confining pressure on the main body (group 3) of a :yref:`HexMembrane`, or on any triangulated set of bodies, always on the current geometry. Stands before :yref:`NewtonIntegrator`.\n\n"
		"A triangle $(a,b,c)$ gives each of its vertices $-\\frac{p}{6}(b-a)\\times(c-a)$: pressure times area along the inward normal, a third to each vertex (Eqs. 3-5 of the source study). Each particle of group 3 sums its six triangles, shared ones too; "
		"other groups receive nothing here. On a closed surface resultant and moment vanish.\n\n"
		"surface 'centre' puts the pressure on the triangles through the particles' centres, as the source study does: on a cylinder the soil then receives $p R_c/(R_c-R)$. "
		"'inner' (default) puts it on the surface one sphere radius further in, where the membrane touches the soil, which takes this bias away; the forces still act at the centres (a moment of the order of R times their tangential part remains, zero on a tube by symmetry).\n\n"
		"Open loop with gain 0: the pressure given is on the triangles, and a membrane that is stretched round the soil presses with its own tension beside it. With a gain the engine closes the loop (membrane only): every :yref:`iterPeriod<MembranePressure.iterPeriod>` steps "
		"it multiplies the pressure by a factor that grows by gain times the relative error of the mean pressure which group 3 transmits (:yref:`HexMembrane.transmittedPressure`), within 1/:yref:`maxFactor<MembranePressure.maxFactor>` and maxFactor, so that the soil receives what was asked for. "
		"An integrating controller: choose gain and period so that the specimen answers between two corrections (0.2 every 500 steps is slow and safe).\n\n"
		"Positive pressure pushes from outside inwards. With :yref:`O.trackEnergy<Omega.trackEnergy>` minus the work is entered as 'pressureWork' (energy that comes in counts negative, as YADE does with gravity).\n\n"
		"Errors: ``ValueError`` for parameters (neither or both of membrane and mesh, a pressure that is NaN, indices beyond ids, a gain on a mesh), ``RuntimeError`` for a body erased or a force not finite (with body id and iteration).\n\n"
		"Example::\n\n\tMembranePressure(membrane=m,pressure=100e3)\n\tMembranePressure(ids=[4,7,9],triangles=[(0,1,2)],surface='centre',pressure=1e3)",
		((shared_ptr<HexMembrane>,membrane,,,"The membrane; or give ids and triangles."))
		((vector<Body::id_t>,ids,,,"Bodies that are the vertices of a mesh of your own."))
		((vector<Vector3i>,triangles,,,"Triangles of that mesh as indices into ids, counter-clockwise seen from the side of the pressure."))
		((Real,pressure,NaN,,"Pressure [Pa], positive inwards; may be changed at any time. Required."))
		((string,surface,"inner",,"'inner' or 'centre', see above."))
		((Real,surfaceOffset,NaN,,"Distance [m] of the inner surface from the centres; NaN: the membrane's sphere radius. Required for 'inner' on a mesh of your own."))
		((Real,gain,0,,"Relative correction a period; 0: open loop [-]."))
		((int,iterPeriod,500,,"Steps between two corrections [-]."))
		((Real,maxFactor,1.5,,"Largest factor that the closed loop may reach, and the inverse of the smallest [-]; above 1."))
		((Real,factor,1,Attr::readonly,"Present factor on the pressure [-]."))
		((bool,saturated,false,Attr::readonly,"The closed loop stands at one of its limits: the target cannot be reached."))
		((Real,transmitted,NaN,Attr::readonly,"Mean transmitted pressure of group 3 at the last correction [Pa] (closed loop only)."))
		((Real,work,0,Attr::readonly,"Work done by the pressure so far [J], trapezoidal in force and displacement; positive when the surface moves with the pressure."))
		((vector<Vector3r>,lastForces,,(Attr::readonly|Attr::hidden),"Forces of the last step, for the work."))
		((vector<Vector3r>,lastPositions,,(Attr::readonly|Attr::hidden),"Positions of the last step, for the work."))
		((long,lastIter,-2,(Attr::readonly|Attr::hidden),"Iteration of the last step, for the work: what happens while the engine is dead is not its doing."))
		,/*ctor*/,
		.add_property("applied",&MembranePressure::applied,"Pressure on the triangles [Pa]: factor times pressure.")
		.add_property("area",&MembranePressure::area,"Loaded area at the last step [m²]: a third of every triangle round each loaded particle.")
		.add_property("resultant",&MembranePressure::resultant,"Sum of the applied forces at the last step [N].")
		.def("forces",&MembranePressure::forces,"Applied force [N] on each vertex at the last step, in the order of ids (zero where none is applied).")
	);
	// clang-format on
};
REGISTER_SERIALIZABLE(MembranePressure);

} // namespace yade
