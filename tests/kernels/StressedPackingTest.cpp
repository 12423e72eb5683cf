// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "Support.hpp"
#include "kernels/packing/GrainAssembly.hpp"
#include "kernels/base/Random.hpp"
#include "kernels/packing/StressedPacking.hpp"
#include "kernels/base/Check.hpp"

using namespace hexmembrane;

namespace {

constexpr double E = 1e7, stress = 2e4, R = 0.02, H = 0.04;

StressedPackingSpec spec(double porosity, double friction = 0.4, std::uint64_t seed = 1)
{
	Random random(3);
	StressedPackingSpec s;
	s.packing = {R, H, {}, porosity, seed};
	for (int i = 0; i < 200; ++i) s.packing.radii.push_back(1e-3 * (1 + 0.8 * random.uniform()));
	s.stress = stress;
	s.law = {E, 3, friction, 0.5};
	return s;
}

} // namespace

TEST(StressedPacking, isWhatWasAsked)
{
	for (const double porosity : {0.43, 0.45}) {
		const StressedPacking p = packUnderStress(spec(porosity));
		EXPECT_NEAR(p.porosity, porosity, 1e-3);
		EXPECT_NEAR(packingPorosity(p.radii, R, H), p.porosity, 1e-12);
		EXPECT_NEAR((2 * p.radialStress + p.axialStress) / 3 / stress, 1, 0.03);
		EXPECT_NEAR(p.radialStress / p.axialStress, 1, 0.25) << "200 grains only";
		EXPECT_LT(p.unbalanced, 1e-3);
		EXPECT_GT(p.coordination, 3);
		EXPECT_LT(p.maxOverlap, 0.07) << "a few contacts of 600 carry several times the mean force";
		EXPECT_GT(p.maxOverlap, 0);
		EXPECT_LT(p.frictionReached, 0.4);
	}
}

TEST(StressedPacking, handedOverWithoutItsShearSpringsItKeepsItsStress)
{
	// another program starts with the places and radii alone
	const StressedPackingSpec s = spec(0.44);
	const StressedPacking p = packUnderStress(s);
	GrainAssembly again(p.centres, p.radii, 1, R, H, s.law);
	for (int i = 0; i < 5000; ++i) again.step(0);
	EXPECT_NEAR(again.meanStress() / s.stress, 1, 0.15);
	EXPECT_LT(again.unbalancedRatio(), 1e-3);
}

TEST(StressedPacking, sameSeedSameBits)
{
	const StressedPacking a = packUnderStress(spec(0.45, 0.4, 2)), b = packUnderStress(spec(0.45, 0.4, 2));
	for (int i = 0; i < 200; ++i) EXPECT_EQ((a.centres[i] - b.centres[i]).norm(), 0);
	EXPECT_EQ(a.scale, b.scale);
}

TEST(StressedPacking, denserMeansMoreContactsAndLessFrictionOnTheWay)
{
	const StressedPacking dense = packUnderStress(spec(0.43)), loose = packUnderStress(spec(0.455));
	EXPECT_GT(dense.coordination, loose.coordination);
	EXPECT_LT(dense.frictionReached, loose.frictionReached);
}

TEST(StressedPacking, saysWhatCanBeReached)
{
	const auto message = [](double porosity) {
		try {
			packUnderStress(spec(porosity));
		} catch (const std::runtime_error& e) {
			return std::string(e.what());
		}
		return std::string();
	};
	const auto advised = [](const std::string& text, const std::string& mark) { return std::stod(text.substr(text.find(mark) + mark.size())); };
	const std::string dense = message(0.37), loose = message(0.56);
	ASSERT_NE(dense.find("a porosity of at least "), std::string::npos) << dense;
	ASSERT_NE(loose.find("a porosity of at most "), std::string::npos) << loose;
	for (const double porosity : {advised(dense, "at least "), advised(loose, "at most ")})
		EXPECT_NEAR(packUnderStress(spec(porosity)).porosity, porosity, 1e-3);
}

/// Contacts a grain over those that it needs to stand still without friction, three (Maxwell's count). Grains with fewer than four contacts hold nothing.
double contactsOverMaxwell(const StressedPacking& p)
{
	const int n = static_cast<int>(p.radii.size());
	std::vector<int> touching(n, 0);
	int walls = 0, pairs = 0;
	for (int i = 0; i < n; ++i) {
		const Vec3& x = p.centres[i];
		const double r = p.radii[i];
		const int onWalls = (x[2] < r) + (x[2] + r > H) + (std::hypot(x[0], x[1]) + r > R);
		walls += onWalls;
		touching[i] += onWalls;
		for (int j = i + 1; j < n; ++j) {
			if ((p.centres[j] - x).norm() >= r + p.radii[j]) continue;
			++pairs;
			++touching[i];
			++touching[j];
		}
	}
	const int holding = std::count_if(touching.begin(), touching.end(), [](int contacts) { return contacts >= 4; });
	return (pairs + walls) / (3.0 * holding);
}

TEST(StressedPacking, withoutFrictionItHasADensityOfItsOwn)
{
	for (const double friction : {0., 5e-5}) {
		const StressedPacking p = packUnderStress(spec(NAN, friction));
		EXPECT_NEAR((2 * p.radialStress + p.axialStress) / 3 / stress, 1, 0.03);
		EXPECT_LT(p.unbalanced, 1e-3);
		EXPECT_NEAR(packingPorosity(p.radii, R, H), p.porosity, 1e-12);
		EXPECT_NEAR(p.porosity, 0.426, 0.01) << "the dense limit of the packings with friction";
		EXPECT_EQ(p.frictionReached, friction);
		EXPECT_GT(contactsOverMaxwell(p), 1);
		EXPECT_LT(contactsOverMaxwell(p), 1.15) << "more than overlaps of 1e-3 make";
	}
}

TEST(StressedPacking, withoutFrictionOnlyItsOwnPorosityIsTaken)
{
	const double own = packUnderStress(spec(NAN, 0)).porosity;
	EXPECT_EQ(packUnderStress(spec(own, 0)).porosity, own);
	EXPECT_EQ(packUnderStress(spec(own + 0.9e-3, 0)).porosity, own) << "within the tolerance";
	for (const double porosity : {own - 0.02, own + 0.02}) {
		try {
			packUnderStress(spec(porosity, 0));
			FAIL() << porosity;
		} catch (const FieldFailure& e) {
			EXPECT_EQ(e.complaint().field, "porosity");
			EXPECT_NE(e.complaint().wrong.find(formatNumber(own) + " was reached"), std::string::npos) << e.what();
			EXPECT_NE(e.complaint().fix.find("nan"), std::string::npos) << e.what();
		}
	}
}

// What is asked for stands in the message, not what the packing starts with.
TEST(StressedPacking, aPorosityFarOutOfReachIsNamedAsAsked)
{
	try {
		packUnderStress(spec(0.3));
		FAIL();
	} catch (const FieldFailure& e) {
		EXPECT_EQ(e.complaint().value, "0.3") << e.what();
		EXPECT_NE(e.complaint().wrong.find("with friction 0.4"), std::string::npos) << e.what();
	}
}

TEST(StressedPacking, rollingFrictionHoldsLooserOnes)
{
	StressedPackingSpec loose = spec(0.49);
	EXPECT_THROW(packUnderStress(loose), std::runtime_error);
	loose.law.rollingFriction = 0.5;
	const StressedPacking p = packUnderStress(loose);
	EXPECT_NEAR(p.porosity, 0.49, 1e-3);
	EXPECT_NEAR((2 * p.radialStress + p.axialStress) / 3 / stress, 1, 0.03);
	EXPECT_LT(p.unbalanced, 1e-3);
}

TEST(StressedPacking, refusesBadInput)
{
	const auto with = [](auto change) {
		StressedPackingSpec s = spec(0.45);
		change(s);
		packUnderStress(s);
	};
	EXPECT_COMPLAINT(with([](auto& s) { s.packing.porosity = NAN; }), "porosity = nan");
	EXPECT_COMPLAINT(with([](auto& s) { s.packing.porosity = 0.9; }), "porosity = 0.9");
	EXPECT_COMPLAINT(with([](auto& s) { s.packing.porosity = -0.01; }), "porosity = -0.01");
	EXPECT_COMPLAINT(with([](auto& s) { s.packing.radius = -1; }), "radius = -1");
	EXPECT_COMPLAINT(with([](auto& s) { s.stress = 0; }), "stress = 0");
	EXPECT_COMPLAINT(with([](auto& s) { s.stress = E; }), "stress");
	EXPECT_COMPLAINT(with([](auto& s) { s.law.modulus = NAN; }), "modulus = nan");
	EXPECT_COMPLAINT(with([](auto& s) { s.law.stiffnessRatio = 0.5; }), "stiffnessRatio = 0.5");
	EXPECT_COMPLAINT(with([](auto& s) { s.law.friction = -0.1; }), "friction = -0.1");
	EXPECT_COMPLAINT(with([](auto& s) { s.law.rollingFriction = -0.1; }), "rollingFriction = -0.1");
	EXPECT_COMPLAINT(with([](auto& s) { s.law.damping = 1; }), "damping = 1");
	EXPECT_COMPLAINT(with([](auto& s) { s.porosityTolerance = 0.5; }), "porosityTolerance = 0.5");
}
