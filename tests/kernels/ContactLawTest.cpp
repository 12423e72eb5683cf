// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/contact/ContactMaterial.hpp"

#include "Support.hpp"

namespace {

using namespace hexmembrane;

constexpr double inf = std::numeric_limits<double>::infinity();

// kn, ks, mu, kr, mu_r Rbar, bond strengths
ContactLaw rollingLaw() { return {{1e5, 4e4, 0.4, 0.04, 2e-4}, 0, 0}; }

ContactLaw bondLaw(double tensile, double shear)
{
	ContactLaw law = rollingLaw();
	law.tensileStrength = tensile;
	law.shearStrength = shear;
	return law;
}

struct OneContact {
	ContactMemory<double> memory = noMemory();
	Vec3 &shear = memory.shear, &moment = memory.moment;
	bool bonded = false;
	ContactStep advance(const ContactLaw& law, double overlap, const Vec3& slide, const Vec3& bend = Vec3::Zero())
	{
		return advanceContact(law, {overlap, slide, bend}, memory, bonded);
	}
};

TEST(ContactLaw, DeformabilityIsPfcs)
{
	const double pi = 3.14159265358979323846;
	EXPECT_DOUBLE_EQ(contactShape(2e-3, 3e-3), pi * 4e-6 / 5e-3);
	EXPECT_DOUBLE_EQ(contactShape(3e-3, 2e-3), contactShape(2e-3, 3e-3));
	EXPECT_DOUBLE_EQ(contactShape(2e-3), pi * 2e-3);
	EXPECT_DOUBLE_EQ(rollingRadius(2e-3, 3e-3), 1.2e-3);
	// A boundary is the limit of a large sphere, for the lever of rolling; not so for the stiffness, where PFC takes R instead of R1 + R2.
	EXPECT_NEAR(rollingRadius(2e-3, 1e9), 2e-3, 1e-14);
}

TEST(ContactLaw, SpringsAddInSeries)
{
	const double shape = contactShape(2e-3, 3e-3);
	const Springs equal = inSeries(springsByModulus(1e8, 3, shape), springsByModulus(1e8, 3, shape));
	EXPECT_NEAR(equal.kn, 1e8 * shape, 1e-12 * equal.kn);
	EXPECT_NEAR(equal.ks, equal.kn / 3, 1e-12 * equal.kn);
	const Springs direct = inSeries({2e5, 1e5}, {3e5, 0});
	EXPECT_NEAR(direct.kn, 1.2e5, 1e-9);
	EXPECT_EQ(direct.ks, 0);
}

TEST(ContactLaw, PairsOfMaterialsHaveTheirOwn)
{
	ContactMaterial soft, hard;
	soft.emod = 1e7;
	soft.kratio = 3;
	soft.friction = 0.1;
	hard.kn = hard.ks = 1e9;
	hard.rollingFriction = 0.5;
	PairProperties own;
	const MaterialPair same = paired(soft, hard, own);
	EXPECT_TRUE(same.a == soft && same.b == hard) << "nothing is given";
	own.friction = 0.7;
	EXPECT_EQ(boundaryLaw(paired(soft, hard, own).a, paired(soft, hard, own).b, 1e-3).friction, 0.7);
	EXPECT_EQ(boundaryLaw(paired(soft, hard, own).a, paired(soft, hard, own).b, 1e-3).kn, boundaryLaw(soft, hard, 1e-3).kn);
	own.kn = 3e6;
	own.ks = 0;
	const MaterialPair direct = paired(soft, hard, own);
	for (double r : {1e-4, 1e-3}) {
		EXPECT_DOUBLE_EQ(sphereLaw(direct.a, direct.b, r, 2 * r).kn, 3e6);
		EXPECT_DOUBLE_EQ(boundaryLaw(direct.a, direct.b, r).kn, 3e6);
		EXPECT_EQ(boundaryLaw(direct.a, direct.b, r).ks, 0);
	}
	own.kn = own.ks = std::nan("");
	own.emod = 2e8;
	own.kratio = 4;
	own.rollingFriction = 0.2;
	const MaterialPair modulus = paired(soft, hard, own);
	const ContactLaw law = sphereLaw(modulus.a, modulus.b, 1e-3, 3e-3);
	EXPECT_DOUBLE_EQ(law.kn, M_PI * 2e8 * 1e-6 / 4e-3);
	EXPECT_DOUBLE_EQ(law.ks, law.kn / 4);
	EXPECT_DOUBLE_EQ(law.rollingArm, 0.2 * 0.75e-3);
}

TEST(ContactLaw, NormalForceHasNoTension)
{
	OneContact contact;
	EXPECT_DOUBLE_EQ(contact.advance(rollingLaw(), 1e-5, Vec3::Zero()).normal, 1.0);
	EXPECT_FALSE(contact.advance(rollingLaw(), 0, Vec3::Zero()).open);
	const ContactStep gone = contact.advance(rollingLaw(), -1e-12, Vec3::Zero());
	EXPECT_TRUE(gone.open);
	EXPECT_EQ(gone.normal, 0);
}

TEST(ContactLaw, ShearGrowsByKsAndSlipsAtMuN)
{
	const ContactLaw law = rollingLaw();
	const double overlap = 1e-5, limit = law.friction * law.kn * overlap;
	OneContact contact;
	double work = 0;
	for (int i = 1; i <= 30; i++) {
		work += contact.advance(law, overlap, {6e-7, 8e-7, 0}).works.slip;
		const double size = std::min(law.ks * 1e-6 * i, limit);
		EXPECT_NEAR(contact.shear[0], -0.6 * size, 1e-12 * limit);
		EXPECT_NEAR(contact.shear[1], -0.8 * size, 1e-12 * limit);
	}
	// What slid: the whole way less what the spring still holds (the limit is met at the end of a step).
	EXPECT_NEAR(work, limit * (30e-6 - limit / law.ks), 1e-12 * limit * 30e-6);
}

TEST(ContactLaw, MomentGrowsByKrUpToThePlasticMoment)
{
	const ContactLaw law = rollingLaw();
	const double overlap = 1e-5, limit = law.rollingArm * law.kn * overlap;
	OneContact contact;
	double work = 0;
	for (int i = 1; i <= 20; i++) work += contact.advance(law, overlap, Vec3::Zero(), {0, -1e-3, 0}).works.roll;
	EXPECT_NEAR(contact.moment[1], limit, 1e-12 * limit);
	EXPECT_NEAR(work, limit * (20e-3 - limit / law.kr), 1e-12 * limit);
	// Back: elastic from the first step on.
	EXPECT_EQ(contact.advance(law, overlap, Vec3::Zero(), {0, 1e-3, 0}).works.roll, 0);
	EXPECT_NEAR(contact.moment[1], limit - law.kr * 1e-3, 1e-12 * limit);
}

// Whatever the path and the normal force do: work done by the bodies = gain in elastic energy + dissipation, by the trapezoid rule, to rounding.
TEST(ContactLaw, WorkIsElasticOrDissipated)
{
	const ContactLaw law = rollingLaw();
	std::mt19937_64 random(7);
	std::uniform_real_distribution<double> u(-1, 1);
	OneContact contact;
	double done = 0, dissipated = 0, cuts = 0;
	for (int i = 0; i < 2000; i++) {
		const Vec3 slide = 1e-5 * Vec3(u(random), u(random), 0), bend = 0.05 * Vec3(u(random), u(random), 0);
		const Vec3 shear = contact.shear, moment = contact.moment;
		const ContactStep step = contact.advance(law, 2e-5 * (1.01 + u(random)), slide, bend);
		done -= 0.5 * (shear + contact.shear).dot(slide) + 0.5 * (moment + contact.moment).dot(bend);
		dissipated += step.works.slip + step.works.roll;
		cuts += step.works.slip != 0;
	}
	const double elastic = contactEnergy(law, 0, contact.memory);
	EXPECT_GT(cuts, 500);
	EXPECT_LT(cuts, 2000);
	EXPECT_GT(elastic, 0);
	EXPECT_NEAR(done, elastic + dissipated, 1e-12 * done);
	// What is left when the contact opens is booked, too.
	const ContactStep gone = contact.advance(law, -1e-9, Vec3::Zero());
	EXPECT_NEAR(gone.works.slip + gone.works.roll, elastic, 1e-12 * elastic);
	EXPECT_TRUE(contact.shear.isZero(0) && contact.moment.isZero(0));
}

TEST(ContactLaw, OnlyWhatIsAskedFor)
{
	ContactLaw law = rollingLaw();
	law.friction = law.kr = 0;
	OneContact contact;
	const ContactStep step = contact.advance(law, 1e-5, {1e-6, 0, 0}, Vec3::Constant(1.));
	EXPECT_EQ(step.works.slip, 0);
	EXPECT_TRUE(contact.shear.isZero(0) && contact.moment.isZero(0));
	law.ks = 0;
	contact.advance(law, 1e-5, Vec3::Constant(1.));
	EXPECT_TRUE(contact.shear.isZero(0));
}

// A script may switch a spring off while it holds a load: the load goes, and no energy comes of it.
TEST(ContactLaw, ASpringThatIsSwitchedOffLetsGo)
{
	ContactLaw law = rollingLaw();
	OneContact contact;
	contact.advance(law, 1e-5, {1e-6, 0, 0}, {0, 1e-4, 0});
	EXPECT_GT(contact.shear.norm(), 0);
	EXPECT_GT(contact.moment.norm(), 0);
	law.ks = law.kr = 0;
	const ContactStep step = contact.advance(law, 1e-5, {1e-6, 0, 0}, {0, 1e-4, 0});
	EXPECT_TRUE(contact.shear.isZero(0) && contact.moment.isZero(0));
	EXPECT_EQ(step.works.slip, 0);
	EXPECT_EQ(step.works.roll, 0);
	EXPECT_EQ(step.normal, law.kn * 1e-5);
}

// Friction that is switched off lets the springs go as well, and what they held is dissipated.
TEST(ContactLaw, FrictionThatIsSwitchedOffDissipatesWhatWasHeld)
{
	ContactLaw law = rollingLaw();
	OneContact contact;
	contact.advance(law, 1e-5, {1e-6, 0, 0}, {0, 1e-4, 0});
	const double held = contactEnergy(law, 0, contact.memory);
	law.friction = law.rollingArm = 0;
	const ContactStep step = contact.advance(law, 1e-5, Vec3::Zero());
	EXPECT_TRUE(contact.shear.isZero(0) && contact.moment.isZero(0));
	EXPECT_NEAR(step.works.slip + step.works.roll, held, 1e-15 * held);
}

TEST(ContactLaw, BondHoldsTensionAndNeverSlips)
{
	const ContactLaw law = bondLaw(2, 3);
	OneContact contact;
	contact.bonded = true;
	contact.moment = {1e-5, 0, 0};
	const ContactStep step = contact.advance(law, -1.9e-5, {2.9 / law.ks, 0, 0}, {1, 0, 0});
	EXPECT_NEAR(step.normal, -1.9, 1e-12);
	EXPECT_NEAR(contact.shear[0], -2.9, 1e-12); // mu N would be nothing
	EXPECT_TRUE(contact.moment.isZero(0));
	EXPECT_DOUBLE_EQ(step.works.roll, 0.5e-10 / law.kr);
	EXPECT_TRUE(contact.bonded && !step.open && step.bond == BondBreak::none && step.works.bond == 0);
}

TEST(ContactLaw, BreakInTensionTakesBothForces)
{
	const ContactLaw law = bondLaw(2, 3);
	OneContact contact;
	contact.bonded = true;
	contact.shear = {1, 0, 0};
	const ContactStep step = contact.advance(law, -2.001e-5, Vec3::Zero());
	EXPECT_TRUE(step.bond == BondBreak::tension && step.open && !contact.bonded);
	EXPECT_EQ(step.normal, 0);
	EXPECT_TRUE(contact.shear.isZero(0));
	EXPECT_NEAR(step.works.bond, 0.5 * 2.001 * 2.001 / law.kn + 0.5 / law.ks, 1e-15);
}

TEST(ContactLaw, BreakInShearKeepsWhatFrictionHolds)
{
	const ContactLaw law = bondLaw(2, 3);
	const Vec3 slide = {-3.001 / law.ks, 0, 0};
	for (const double normal : {5.0, 50.0}) { // mu N = 2 and 20
		OneContact contact;
		contact.bonded = true;
		const ContactStep step = contact.advance(law, normal / law.kn, slide);
		EXPECT_TRUE(step.bond == BondBreak::shear && !step.open && !contact.bonded);
		EXPECT_NEAR(step.normal, normal, 1e-12);
		const double kept = std::min(0.4 * normal, 3.001);
		EXPECT_NEAR(contact.shear[0], kept, 1e-12);
		EXPECT_NEAR(step.works.bond, 0.5 * (3.001 * 3.001 - kept * kept) / law.ks, 1e-12);
	}
	OneContact pulled;
	pulled.bonded = true;
	const ContactStep step = pulled.advance(law, -1e-5, slide);
	EXPECT_TRUE(step.bond == BondBreak::shear && step.open && !pulled.bonded && pulled.shear.isZero(0) && step.normal == 0);
}

TEST(ContactLaw, InfiniteStrengthNeverBreaks)
{
	OneContact contact;
	contact.bonded = true;
	EXPECT_TRUE(contact.advance(bondLaw(inf, inf), -1e3, {1e3, 0, 0}).bond == BondBreak::none && contact.bonded);
}

// Bodies renamed: normal, displacements and loads change sign, nothing else does.
TEST(ContactLaw, SwappedBodiesGiveTheOppositeLoads)
{
	const ContactLaw law = bondLaw(0.5, 0.6);
	std::mt19937_64 random(3);
	std::uniform_real_distribution<double> u(-1, 1);
	OneContact contact, swapped;
	contact.bonded = swapped.bonded = true;
	int breaks = 0;
	for (int i = 0; i < 200; i++) {
		const Vec3 slide = 1e-5 * Vec3(u(random), u(random), 0), bend = 0.01 * Vec3(u(random), u(random), 0);
		const double overlap = 1e-5 * (1 + u(random));
		const ContactStep a = contact.advance(law, overlap, slide, bend), b = swapped.advance(law, overlap, -slide, -bend);
		EXPECT_TRUE(a.normal == b.normal && a.works.slip == b.works.slip && a.works.roll == b.works.roll && a.bond == b.bond);
		EXPECT_TRUE(contact.shear == -swapped.shear && contact.moment == -swapped.moment);
		breaks += a.bond != BondBreak::none;
	}
	EXPECT_EQ(breaks, 1);
}

TEST(ContactLaw, RelativeVelocity)
{
	const Vec3 n(0, 0, 1), spin(3, -4, 5), pivot(0.7, 0.1, -0.4), x1(0, 0, 0), x2(0, 0, 3), point(0, 0, 1);
	// A rigid motion of both.
	EXPECT_LT(relativeVelocity(spin.cross(x1 - pivot), spin, point - x1, spin.cross(x2 - pivot), spin, point - x2).norm(), 1e-14);
	// Two gears: R1 spin1 = -R2 spin2.
	EXPECT_EQ(relativeVelocity(Vec3::Zero(), {2, 0, 0}, point - x1, Vec3::Zero(), {-1, 0, 0}, point - x2).norm(), 0);
	// Body 2 passes along x.
	EXPECT_EQ(relativeVelocity(Vec3::Zero(), Vec3::Zero(), point - x1, {1, 0, 0}, Vec3::Zero(), point - x2), Vec3(1, 0, 0));
	EXPECT_EQ(acrossNormal({1, 2, 3}, n), Vec3(1, 2, 0));
}

// A pair that turns as one body, once round, in ever smaller steps: the load comes back, with an error that shrinks with the step as 1/steps.
TEST(ContactLaw, LoadsTurnWithTheirContact)
{
	const double pi = 3.14159265358979323846;
	const Vec3 axis = Vec3(1, 2, -1).normalized();
	double last = 0;
	for (const int steps : {1000, 2000}) {
		const double angle = 2 * pi / steps;
		Vec3 normal(0, 0, 1), load(3, 4, 0);
		for (int i = 0; i < steps; i++) {
			const Vec3 next = Eigen::AngleAxisd(angle, axis) * normal;
			load = carried<Vec3>(load, normal.cross(next), normal.dot(angle * axis) * normal);
			normal = next;
		}
		const double error = (load - Vec3(3, 4, 0)).norm() / 5;
		EXPECT_LT(error, 4 * pi * pi / steps);
		if (last > 0) {
			EXPECT_NEAR(error / last, 0.5, 0.01);
		}
		last = error;
	}
	EXPECT_GT(last, 0);
}

TEST(ContactLaw, NanStaysNan)
{
	OneContact contact;
	const double nan = std::nan("");
	EXPECT_TRUE(std::isnan(contact.advance(rollingLaw(), nan, Vec3::Zero()).normal));
	OneContact sheared;
	sheared.advance(rollingLaw(), 1e-5, {nan, 0, 0});
	EXPECT_TRUE(std::isnan(sheared.shear[0]));
}

} // namespace
