// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "HexMembrane.hpp"
#include "PressureLoop.hpp"
#include "PressureRamp.hpp"

#include "compact/Stepped.hpp"

#include "kernels/membrane/PressureForce.hpp"
#include "kernels/membrane/TubePressure.hpp"
#include "SharedValues.hpp"

#include <core/GlobalEngine.hpp>

namespace yade {

/*! Follower pressure on group 3 of a membrane or on any triangulated set of bodies. */
class MembranePressure : public GlobalEngine, public Stepped {
public:
	void action() override;

	Real area() const;
	Vector3r resultant() const;
	vector<Vector3r> forces() const;
	Real axialPush(Real z) const;

	void prepare() override;
	void step(StepView& view) override;
	void bookWorks() override;
	const HexMembrane* actsOn() const override { return membrane.get(); }
	void requireCompactScene() const override;

	//! Pressure that the ramps have come to (Pa).
	Real ramped() const { return rampedPressure(pressure, rampTime, rampTarget, ramps); }
	//! factor times that (Pa): what is on the triangles.
	Real applied() const { return factor * ramped(); }
	Real work_get() const { return meter->work; }

private:
	void prepareMembrane();
	void prepareMesh();
	void stepMesh();
	PressureLoop loop();
	Vector3r forceOn(int vertex) const;
	void requireStepped(const char* what) const;

	// Caches, rebuilt from the attributes
	std::unique_ptr<hexmembrane::TubePressure> tube; //!< of a membrane
	hexmembrane::PressureForce mesh;                 //!< of a mesh of one's own
	vector<Body::id_t> vertexIds;                    //!< bodies that are the vertices of the mesh
	vector<int> loaded;                              //!< vertices that receive their force
	vector<Vector3r> positions, force;               //!< of all vertices
	const HexMembrane* builtFor = nullptr;
	string builtSurface;
	vector<Body::id_t> builtIds;
	vector<Vector3i> builtTriangles;
	Real builtOffset = NaN;

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(MembranePressure,GlobalEngine,
		"Confining pressure on the main body (group 3) of a HexMembrane, or on any triangulated set of bodies, always on the current geometry. "
		"Stands before NewtonIntegrator.\n\n"
		"A triangle (a, b, c) gives each of its vertices -p/6 (b - a) x (c - a): "
		"pressure times area along the inward normal, a third to each vertex (Eqs. 3-5 of the source study). "
		"Each particle of group 3 sums its six triangles, shared ones too; "
		"other groups receive nothing here. On a closed surface resultant and moment vanish.\n\n"
		"surface 'centre' puts the pressure on the triangles through the particles' centres, as the source study does: "
		"on a cylinder the soil then receives p Rc/(Rc - R). "
		"'inner' (default) puts it on the surface one sphere radius further in, where the membrane touches the soil, which takes this bias away; "
		"the forces still act at the centres (a moment of the order of R times their tangential part remains, zero on a tube by symmetry).\n\n"
		"Open loop with an infinite timeConstant T (default): the pressure given is on the triangles, "
		"and a membrane that is stretched round the soil presses with its own tension beside it. "
		"With a finite one the engine closes the loop (membrane only): "
		"an integral controller multiplies the pressure by a factor f, "
		"T df/dt = (p - pt)/p with pt the mean pressure which group 3 transmits (HexMembrane.transmittedPressure), within 1/maxFactor and maxFactor, "
		"so that the soil receives what was asked for. "
		"It is corrected 20 times within T. Choose T so that the specimen answers meanwhile: 10 times d sqrt(ρ/p) is slow and safe.\n\n"
		"Positive pressure pushes from outside inwards. With O.trackEnergy minus the work is entered as 'pressureWork' (energy that comes in counts "
		"negative, as YADE does with gravity).\n\n"
		"Errors: ``ValueError`` for parameters (neither or both of membrane and mesh, a pressure that is NaN, indices beyond ids, "
		"a closed loop on a mesh), ``RuntimeError`` for a body erased or a force not finite (with body id and iteration).\n\n"
		"Example::\n\n\tMembranePressure(membrane=m,pressure=100e3)\n\tMembranePressure(ids=[4,7,9],triangles=[(0,1,2)],surface='centre',pressure=1e3)",
		((shared_ptr<HexMembrane>,membrane,,,"The membrane; or give ids and triangles."))
		((vector<Body::id_t>,ids,,,"Bodies that are the vertices of a mesh of your own."))
		((vector<Vector3i>,triangles,,,"Triangles of that mesh as indices into ids, counter-clockwise seen from the side of the pressure."))
		((Real,pressure,NaN,,"Pressure [Pa], positive inwards; may be changed at any time. Required."))
		((Real,rampTime,0,,"Duration of every change of the pressure [s], >= 0, the first one from zero included; 0: at once. "
			"A change takes the course (1 - cos(π t/T))/2; changes that overlap add up."))
		((string,surface,HEXMEMBRANE_PRESSURE_SURFACE_DEFAULT,,"'inner' or 'centre', see above."))
		((Real,surfaceOffset,NaN,,
			"Distance [m] of the inner surface from the centres; NaN: the membrane's sphere radius. Required for 'inner' on a mesh of your own."))
		((Real,timeConstant,std::numeric_limits<Real>::infinity(),,"Time constant T of the closed loop [s], two time steps at least; inf: open loop."))
		((Real,maxFactor,1.5,,"Largest factor that the closed loop may reach, and the inverse of the smallest [-]; above 1."))
		((Real,factor,1,Attr::readonly,"Present factor on the pressure [-]."))
		((bool,saturated,false,Attr::readonly,"The closed loop stands at one of its limits: the target cannot be reached."))
		((Real,transmitted,NaN,Attr::readonly,"Mean transmitted pressure of group 3 at the last correction [Pa] (closed loop only)."))
		((Real,rampTarget,0,(Attr::readonly|Attr::hidden),"Pressure asked for at the last step [Pa]."))
		((vector<Vector3r>,ramps,,(Attr::readonly|Attr::hidden),"Changes that are under way: size [Pa], age [s], duration [s]."))
		((Real,lastCorrection,NaN,(Attr::readonly|Attr::hidden),"Time of the last correction [s]."))
		((shared_ptr<WorkMeter>,meter,new WorkMeter,(Attr::readonly|Attr::hidden),"Work of the pressure."))
		,/*ctor*/,
		.add_property("work",&MembranePressure::work_get,
			"Work done by the pressure so far [J], trapezoidal in force and displacement; positive when the surface moves with the pressure.")
		.add_property("applied",&MembranePressure::applied,"Pressure on the triangles [Pa]: factor times pressure, as far as its ramp has come.")
		.add_property("area",&MembranePressure::area,"Loaded area at the last step [m²]: a third of every triangle round each loaded particle.")
		.add_property("resultant",&MembranePressure::resultant,"Sum of the applied forces at the last step [N].")
		.def("axialPush",&MembranePressure::axialPush,(boost::python::arg("z")),
			"Axial parts of the applied forces towards the plane at the height z [m], mean of both sides [N], at the last step: "
			"half the difference of the sums below and above.")
		.def("forces",&MembranePressure::forces,"Applied force [N] on each vertex at the last step, in the order of ids (zero where none is applied).")
	);
	// clang-format on
};
REGISTER_SERIALIZABLE(MembranePressure);

} // namespace yade
