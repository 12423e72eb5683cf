// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "Support.hpp"
#include "kernels/base/Random.hpp"
#include "kernels/packing/GrainAssembly.hpp"
#include "kernels/packing/SpherePacking.hpp"

#include <map>

#include <omp.h>

using namespace hexmembrane;

namespace {

constexpr double E = 1e7, R = 0.02, H = 0.04;

/// The oracle of GrainAssembly: grains that grow in a cylinder that stays, every pair in every step, shear springs in a map.
struct Reference {
	Reference(const SpherePacking& start, const GrainLaw& theLaw) : x(start.centres), base(start.radii), law(theLaw), v(x.size(), Vec3::Zero()), w(v) {}

	std::vector<Vec3> x;
	std::vector<double> base;
	GrainLaw law;
	double size = 1, side = 0;
	int touching = 0, sliding = 0;
	std::vector<Vec3> v, w;
	std::map<std::pair<std::size_t, std::size_t>, Vec3> shear, moment, normals;

	void step(double growth)
	{
		constexpr double dt = GrainAssembly::timeStep;
		size *= 1 + growth;
		// what contacts hold grows with them, stress as it is
		for (auto& [pair, load] : shear) load *= std::pow(1 + growth, 2);
		for (auto& [pair, load] : moment) load *= std::pow(1 + growth, 3);
		side = 0;
		touching = sliding = 0;
		std::vector<Vec3> f(x.size(), Vec3::Zero()), t = f;
		for (std::size_t i = 0; i < x.size(); ++i) {
			const double ri = base[i] * size;
			for (std::size_t j = i + 1; j < x.size(); ++j) {
				const double rj = base[j] * size, dist = (x[j] - x[i]).norm(), least = std::min(ri, rj),
				             kn = M_PI * law.modulus * least * least / (ri + rj);
				if (dist >= ri + rj) {
					shear.erase({i, j});
					moment.erase({i, j});
					normals.erase({i, j});
					continue;
				}
				const Vec3 n = (x[j] - x[i]).normalized(), atI = n * 0.5 * (dist + ri - rj), atJ = -n * 0.5 * (dist + rj - ri);
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
				++touching;
				sliding += s.norm() > law.friction * normal;
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
			const double k = M_PI * law.modulus * ri, out = std::hypot(x[i][0], x[i][1]);
			f[i][2] += k * std::max(0., ri - x[i][2]) - k * std::max(0., x[i][2] + ri - H);
			if (out + ri > R) {
				f[i] -= k * (out + ri - R) * Vec3(x[i][0], x[i][1], 0) / out;
				side += k * (out + ri - R);
			}
		}
		for (std::size_t i = 0; i < x.size(); ++i) {
			const double r = base[i] * size, mass = 0.5 * M_PI * law.modulus * r;
			// damping by the velocity in the middle of the step
			const auto step = [&](double& velocity, double acceleration) {
				const double power = acceleration * (velocity + 0.5 * dt * acceleration);
				velocity += dt * acceleration * (power == 0 ? 1 : 1 - std::copysign(law.damping, power));
			};
			for (int a = 0; a < 3; ++a) {
				step(v[i][a], f[i][a] / mass);
				step(w[i][a], t[i][a] / (0.4 * mass * r * r));
			}
			x[i] += dt * v[i];
		}
	}
};

/// Two grains in a row between the ends of a tube that they fill: half of the overlap with each end, which are twice as stiff.
GrainAssembly pillar(double overlap, double friction)
{
	const double r = 0.01, h = 4 * r - 2 * overlap;
	return GrainAssembly({Vec3(0, 0, r - 0.5 * overlap), Vec3(0, 0, 3 * r - 1.5 * overlap)}, {r, r}, 1, 10 * r, h, {E, 2, friction, 0.5});
}

} // namespace

TEST(GrainAssembly, endsFeelTheNormalForce)
{
	// between two grains pi E r/2, with an end pi E r: three springs carry one force
	GrainAssembly g = pillar(1e-5, 0);
	const double force = 0.5 * M_PI * E * 0.01 * 1e-5;
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
	EXPECT_NEAR(g.radialStress() * 2 * M_PI * 0.03 * 0.1 / (M_PI * E * 0.01 * 1e-5), 1, 1e-9);
	EXPECT_EQ(g.axialStress(), 0);
	EXPECT_LT(g.centres()[0][0], 0.02 + 1e-5);
	EXPECT_NEAR(g.unbalancedRatio(), 1, 1e-12);
}

TEST(GrainAssembly, growthRaisesTheStressAsTheSpringsSay)
{
	// sizes grow by s: the overlap of the grains gains 2 r s, half of what both grow; stiffness pi E r (1 + s)/2
	GrainAssembly g = pillar(1e-5, 0);
	const double s = 1e-4;
	for (int i = 0; i < 10000; ++i) g.step(s / 10000);
	for (int i = 0; i < 2000; ++i) g.step(0);
	const double grown = g.factor() - 1, overlap = 1e-5 + 2 * 0.01 * grown;
	EXPECT_NEAR(grown, s, 1e-8);
	EXPECT_NEAR(g.axialStress() * M_PI * 0.1 * 0.1 / (0.5 * M_PI * E * 0.01 * (1 + grown) * overlap), 1, 1e-9);
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

TEST(GrainAssembly, equalsTheSlowReference)
{
	Random random(3);
	SpherePackingSpec loose{R, H, {}, 0.5, 1};
	for (int i = 0; i < 60; ++i) loose.radii.push_back(1e-3 * (1 + 0.8 * random.uniform()));
	loose.even = 0; // grains nearly touch: there are contacts from the start, and not yet the chaos of a long run
	const SpherePacking p = packSpheres(loose);
	std::vector<Vec3> without;
	for (const double rolling : {0., 0.3}) {
		const GrainLaw law{E, 3, 0.4, 0.5, rolling};
		GrainAssembly fast(p.centres, p.radii, 1, R, H, law);
		Reference slow(p, law);
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
		EXPECT_GT(slow.sliding, 10);
		EXPECT_GT(slow.touching - slow.sliding, 10);
		EXPECT_EQ(fast.contacts(), slow.touching);
		EXPECT_NEAR(slow.side / (2 * M_PI * R * H) / fast.radialStress(), 1, 1e-6);
		if (rolling == 0)
			without = slow.x;
		else
			EXPECT_GT(support::relativeDifference(without, slow.x), 1e-6) << "rolling resistance has not acted";
	}
}

TEST(GrainAssembly, threadsTakeThePartsOfOneResult)
{
	// more grains than one thread takes; they overlap a little and slide
	Random random(5);
	SpherePackingSpec loose{0.05, 0.1, {}, 0.42, 1};
	for (int i = 0; i < 2500; ++i) loose.radii.push_back(1e-3 * (1 + 0.8 * random.uniform()));
	const SpherePacking start = packSpheres(loose);
	std::vector<std::vector<Vec3>> found;
	const int before = omp_get_max_threads();
	for (const int threads : {1, 2, 3, 4}) {
		omp_set_num_threads(threads);
		GrainAssembly g(start.centres, start.radii, 1, 0.05, 0.1, {E, 2, 0.4, 0.5});
		for (int i = 0; i < 40; ++i) g.step(1e-4);
		EXPECT_GT(g.contacts(), 2500);
		found.push_back(g.centres());
	}
	omp_set_num_threads(before);
	for (const auto& centres : found)
		for (std::size_t i = 0; i < centres.size(); ++i) ASSERT_EQ((centres[i] - found[0][i]).norm(), 0) << i;
}

TEST(GrainAssembly, forcesAmongGrainsAddUpToNothing)
{
	// grains pressed together, no wall near: their common centre of mass stays
	Random random(9);
	std::vector<Vec3> x;
	std::vector<double> r;
	for (int i = 0; i < 60; ++i) {
		const Vec3 jitter(random.uniform(-2e-4, 2e-4), random.uniform(-2e-4, 2e-4), random.uniform(-2e-4, 2e-4));
		x.push_back(Vec3(0.011 * (i % 4), 0.011 * (i / 4 % 4), 0.5 + 0.011 * (i / 16)) + jitter);
		r.push_back(random.uniform(0.0055, 0.0057));
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
