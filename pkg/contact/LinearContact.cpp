// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "LinearContact.hpp"

#include <core/Omega.hpp>
#include <core/Scene.hpp>
#include "kernels/base/Check.hpp"
#include <pkg/common/Sphere.hpp>

#include <boost/make_shared.hpp>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <tuple>

namespace yade {

YADE_PLUGIN((LinearMat)(LinearPhys)(Ip2_LinearMat_LinearMat_LinearPhys));

namespace {

bool given(Real value) { return !math::isnan(value); }

void requireStrength(const string& parameter, Real strength)
{
	if (!(strength >= 0)) hexmembrane::reject(parameter, strength, "a strength must not be negative", "give a number >= 0 in N, or inf");
}

void refuseBoth(const string& parameter, Real value)
{
	if (given(value))
		hexmembrane::reject(parameter, value, "stiffness is given twice", "either kn and ks, or emod and kratio; take one back by setting it to nan");
}

// young and poisson may be as they were, as they must be now, or not there; anything else was set by hand.
void refuseDerived(const string& parameter, Real value, Real before, Real now)
{
	if (given(value) && value != before && value != now)
		hexmembrane::reject(parameter, value, "follows from the stiffness", "give kn and ks, or emod and kratio");
}

} // namespace

LinearMat::Values LinearMat::values() const { return {kn, ks, emod, kratio, rollingFriction, cbTensile, cbShear, young, poisson}; }

void LinearMat::check() const
{
	if (given(kn)) hexmembrane::requirePositive("LinearMat.kn", kn, "N/m");
	if (given(ks)) hexmembrane::requireNonNegative("LinearMat.ks", ks, "N/m");
	if (given(emod)) hexmembrane::requirePositive("LinearMat.emod", emod, "Pa");
	if (given(kratio)) hexmembrane::requirePositive("LinearMat.kratio", kratio, "1");
	if (given(kn) || given(ks)) {
		refuseBoth("LinearMat.emod", emod);
		refuseBoth("LinearMat.kratio", kratio);
	}
	hexmembrane::requireIn(hexmembrane::shared::rolling_friction, "LinearMat.rollingFriction", rollingFriction, "1");
	requireStrength("LinearMat.cbTensile", cbTensile);
	requireStrength("LinearMat.cbShear", cbShear);
}

void LinearMat::postLoad(LinearMat&)
{
	const Real youngNow = 0.5 * M_PI * emod, poissonNow = given(kratio) ? 1 / kratio : ks / kn;
	try {
		check();
		refuseDerived("LinearMat.young", young, accepted.young, youngNow);
		refuseDerived("LinearMat.poisson", poisson, accepted.poisson, poissonNow);
	} catch (const std::invalid_argument&) {
		std::tie(kn, ks, emod, kratio) = std::tie(accepted.kn, accepted.ks, accepted.emod, accepted.kratio);
		std::tie(rollingFriction, cbTensile, cbShear) = std::tie(accepted.rollingFriction, accepted.cbTensile, accepted.cbShear);
		std::tie(young, poisson) = std::tie(accepted.young, accepted.poisson);
		throw;
	}
	young = youngNow;
	poisson = poissonNow;
	accepted = values();
}

Real LinearMat::getFriction() const { return math::tan(frictionAngle); }

void LinearMat::setFriction(Real coefficient)
{
	hexmembrane::requireIn(hexmembrane::shared::friction, "LinearMat.friction", coefficient, "1");
	frictionAngle = math::atan(coefficient);
}

void LinearMat::pyHandleCustomCtorArgs(boost::python::tuple&, boost::python::dict& keywords)
{
	// A property is no attribute, so YADE's constructor from keywords does not know it.
	if (!keywords.has_key("friction")) return;
	const Real coefficient = boost::python::extract<Real>(keywords["friction"]);
	if (keywords.has_key("frictionAngle")) hexmembrane::reject("LinearMat.friction", coefficient, "friction is given twice", "friction or frictionAngle");
	setFriction(coefficient);
	keywords["friction"].del();
}

void LinearMat::requireComplete() const
{
	if (!given(emod) && !given(kn)) hexmembrane::reject("LinearMat.kn", kn, "no stiffness is given", "give kn and ks, or emod and kratio");
	if (given(emod))
		hexmembrane::requirePositive("LinearMat.kratio", kratio, "1");
	else
		hexmembrane::requireNonNegative("LinearMat.ks", ks, "N/m");
	hexmembrane::requireIn(hexmembrane::shared::friction, "LinearMat.friction", getFriction(), "1");
}

namespace {

constexpr std::array<const char*, hexmembrane::PairProperties::numbers> pairNames{"kn", "ks", "emod", "kratio", "friction", "rollingFriction"};

void checkPair(const string& call, const hexmembrane::PairProperties& own)
{
	if (given(own.kn)) hexmembrane::requirePositive(call + "kn", own.kn, "N/m");
	if (given(own.ks)) hexmembrane::requireNonNegative(call + "ks", own.ks, "N/m");
	if (given(own.emod)) hexmembrane::requirePositive(call + "emod", own.emod, "Pa");
	if (given(own.kratio)) hexmembrane::requirePositive(call + "kratio", own.kratio, "1");
	if ((given(own.kn) || given(own.ks)) && (given(own.emod) || given(own.kratio)))
		hexmembrane::reject(call + "kn", own.kn, "stiffness is given twice", "either kn and ks, or emod and kratio");
	const char* const half = "the stiffness is given in half";
	if (given(own.kn) != given(own.ks)) hexmembrane::reject(call + (given(own.kn) ? "ks" : "kn"), NaN, half, "give both kn and ks in N/m");
	if (given(own.emod) != given(own.kratio))
		hexmembrane::reject(call + (given(own.emod) ? "kratio" : "emod"), NaN, half, "give both emod in Pa and kratio");
	if (given(own.friction)) hexmembrane::requireIn(hexmembrane::shared::friction, call + "friction", own.friction, "1");
	if (given(own.rollingFriction)) hexmembrane::requireIn(hexmembrane::shared::rolling_friction, call + "rollingFriction", own.rollingFriction, "1");
	if (own == hexmembrane::PairProperties())
		hexmembrane::reject(call + "kn", NaN, "nothing is given",
		                    "kn and ks, emod and kratio, friction or rollingFriction; LinearMat.removePair takes a pair back");
}

} // namespace

void LinearMat::setPair(const string& partner, Real kn, Real ks, Real emod, Real kratio, Real friction, Real rollingFriction)
{
	const string call = "LinearMat.setPair.";
	if (partner.empty())
		hexmembrane::reject(call + "partner", "''", "a material without a label cannot be named", "give materials a label, and the partner's here");
	checkPair(call, {kn, ks, emod, kratio, friction, rollingFriction});
	const Real numbers[] = {kn, ks, emod, kratio, friction, rollingFriction};
	const auto at = std::find(pairPartners.begin(), pairPartners.end(), partner);
	const size_t place = at - pairPartners.begin();
	if (at == pairPartners.end()) {
		pairPartners.push_back(partner);
		pairNumbers.resize(pairNumbers.size() + pairNames.size());
	}
	std::copy(std::begin(numbers), std::end(numbers), pairNumbers.begin() + place * pairNames.size());
}

void LinearMat::removePair(const string& partner)
{
	const auto at = std::find(pairPartners.begin(), pairPartners.end(), partner);
	if (at == pairPartners.end())
		hexmembrane::reject("LinearMat.removePair.partner", "'" + partner + "'", "has no properties here", "see LinearMat.pairs()");
	const auto first = pairNumbers.begin() + (at - pairPartners.begin()) * pairNames.size();
	pairNumbers.erase(first, first + pairNames.size());
	pairPartners.erase(at);
}

boost::python::dict LinearMat::pairs() const
{
	boost::python::dict all;
	for (size_t p = 0; p < pairPartners.size(); ++p) {
		boost::python::dict one;
		for (size_t k = 0; k < pairNames.size(); ++k) {
			const Real number = pairNumbers[p * pairNames.size() + k];
			if (given(number)) one[pairNames[k]] = number;
		}
		all[pairPartners[p]] = one;
	}
	return all;
}

boost::optional<hexmembrane::PairProperties> LinearMat::pairWith(const string& partner) const
{
	const auto at = std::find(pairPartners.begin(), pairPartners.end(), partner);
	if (at == pairPartners.end()) return boost::none;
	const Real* const n = pairNumbers.data() + (at - pairPartners.begin()) * pairNames.size();
	return hexmembrane::PairProperties{n[0], n[1], n[2], n[3], n[4], n[5]};
}

boost::optional<hexmembrane::PairProperties> LinearMat::ownPair(const LinearMat& a, const LinearMat& b)
{
	const auto ofA = a.pairWith(b.label), ofB = b.pairWith(a.label);
	if (ofA && ofB && !(*ofA == *ofB))
		hexmembrane::reject("LinearMat.setPair.partner", "'" + b.label + "'",
		                    "'" + a.label + "' and '" + b.label + "' each have other properties for the other", "LinearMat.removePair of one of them");
	return ofA ? ofA : ofB;
}

hexmembrane::MaterialPair LinearMat::pairOf(const LinearMat& a, const LinearMat& b)
{
	const auto own = ownPair(a, b);
	const hexmembrane::ContactMaterial ma = a.contactMaterial(), mb = b.contactMaterial();
	return own ? hexmembrane::paired(ma, mb, *own) : hexmembrane::MaterialPair{ma, mb};
}

Real LinearMat::pairFriction(const LinearMat& other) const
{
	const auto pair = pairOf(*this, other);
	return hexmembrane::kindOf(pair.a, pair.b).friction;
}

hexmembrane::ContactMaterial LinearMat::contactMaterial() const { return {kn, ks, emod, kratio, getFriction(), rollingFriction}; }

void LinearPhys::bond(Real tensile, Real shear)
{
	if (!(tensile > 0)) hexmembrane::reject("LinearPhys.bond.tensile", tensile, "must be positive", "give a number > 0 in N, or inf");
	if (!(shear > 0)) hexmembrane::reject("LinearPhys.bond.shear", shear, "must be positive", "give a number > 0 in N, or inf");
	tensileStrength = tensile;
	shearStrength = shear;
	bonded = true;
}

namespace {

// Radius of the body if it is a sphere, NaN for a boundary.
Real sphereRadius(const Body& body)
{
	const auto sphere = dynamic_cast<const Sphere*>(body.shape.get());
	return sphere ? sphere->radius : NaN;
}

void bondByMaterial(LinearPhys& phys, const LinearMat& a, const LinearMat& b)
{
	const Real tensile = math::min(a.cbTensile, b.cbTensile), shear = math::min(a.cbShear, b.cbShear);
	if (tensile > 0 && shear > 0) phys.bond(tensile, shear);
}

} // namespace

void Ip2_LinearMat_LinearMat_LinearPhys::go(const shared_ptr<Material>& material1, const shared_ptr<Material>& material2,
                                            const shared_ptr<Interaction>& contact)
{
	if (contact->phys) return;
	const LinearMat &a = static_cast<const LinearMat&>(*material1), &b = static_cast<const LinearMat&>(*material2);
	a.requireComplete();
	b.requireComplete();
	const Real r1 = sphereRadius(*Body::byId(contact->getId1(), scene)), r2 = sphereRadius(*Body::byId(contact->getId2(), scene));
	if (!given(r1) && !given(r2))
		throw std::runtime_error("Ip2_LinearMat_LinearMat_LinearPhys: neither #" + std::to_string(contact->getId1()) + " nor #" +
		                         std::to_string(contact->getId2()) + " is a Sphere; fix: use these contacts for spheres and for spheres on boundaries");

	const bool spheres = given(r1) && given(r2);
	const hexmembrane::MaterialPair pair = LinearMat::pairOf(a, b);
	const auto law = spheres ? hexmembrane::sphereLaw(pair.a, pair.b, r1, r2) : hexmembrane::boundaryLaw(pair.a, pair.b, given(r1) ? r1 : r2);
	auto phys = boost::make_shared<LinearPhys>();
	phys->set(law, spheres);
	if (bondNewContacts) bondByMaterial(*phys, a, b);
	contact->phys = phys;
}

int Ip2_LinearMat_LinearMat_LinearPhys::bondContacts()
{
	Scene* const here = Omega::instance().getScene().get();
	int made = 0;
	for (const auto& contact : *here->interactions) {
		LinearPhys* phys = contact->isReal() ? dynamic_cast<LinearPhys*>(contact->phys.get()) : nullptr;
		if (!phys || phys->bonded) continue;
		const auto material = [&](Body::id_t id) { return dynamic_cast<const LinearMat*>(Body::byId(id, here)->material.get()); };
		const LinearMat *a = material(contact->getId1()), *b = material(contact->getId2());
		if (a && b) bondByMaterial(*phys, *a, *b);
		made += phys->bonded;
	}
	return made;
}

} // namespace yade
