// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "Support.hpp"
#include "kernels/packing/GrainAssembly.hpp"
#include "kernels/base/Random.hpp"
#include "kernels/packing/StressedPacking.hpp"
#include "kernels/base/Check.hpp"

#include <map>

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

/// The oracle of GrainAssembly: every pair in every step, shear springs in a map.
struct Reference {
	Reference(const SpherePacking& start, const GrainLaw& theLaw) : x(start.centres), base(start.radii), law(theLaw), v(x.size(), Vec3::Zero()), w(v) {}

	std::vector<Vec3> x;
	std::vector<double> base;
	GrainLaw law;
	double size = 1, side = 0;
	std::vector<Vec3> v, w;
	std::map<std::pair<std::size_t, std::size_t>, Vec3> shear, moment, normals;

	void step(double growth)
	{
		constexpr double dt = GrainAssembly::timeStep;
		size *= 1 + growth;
		side = 0;
		std::vector<Vec3> f(x.size(), Vec3::Zero()), t = f;
		for (std::size_t i = 0; i < x.size(); ++i) {
			const double ri = base[i] * size;
			for (std::size_t j = i + 1; j < x.size(); ++j) {
				const double rj = base[j] * size, dist = (x[j] - x[i]).norm(), kn = 2 * law.modulus / (1 / ri + 1 / rj);
				if (dist >= ri + rj) {
					shear.erase({i, j});
					moment.erase({i, j});
					normals.erase({i, j});
					continue;
				}
				const Vec3 n = (x[j] - x[i]).normalized(), atI = n * dist * ri / (ri + rj), atJ = -n * dist * rj / (ri + rj);
				const Vec3 slip = v[j] + w[j].cross(atJ) - v[i] - w[i].cross(atI);
				// loads turn with the contact: rotation of its normal, then the mean spin about it
				const bool old = normals.count({i, j}) > 0;
				const Vec3 n0 = old ? normals[{i, j}] : n;
				normals[{i, j}] = n;
				const auto turn = [&](Vec3& load) {
					load += n0.cross(n).cross(load);
					load += (0.5 * dt * n0.dot(w[i] + w[j]) * n0).cross(load);
				};
				Vec3& s = shear.emplace(std::make_pair(i, j), Vec3::Zero()).first->second;
				turn(s);
				s += kn / law.stiffnessRatio * dt * (slip - n * n.dot(slip));
				const double normal = kn * (ri + rj - dist);
				if (s.norm() > law.friction * normal) s = s.normalized() * law.friction * normal;
				f[i] += s - normal * n;
				f[j] -= s - normal * n;
				t[i] += atI.cross(s);
				t[j] += atJ.cross(-s);
				const double lever = 1 / (1 / ri + 1 / rj), most = law.rollingFriction * lever * normal;
				Vec3& m = moment.emplace(std::make_pair(i, j), Vec3::Zero()).first->second;
				turn(m);
				m += kn / law.stiffnessRatio * lever * lever * dt * (w[j] - w[i] - n * n.dot(w[j] - w[i]));
				if (m.norm() > most) m = m.normalized() * most;
				t[i] += m;
				t[j] -= m;
			}
			const double k = law.modulus * ri, out = std::hypot(x[i][0], x[i][1]);
			f[i][2] += k * std::max(0., ri - x[i][2]) - k * std::max(0., x[i][2] + ri - H);
			if (out + ri > R) {
				f[i] -= k * (out + ri - R) * Vec3(x[i][0], x[i][1], 0) / out;
				side += k * (out + ri - R);
			}
		}
		for (std::size_t i = 0; i < x.size(); ++i) {
			const double mass = law.modulus * base[i];
			// damping by the velocity in the middle of the step
			const auto step = [&](double& velocity, double acceleration) {
				const double power = acceleration * (velocity + 0.5 * dt * acceleration);
				velocity += dt * acceleration * (power == 0 ? 1 : 1 - std::copysign(law.damping, power));
			};
			for (int a = 0; a < 3; ++a) {
				step(v[i][a], f[i][a] / mass);
				step(w[i][a], t[i][a] / (0.4 * mass * base[i] * base[i]));
			}
			x[i] += dt * v[i];
		}
	}
};

/// Two grains in a row between the ends of a tube that they fill: overlaps e12, and e1, e2 with the ends.
GrainAssembly pillar(double overlap, double friction)
{
	const double r = 0.01, h = 4 * r - 3 * overlap;
	return GrainAssembly({Vec3(0, 0, r - overlap), Vec3(0, 0, 3 * r - 2 * overlap)}, {r, r}, 1, 10 * r, h, {E, 2, friction, 0.5});
}

} // namespace

TEST(GrainAssembly, endsFeelTheNormalForce)
{
	// between two grains 2 E r r/(2 r) = E r, with an end E r: three equal springs carry one force
	GrainAssembly g = pillar(1e-5, 0);
	const double force = E * 0.01 * 1e-5;
	g.step(0);
	EXPECT_NEAR(g.axialStress() * M_PI * 0.1 * 0.1 / force, 1, 1e-9);
	EXPECT_EQ(g.radialStress(), 0);
	EXPECT_NEAR(g.meanStress(), g.axialStress() / 3, 1e-12 * g.axialStress());
	EXPECT_EQ(g.contacts(), 1);
	EXPECT_EQ(g.rattlers(), 0);
	EXPECT_LT(g.unbalancedRatio(), 1e-9);
	for (int i = 0; i < 1000; ++i) g.step(0);
	EXPECT_NEAR((g.centres()[1] - g.centres()[0]).norm(), 0.02 - 1e-5, 1e-13);
}

TEST(GrainAssembly, sideFeelsTheNormalForce)
{
	// one grain as wide as the tube and a little more, off the axis: overlap 1e-5 with the side, none elsewhere
	GrainAssembly g({Vec3(0.02 + 1e-5, 0, 0.05)}, {0.01}, 1, 0.03, 0.1, {E, 2, 0, 0.5});
	g.step(0);
	EXPECT_NEAR(g.radialStress() * 2 * M_PI * 0.03 * 0.1 / (E * 0.01 * 1e-5), 1, 1e-9);
	EXPECT_EQ(g.axialStress(), 0);
	EXPECT_LT(g.centres()[0][0], 0.02 + 1e-5);
	EXPECT_NEAR(g.unbalancedRatio(), 1, 1e-12);
}

TEST(GrainAssembly, growthRaisesTheStressAsTheSpringsSay)
{
	// sizes grow by s: each of the three overlaps gains (4 r/3) s, stiffness E r (1 + s)
	GrainAssembly g = pillar(1e-5, 0);
	const double s = 1e-4;
	for (int i = 0; i < 10000; ++i) g.step(s / 10000);
	for (int i = 0; i < 2000; ++i) g.step(0);
	const double grown = g.factor() - 1, overlap = 1e-5 + 4 * 0.01 / 3 * grown;
	EXPECT_NEAR(grown, s, 1e-8);
	EXPECT_NEAR(g.axialStress() * M_PI * 0.1 * 0.1 / (E * 0.01 * (1 + grown) * overlap), 1, 1e-9);
}

TEST(GrainAssembly, oneRoughContactHoldsNothing)
{
	// one grain pressed by the end of the tube between three that stand apart on the other end and against the side, which takes their thrust
	const double r = 0.01, gap = 0.021;
	const auto thrust = [&](double friction) {
		const double ring = gap / std::sqrt(3.), above = std::sqrt(4 * r * r - ring * ring);
		std::vector<Vec3> x;
		for (int i = 0; i < 3; ++i) x.emplace_back(ring * std::cos(2 * M_PI * i / 3), ring * std::sin(2 * M_PI * i / 3), r);
		x.emplace_back(0, 0, r + above);
		GrainAssembly g(x, std::vector<double>(4, r), 1, ring + r, 2 * r + above - 1e-5, {E, 2, friction, 0.5});
		for (int i = 0; i < 4000; ++i) g.step(0);
		EXPECT_LT(g.unbalancedRatio(), 1e-6);
		EXPECT_EQ(g.contacts(), 3);
		return g.radialStress() * (ring + r) * 2 * (2 * r + above) / (g.axialStress() * 2 * (ring + r) * (ring + r));
	};
	// without friction: side over end force of the three, from the slope of the contacts
	const double ring = gap / std::sqrt(3.), smooth = ring / std::sqrt(4 * r * r - ring * ring);
	EXPECT_NEAR(2 * thrust(0) / smooth, 1, 2e-3); // ends: both of them count
	// a lower grain has one rough contact only, whose torque nothing balances: it rolls until the shear force is gone
	EXPECT_NEAR(thrust(0.5), thrust(0), 1e-6);
}

TEST(GrainAssembly, slidingContactsCarryNoMoreThanFriction)
{
	// two grains between the ends, askew: smooth ends let them roll, so what slides is their contact, until it is allowed to hold
	const double r = 0.01, e = 1e-5;
	GrainAssembly g({Vec3(0, 0, r - e), Vec3(1e-3, 0, 3 * r - 2 * e - 2.6e-5)}, {r, r}, 1, 10 * r, 4 * r - 3 * e, {E, 2, 1e-3, 0});
	int slid = 0;
	for (int i = 0; i < 60; ++i) {
		g.step(0);
		slid += g.sliding();
	}
	EXPECT_GT(slid, 10);
	g.setFriction(1e3, 0);
	g.step(0);
	EXPECT_EQ(g.sliding(), 0);
}

TEST(GrainAssembly, equalsTheSlowReference)
{
	StressedPackingSpec c = spec(0.45);
	SpherePackingSpec loose = c.packing;
	loose.radii.resize(60);
	loose.porosity = 0.5;
	loose.even = 0; // grains nearly touch: there are contacts from the start, and not yet the chaos of a long run
	const SpherePacking p = packSpheres(loose);
	std::vector<Vec3> without;
	for (const double rolling : {0., 0.3}) {
		c.law.rollingFriction = rolling;
		GrainAssembly fast(p.centres, p.radii, 1, R, H, c.law);
		Reference slow(p, c.law);
		for (int i = 0; i < 600; ++i) {
			fast.step(2e-5);
			slow.step(2e-5);
			if (i == 400) {
				fast.setFriction(0.05, 0.1 * rolling);
				slow.law.friction = 0.05;
				slow.law.rollingFriction = 0.1 * rolling;
			}
			if (i % 100 != 99) continue;
			ASSERT_LT(support::relativeDifference(fast.centres(), slow.x), 1e-9) << i;
		}
		EXPECT_GT(fast.sliding(), 10);
		EXPECT_GT(fast.contacts() - fast.sliding(), 10);
		EXPECT_NEAR(slow.side / (2 * M_PI * R * H) / fast.radialStress(), 1, 1e-6);
		if (rolling == 0)
			without = slow.x;
		else
			EXPECT_GT(support::relativeDifference(without, slow.x), 1e-6) << "rolling resistance has not acted";
	}
}

TEST(GrainAssembly, forcesAmongGrainsAddUpToNothing)
{
	// grains thrown together, no wall near: their common centre of mass stays
	Random random(9);
	std::vector<Vec3> x;
	std::vector<double> r;
	for (int i = 0; i < 60; ++i) {
		x.emplace_back(random.uniform(-0.02, 0.02), random.uniform(-0.02, 0.02), 0.5 + random.uniform(-0.02, 0.02));
		r.push_back(random.uniform(0.004, 0.006));
	}
	// no damping: the local one is no pair force
	GrainAssembly g(x, r, 1, 1, 1, {E, 3, 0.4, 0});
	const auto centre = [&] {
		Vec3 sum = Vec3::Zero();
		double mass = 0;
		for (int i = 0; i < 60; ++i) {
			sum += r[i] * g.centres()[i];
			mass += r[i];
		}
		return Vec3(sum / mass);
	};
	const Vec3 before = centre();
	for (int i = 0; i < 4; ++i) g.step(0);
	EXPECT_GT(g.contacts(), 30);
	EXPECT_LT((centre() - before).norm(), 1e-13);
}

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
