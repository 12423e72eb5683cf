// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "compact/Stepped.hpp"

#include "kernels/compact/BondTable.hpp"

#include <core/GlobalEngine.hpp>

namespace yade {

/*! Parallel bonds between grains, as a table beside the contacts: the same arithmetic over the bodies of either tier. */
class GrainBonds : public GlobalEngine, public Stepped {
public:
	void action() override;
	void preSave(GrainBonds&);

	int bond(const vector<Body::id_t>& ids, Real gap);
	int take(const boost::python::object& ids, const boost::python::object& radius, const boost::python::object& kn, const boost::python::object& ks,
	         const boost::python::object& force, const boost::python::object& moment);
	int release(const vector<Body::id_t>& ids);
	int count() const { return static_cast<int>(held().bonds.size()); }
	Real elasticEnergy() const { return held().energy(); }
	boost::python::dict bonds() const;
	boost::python::tuple springs() const;

	void prepare() override;
	void step(StepView& view) override;
	void bookStored() override;
	void forEachJoint(const VisitContact& visit) const override;
	void forEachJointSpring(const VisitJointSpring& visit) const override;
	bool mayBeSeveral() const override { return true; }

private:
	void requireStiffness() const;
	void requireStrengths() const;
	//! The table, filled from the attributes of a loaded scene.
	hexmembrane::BondTable& held() const;
	void restore() const;

	mutable hexmembrane::BondTable table;
	mutable bool live = false; //!< false: what was saved is not in the table yet
	vector<Body::id_t> bonded; //!< bodies that the table was located with
	long located = -1;         //!< the order of rows that it was located in, -1: none
	Real freed = 0;            //!< by bonds that broke since energies were entered (J)
	int energyIndex = -1, freedIndex = -1;

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(GrainBonds,GlobalEngine,
		"Parallel bonds between grains: PFC's model linearpbond, cement at contacts. Stands before NewtonIntegrator, and before engines that measure.\n\n"
		"A bond is a disc of radius R = λ min(R1, R2) across the line of centres, at the contact point, made of elastic springs that are spread evenly over it. "
		"It acts beside the contact, whose law goes on as without it, and also where the grains come apart. "
		"With A = π R², I = π R⁴/4, J = 2 I, and displacements and rotations since the bond was made:\n\n"
		"N = kn A (l0 - l), Fs <- Fs - ks A Δus, Mb <- Mb - kn I Δθb, Mt <- Mt - ks J Δθt; loads turn with the contact plane. "
		"Stresses at the edge, tension positive: σ = -N/A + β |Mb| R/I, τ = |Fs|/A + β |Mt| R/J. "
		"A bond breaks in tension when σ > tensileStrength, else in shear when τ > cohesion + (N/A) tan φ; all its loads are then gone.\n\n"
		"Bonds are made by bond(), at any moment, without loads; each keeps its radius and stiffness. Strengths are read in every step. "
		"They are saved with the scene, act in both tiers, and are counted wherever contacts are: the force of a pair is that of its contact and its bond. "
		"With O.trackEnergy the elastic energy is entered as 'elastGrainBonds', and what breaking bonds set free as 'bondDissip'. "
		"``O.interactions`` does not have them.\n\n"
		"Errors: ``ValueError`` for parameters, and for a bonded body that is gone or is no grain; ``RuntimeError`` in a periodic scene.\n\n"
		"Example::\n\n\tcement=GrainBonds(emod=1e9,kratio=2.5,tensileStrength=1e6,cohesion=2e6)\n\tcement.bond([b.id for b in O.bodies if isinstance(b.shape,Sphere)])",
		((Real,kn,NaN,,"Normal stiffness by area of bonds that are made [N/m³], > 0, with ks (PFC: pb_kn); or emod and kratio."))
		((Real,ks,NaN,,"Shear stiffness by area [N/m³], >= 0 (PFC: pb_ks)."))
		((Real,emod,NaN,,"Modulus of the cement [Pa], > 0: kn = E/(R1 + R2) (PFC: emod of pb_deformability)."))
		((Real,kratio,NaN,,"kn/ks [-], > 0, with emod (PFC: pb_kratio)."))
		((Real,radiusMultiplier,1,,"λ [-], > 0: the disc's radius over the smaller grain's (PFC: pb_rmul)."))
		((Real,tensileStrength,NaN,,"Tensile strength [Pa], >= 0, may be inf (PFC: pb_ten). Required."))
		((Real,cohesion,NaN,,"Shear strength without normal stress [Pa], >= 0, may be inf (PFC: pb_coh). Required."))
		((Real,frictionAngle,0,,"Friction angle φ of the bond [rad], 0 to below π/2 (PFC: pb_fa, in degrees)."))
		((Real,momentFactor,1,,"β [-], 0 to 1: share of the moments in the stresses (PFC: pb_mcf)."))
		((int,tensileBreaks,0,Attr::readonly,"Bonds that broke in tension so far."))
		((int,shearBreaks,0,Attr::readonly,"Bonds that broke in shear so far."))
		// The table as of the last save.
		((vector<Vector2i>,savedIds,,Attr::hidden,""))
		((vector<Real>,savedNumbers,,Attr::hidden,""))
		,/*ctor*/,
		.def("bond",&GrainBonds::bond,(boost::python::arg("ids"),boost::python::arg("gap")=0.),
			"Bonds each two of these spheres whose surfaces are nearer than gap [m], >= 0, and that have no bond of this engine yet. Returns the number of new bonds.")
		.def("take",&GrainBonds::take,
			(boost::python::arg("ids"),boost::python::arg("radius"),boost::python::arg("kn"),boost::python::arg("ks"),boost::python::arg("force"),boost::python::arg("moment")),
			"Makes bonds that were loaded elsewhere, a row each as bonds() tells them: 'ids' of the two grains (N, 2), 'radius' [m] > 0, 'kn' > 0 and 'ks' >= 0 [N/m³], 'force' [N] and 'moment' [N m] "
			"on the second grain (N, 3). The grains stand where the loads were computed: the rest length follows from the force along the line of centres. Strengths are the engine's. "
			"Returns their number. Nothing is made when a row is wrong, or its grains have a bond of this engine already.")
		.def("release",&GrainBonds::release,(boost::python::arg("ids")),
			"Takes away all bonds of these bodies, before they are erased for example. Returns their number; they do not count as broken.")
		.add_property("count",&GrainBonds::count,"Number of bonds that hold.")
		.def("elasticEnergy",&GrainBonds::elasticEnergy,"Elastic energy of all bonds [J] at the last step.")
		.def("bonds",&GrainBonds::bonds,
			"The bonds that hold, as a dict of arrays with a row each: 'ids' of the two grains, 'radius' [m], 'kn' and 'ks' [N/m³], 'point' [m], "
			"'force' [N] and 'moment' [N m] on the second grain, 'normalForce' [N] compression positive, 'tension' and 'shear', the stresses σ and τ [Pa].")
		.def("springs",&GrainBonds::springs,
			"What the critical time step needs, a row each: (ids, unit normals, [kn A, ks A, kn I, ks J] in N/m and N m, [distance from each centre to the bond] in m).")
	);
	// clang-format on
};
REGISTER_SERIALIZABLE(GrainBonds);

} // namespace yade
