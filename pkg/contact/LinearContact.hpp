// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <core/Dispatching.hpp>
#include "kernels/contact/ContactMaterial.hpp"
#include "SharedValues.hpp"
#include <pkg/common/ElastMat.hpp>
#include <pkg/dem/FrictPhys.hpp>
#include <pkg/dem/ScGeom.hpp>

#include <boost/optional.hpp>

namespace yade {

class LinearMat : public FrictMat {
public:
	virtual ~LinearMat() = default;

	/// What a body of this material brings to its contacts.
	hexmembrane::ContactMaterial contactMaterial() const;
	/// What contacts of these two have of their own; none: what the two bodies bring.
	/// \throws std::invalid_argument when each of the two has properties for the other
	static boost::optional<hexmembrane::PairProperties> ownPair(const LinearMat& a, const LinearMat& b);
	/// The two as they act in contacts with each other. \throws as ownPair()
	static hexmembrane::MaterialPair pairOf(const LinearMat& a, const LinearMat& b);
	void setPair(const string& partner, Real kn, Real ks, Real emod, Real kratio, Real friction, Real rollingFriction);
	void removePair(const string& partner);
	boost::python::dict pairs() const;
	Real pairFriction(const LinearMat& other) const;
	/// \throws std::invalid_argument when stiffness or friction were not given
	void requireComplete() const;
	void postLoad(LinearMat&);
	Real getFriction() const;
	void setFriction(Real coefficient);
	void pyHandleCustomCtorArgs(boost::python::tuple& arguments, boost::python::dict& keywords) override;

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(LinearMat,FrictMat,
		"Material of PFC's linear contact laws, for grains, platens, walls and membrane particles alike; contacts by Ip2_LinearMat_LinearMat_LinearPhys.\n\n"
		"Stiffness either directly (kn, ks: the body's own spring, in series with the partner's) or by PFC's deformability (emod, kratio: "
		"kn = π E* min(R1, R2)²/(R1 + R2) between two bodies of the same material, π E* R on a boundary, ks = kn/k*). "
		"Stiffness and friction are required; what is not given (NaN) is an error at the first contact. "
		"A value out of range is refused at once and nothing changes.\n\n"
		"``friction`` is PFC's coefficient μ; YADE's frictionAngle is the one that is kept, arctan μ, "
		"so that YADE's tools that set it (``setContactFriction``) work. "
		"young and poisson follow from the stiffness, do not set them: "
		"E = π E*/2, with which YADE's own rule for two equal spheres gives the same kn and PWaveTimeStep is of use (NaN for stiffness given "
		"directly), ν = ks/kn.\n\n"
		"Example::\n\n\tO.materials.append(LinearMat(emod=1e8,kratio=3,friction=.4,rollingFriction=.5,density=2650))",
		((Real,kn,NaN,Attr::triggerPostLoad,"Normal stiffness of the body's spring [N/m], > 0, with ks; or emod and kratio."))
		((Real,ks,NaN,Attr::triggerPostLoad,"Shear stiffness of the body's spring [N/m], >= 0."))
		((Real,emod,NaN,Attr::triggerPostLoad,"Effective modulus E* of contacts [Pa], > 0 (PFC: emod of the deformability method)."))
		((Real,kratio,NaN,Attr::triggerPostLoad,"k* = kn/ks [-], > 0 (PFC: kratio)."))
		((Real,rollingFriction,HEXMEMBRANE_ROLLING_FRICTION_DEFAULT,Attr::triggerPostLoad,"Rolling friction coefficient μr [-], " HEXMEMBRANE_ROLLING_FRICTION_RANGE
			" (PFC: rr_fric). The contact has the smaller one of its two bodies."))
		((Real,cbTensile,0,Attr::triggerPostLoad,
			"Tensile strength of a contact bond [N], >= 0, may be inf (PFC: cb_tenf). The contact has the smaller one; 0: no bond."))
		((Real,cbShear,0,Attr::triggerPostLoad,
			"Shear strength of a contact bond [N], >= 0, may be inf (PFC: cb_shearf). The contact has the smaller one; 0: no bond."))
		((vector<string>,pairPartners,,Attr::hidden,""))
		((vector<Real>,pairNumbers,,Attr::hidden,""))
		,
		createIndex();
		young=poisson=frictionAngle=NaN;
		,
		.add_property("friction",&LinearMat::getFriction,&LinearMat::setFriction,
			"Friction coefficient μ = tan frictionAngle [-], >= 0. The contact has the smaller one of its two bodies. Required.")
		.def("setPair",&LinearMat::setPair,(boost::python::arg("partner"),boost::python::arg("kn")=NaN,boost::python::arg("ks")=NaN,
			boost::python::arg("emod")=NaN,boost::python::arg("kratio")=NaN,boost::python::arg("friction")=NaN,boost::python::arg("rollingFriction")=NaN),
			"Gives contacts with materials of the label partner properties of their own, in place of those before (PFC: contact cmat, by pair of groups). "
			"What is not given follows from the two materials as without it.\n\n"
			"kn, ks [N/m] or emod [Pa], kratio [-]: stiffness of the contact itself, not of a spring in series: "
			"kn or π E* min(R1, R2)²/(R1 + R2), π E* R on a boundary. friction, rollingFriction [-]: those of the contact, beyond the smaller of both. "
			"One call serves for both bodies; the label may be the material's own. New contacts have it in the reference tier, all at once in the compact one.\n\n"
			"Raises ValueError for values out of range, stiffness in half, twice or not at all with nothing else given, or no label.\n\n"
			"Example::\n\n\tgrain.setPair('platen',kn=1e7,ks=5e6,friction=.3)")
		.def("removePair",&LinearMat::removePair,(boost::python::arg("partner")),"Takes back what setPair has given. Raises ValueError where there is nothing.")
		.def("pairs",&LinearMat::pairs,"What setPair has given: a dict of dicts, by partner's label and name of the property.")
		.def("pairFriction",&LinearMat::pairFriction,(boost::python::arg("other")),"Friction coefficient μ of contacts with another LinearMat [-], by setPair or the smaller of both.")
		.def("requireComplete",&LinearMat::requireComplete,"Raises ValueError when stiffness or friction were not given. Of use before a run: "
			"the same error inside YADE's interaction loop ends the program.")
	);
	// clang-format on
	REGISTER_CLASS_INDEX(LinearMat, FrictMat);

private:
	// Not its own values: what a refused assignment goes back to.
	struct Values {
		Real kn, ks, emod, kratio, rollingFriction, cbTensile, cbShear, young, poisson;
	};
	Values values() const;
	void check() const;
	/// What this one has for a partner of a label; none: nothing.
	boost::optional<hexmembrane::PairProperties> pairWith(const string& partner) const;
	Values accepted{NaN, NaN, NaN, NaN, 0, 0, 0, NaN, NaN};
};
REGISTER_SERIALIZABLE(LinearMat);

class LinearPhys : public RotStiffFrictPhys {
public:
	virtual ~LinearPhys() = default;
	void bond(Real tensile, Real shear);
	/// Takes the parameters of an unbonded contact, of two spheres or of a sphere and a boundary.
	void set(const hexmembrane::ContactLaw& law, bool ofSpheres)
	{
		kn = law.kn;
		ks = law.ks;
		tangensOfFrictionAngle = law.friction;
		rollingArm = law.rollingArm;
		kr = law.rollingArm > 0 ? law.kr : 0;
		spheres = ofSpheres;
	}
	/// Nothing but a normal force: no friction, rolling resistance or bond, and nothing left of them (they can be switched off while a test runs).
	bool normalOnly() const
	{
		return !(tangensOfFrictionAngle > 0) && !(rollingArm > 0) && !bonded && shearForce == Vector3r::Zero() && moment == Vector3r::Zero();
	}
	hexmembrane::ContactLaw law() const { return {{kn, ks, tangensOfFrictionAngle, kr, rollingArm}, tensileStrength, shearStrength}; }
	/// What the contact remembers, with its normal, and back.
	hexmembrane::ContactMemory<double> memory(const Vector3r& normal) const { return {shearForce, moment, normal}; }
	void remember(const hexmembrane::ContactMemory<double>& memory)
	{
		shearForce = memory.shear;
		moment = memory.moment;
	}

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(LinearPhys,RotStiffFrictPhys,
		"Contact of Law2_ScGeom_LinearPhys_Linear. Forces and moment are those on body 2, as everywhere in YADE; ktw is 0 (no twist resistance).",
		((Real,rollingArm,0,,"μr Rm [m]: the bending moment is at most this times the normal force; 0: no rolling resistance (then kr is 0, too)."))
		((Vector3r,moment,Vector3r::Zero(),,"Bending moment on body 2 [N m]."))
		((bool,bonded,false,Attr::readonly,"Whether the contact bond is there, see LinearPhys.bond."))
		((Real,tensileStrength,0,,"Tensile strength of the bond [N]."))
		((Real,shearStrength,0,,"Shear strength of the bond [N]."))
		((bool,spheres,true,Attr::readonly,"Both bodies are spheres: lever arms follow from radii and overlap. Otherwise the bodies' positions are looked up."))
		,
		createIndex();
		,
		.def("bond",&LinearPhys::bond,(boost::python::arg("tensile"),boost::python::arg("shear")),
			"Bonds the contact with these strengths [N], > 0 or inf. Forces stay; a moment is let go in the next step (the bond has none).")
	);
	// clang-format on
	REGISTER_CLASS_INDEX(LinearPhys, RotStiffFrictPhys);
};
REGISTER_SERIALIZABLE(LinearPhys);

class Ip2_LinearMat_LinearMat_LinearPhys : public IPhysFunctor {
public:
	void go(const shared_ptr<Material>& material1, const shared_ptr<Material>& material2, const shared_ptr<Interaction>& contact) override;
	int bondContacts();

	// clang-format off
	YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(Ip2_LinearMat_LinearMat_LinearPhys,IPhysFunctor,
		"Makes the LinearPhys of a new contact of two bodies of LinearMat, spheres both or a sphere and a boundary (Platen, Box, Facet, ...).\n\n"
		"kn, ks: the two bodies' springs in series, 1/k = 1/k1 + 1/k2 (PFC's inheritance of properties given by body); "
		"a body with emod brings kn = 2 π E* min(R1, R2)²/(R1 + R2) (2 π E* R on a boundary), "
		"so that equal materials give PFC's deformability formula. "
		"friction, rollingFriction, bond strengths: the smaller one. LinearMat.setPair gives a pair of materials a stiffness and frictions of its own. Rolling stiffness kr = ks Rm², Rm = R1 R2/(R1 + R2), on a boundary R.\n\n"
		"Existing contacts keep what they were made with. Errors end the program with their message, as every error inside YADE's interaction loop does.",
		((bool,bondNewContacts,false,,"New contacts whose two materials both have cbTensile > 0 and cbShear > 0 are bonded. "
			"Across gaps too where the Ig2's interactionDetectionFactor makes contacts."))
		,,
		.def("bondContacts",&Ip2_LinearMat_LinearMat_LinearPhys::bondContacts,
			"Bonds every existing contact that is not bonded and whose two materials both have cbTensile > 0 and cbShear > 0 (PFC: contact method bond). "
			"Returns their number.")
	);
	// clang-format on
	FUNCTOR2D(LinearMat, LinearMat);
};
REGISTER_SERIALIZABLE(Ip2_LinearMat_LinearMat_LinearPhys);

} // namespace yade
