// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "Support.hpp"
#include "kernels/membrane/FacetContact.hpp"
#include "tests/kernels/oracle/FacetContactReference.hpp"

#include <numeric>

#include <omp.h>

using namespace hexmembrane;
using support::rowsOf;

namespace {

constexpr double kn = 2e4;

double offsetOf(const HexLattice& tube) { return 0.25 * tube.sphereRadius; }
double smallestOf(const HexLattice& tube) { return tube.sphereRadius / 1.5; }

/// A tube and the grains in it, numbered from 1000.
struct Filled {
	HexLattice tube;
	std::vector<Place> grains;
	std::vector<int> ids;

	SphereRows rows() const { return {grains.data(), ids.data(), int(grains.size())}; }
	FacetContact kernel() const { return {tube, tube.sphereRadius, offsetOf(tube), kn}; }
	void compute(FacetContact& facets, const Travel& travel = {}) const
	{
		facets.compute(rowsOf(tube, tube.positions), [this] { return rows(); }, travel);
	}
	reference::FacetContacts slow(bool closed) const
	{
		const double limit = FacetContact::actingLength(tube.sphereRadius, offsetOf(tube), smallestOf(tube));
		return reference::facetContacts(tube.triangles, tube.positions, grains, {offsetOf(tube), kn, limit}, closed);
	}
	void put(const Vec3& centre, double radius)
	{
		ids.push_back(1000 + int(grains.size()));
		grains.push_back({centre, radius});
	}
};

/// The grains that touch, each once.
std::vector<int> grainsOf(const FacetContact& facets)
{
	std::vector<int> all;
	for (const auto& contact : facets.touching())
		if (all.empty() || all.back() != contact.grain) all.push_back(contact.grain);
	return all;
}

Vec3 inwardsOf(const HexLattice& tube, const std::array<int, 3>& t)
{
	const Vec3 a = tube.positions[t[0]];
	return -(tube.positions[t[1]] - a).cross(tube.positions[t[2]] - a).normalized();
}

/// A tube stretched by a factor that may change along it, and shaken, with grains near its triangles: within r + h and beyond.
/// \param past way (m) that the nearest stand past the sheet
Filled stretched(double below, double above, unsigned seed, double past = 0)
{
	Filled s{support::smallTube(), {}, {}};
	const double middle = s.tube.positions[s.tube.particles() / 2][2];
	for (Vec3& p : s.tube.positions) p *= p[2] < middle ? below : above;
	support::shake(s.tube.positions, 0.1 * s.tube.sphereRadius, seed);
	std::mt19937_64 random(seed + 100);
	std::uniform_real_distribution<double> u(0, 1);
	for (size_t t = 0; t < s.tube.triangles.size(); ++t) {
		const auto& corner = s.tube.triangles[t];
		if (std::min(corner[0], corner[2]) < 2 * s.tube.perRing || std::max(corner[0], corner[2]) >= s.tube.particles() - 2 * s.tube.perRing) continue;
		const double r = smallestOf(s.tube) * (t == 2 * size_t(s.tube.perRing) * 2 ? 1 : 1 + u(random)), h = offsetOf(s.tube);
		double a = 0.1 + 0.8 * u(random), b = 0.1 + 0.8 * u(random);
		if (a + b > 1) a = 1 - a, b = 1 - b;
		const Vec3 foot = s.tube.positions[corner[0]] + a * (s.tube.positions[corner[1]] - s.tube.positions[corner[0]]) +
		                  b * (s.tube.positions[corner[2]] - s.tube.positions[corner[0]]);
		s.put(foot + (0.3 * h + 1.3 * (r + h) * u(random) - past) * inwardsOf(s.tube, corner), r);
	}
	return s;
}

} // namespace

TEST(FacetContact, equalsTheOracle)
{
	for (unsigned seed = 1; seed < 4; ++seed) {
		const Filled s = stretched(1.6, 1.5, seed, 3e-4);
		FacetContact fast = s.kernel();
		s.compute(fast);
		const auto slow = s.slow(true);
		ASSERT_GT(slow.grains.size(), 100u);
		EXPECT_GT(slow.pushedBack, 3);
		EXPECT_EQ(grainsOf(fast), slow.grains);
		EXPECT_GT(fast.touching().size(), slow.grains.size() + 10); // some reach several triangles
		std::vector<Vec3> onGrain(s.grains.size(), Vec3::Zero());
		for (const auto& contact : fast.touching()) {
			EXPECT_EQ(contact.id, 1000 + contact.grain);
			onGrain[contact.grain] += kn * contact.overlap * contact.normal;
		}
		EXPECT_LT(support::relativeDifference(onGrain, slow.onGrain), 1e-7); // slopes by differences
		EXPECT_LT(support::relativeDifference(fast.force.vectors(), slow.onParticle), 1e-7);
		EXPECT_NEAR(fast.energy() / slow.energy, 1, 1e-9);
	}
}

TEST(FacetContact, equalsTheOracleBesideTrianglesThatDoNotAct)
{
	// half of the tube is as it was made; a grain beside the border touches the last triangle that acts
	Filled s = stretched(1, 1.5, 4);
	FacetContact fast = s.kernel();
	s.compute(fast);
	const auto slow = s.slow(false);
	ASSERT_GT(slow.grains.size(), 30u);
	EXPECT_EQ(grainsOf(fast), slow.grains);
	EXPECT_LT(support::relativeDifference(fast.force.vectors(), slow.onParticle), 1e-7);
}

TEST(FacetContact, addsUpToNothingAndIsMinusTheGradientOfItsEnergy)
{
	Filled s = stretched(1.5, 1.6, 5);
	FacetContact kernel = s.kernel();
	s.compute(kernel);
	const std::vector<Vec3> force = kernel.force.vectors();
	Vec3 total = Vec3::Zero(), moment = Vec3::Zero();
	double size = 0;
	for (size_t i = 0; i < force.size(); ++i) {
		total += force[i];
		moment += s.tube.positions[i].cross(force[i]);
		size += force[i].norm();
	}
	for (const auto& contact : kernel.touching()) {
		const Vec3 f = kn * contact.overlap * contact.normal;
		total += f;
		moment += contact.centre.cross(f);
		EXPECT_NEAR(std::accumulate(contact.shares.begin(), contact.shares.end(), 0.), 1, 1e-12);
		EXPECT_NEAR(((contact.centre - contact.point).cross(contact.normal)).norm(), 0, 1e-12);
	}
	EXPECT_LT(total.norm(), 1e-13 * size);
	EXPECT_LT(moment.norm(), 1e-12 * size * s.tube.centreRadius);

	const auto energyWith = [&](Vec3& moved, int axis, double step) {
		const double before = moved[axis];
		moved[axis] = before + step;
		FacetContact other = s.kernel();
		s.compute(other);
		moved[axis] = before;
		return other.energy();
	};
	const double step = 1e-9;
	for (size_t c = 0; c < kernel.touching().size(); c += 17) {
		const auto& contact = kernel.touching()[c];
		Vec3 onGrain = Vec3::Zero();
		for (const auto& other : kernel.touching())
			if (other.grain == contact.grain) onGrain += kn * other.overlap * other.normal;
		const double f = onGrain.norm();
		for (int a = 0; a < 3; ++a) {
			const auto slope = [&](Vec3& moved) { return -(energyWith(moved, a, step) - energyWith(moved, a, -step)) / (2 * step); };
			EXPECT_NEAR(onGrain[a], slope(s.grains[contact.grain].centre), 1e-4 * f) << "contact " << c;
			EXPECT_NEAR(force[contact.corners[0]][a], slope(s.tube.positions[contact.corners[0]]), 1e-4 * f) << "contact " << c;
		}
	}
}

TEST(FacetContact, energyIsContinuousAlongWaysAcrossEdgesAndThroughTheSheet)
{
	Filled s = stretched(1.5, 1.5, 6);
	const auto& corner = s.tube.triangles[2 * s.tube.perRing * (s.tube.rings / 2)];
	const Vec3 inwards = inwardsOf(s.tube, corner), along = (s.tube.positions[corner[1]] - s.tube.positions[corner[0]]).normalized();
	const Vec3 middle = (s.tube.positions[corner[0]] + s.tube.positions[corner[1]] + s.tube.positions[corner[2]]) / 3;
	const double r = smallestOf(s.tube), h = offsetOf(s.tube), R = s.tube.sphereRadius;
	s.grains.clear();
	s.ids.clear();
	s.put(middle, r);
	FacetContact kernel = s.kernel();
	const int steps = 1000;
	// over triangles and edges, and through the sheet askew; and from far inside to just before the grain counts as outside
	for (const auto& [start, end] : {std::pair<Vec3, Vec3>{middle + 0.8 * r * inwards - 4 * R * along, middle + 0.5 * r * inwards + 4 * R * along},
	                                 std::pair<Vec3, Vec3>{middle + 1.5 * (r + h) * inwards, middle - 0.98 * h * inwards}}) {
		double before = -1, most = 0;
		for (int step = 0; step <= steps; ++step) {
			s.grains[0].centre = start + double(step) / steps * (end - start);
			s.compute(kernel);
			const double energy = kernel.energy();
			if (before >= 0) {
				EXPECT_LT(std::abs(energy - before), 2 * kn * (r + 2 * h) * (end - start).norm() / steps) << "step " << step;
			}
			before = energy;
			most = std::max(most, energy);
		}
		EXPECT_GT(most, 0.5 * kn * 0.04 * r * r);
	}
	// its centre is past the sheet, and it is pushed back
	ASSERT_EQ(kernel.touching().size(), 1u);
	EXPECT_GT(kernel.touching()[0].normal.dot(inwards), 0.99);
	EXPECT_NEAR(kernel.touching()[0].overlap, r + 1.98 * h, 0.05 * h);
	// exactly on the sheet there is a direction too
	s.grains[0].centre = middle;
	s.compute(kernel);
	EXPECT_GT(kernel.touching().at(0).normal.dot(inwards), 0.99);
	// wholly outside, it is kept there
	s.grains[0].centre = middle - 1.1 * h * inwards;
	s.compute(kernel);
	Vec3 push = Vec3::Zero();
	for (const auto& contact : kernel.touching()) push += contact.overlap * contact.normal;
	EXPECT_LT(push.normalized().dot(inwards), -0.99);
}

TEST(FacetContact, aGrainInAHollowComesToRest)
{
	// two triangles at an angle and a grain pressed into the edge between them: with the nearest triangle alone it is thrown to and fro for ever
	Filled s = stretched(1.5, 1.5, 11);
	const size_t t = 2 * size_t(s.tube.perRing) * (s.tube.rings / 2);
	const auto corner = s.tube.triangles[t];
	const Vec3 inwards = inwardsOf(s.tube, corner);
	const double r = smallestOf(s.tube), h = offsetOf(s.tube), push = 0.05 * kn * r, mass = 1e-6, dt = 0.5 * std::sqrt(mass / kn);
	const Vec3 edge = 0.5 * (s.tube.positions[corner[0]] + s.tube.positions[corner[1]]);
	for (const int v : {corner[0], corner[1]}) s.tube.positions[v] -= 0.8 * s.tube.sphereRadius * inwards; // a valley along their bond
	s.grains.clear();
	s.ids.clear();
	s.put(edge + (r + h - 0.7 * s.tube.sphereRadius) * inwards, r);
	FacetContact kernel = s.kernel();
	Vec3 velocity = Vec3::Zero();
	size_t reached = 0;
	for (int step = 0; step < 4000; ++step) {
		s.compute(kernel);
		Vec3 force = -push * inwards;
		for (const auto& contact : kernel.touching()) force += kn * contact.overlap * contact.normal;
		reached = kernel.touching().size();
		for (int a = 0; a < 3; ++a) force[a] *= force[a] * velocity[a] > 0 ? 0.8 : 1.2; // local damping
		velocity += force / mass * dt;
		s.grains[0].centre += velocity * dt;
	}
	EXPECT_GE(reached, 2u);
	EXPECT_LT(mass * velocity.norm() / dt, 1e-3 * push);
}

TEST(FacetContact, isNotReachedAtRest)
{
	// grains of every size down to R/3.7 in the hollows of three particles, pressed in by up to the softness: as near as they come
	for (const double ratio : {0.3, 1., 1.5, 3., 3.7}) {
		Filled s{support::smallTube(), {}, {}};
		const double R = s.tube.sphereRadius, r = R / ratio;
		for (const auto& t : s.tube.triangles) {
			const Vec3 middle = (s.tube.positions[t[0]] + s.tube.positions[t[1]] + s.tube.positions[t[2]]) / 3;
			const double edge = (s.tube.positions[t[1]] - s.tube.positions[t[0]]).norm();
			const double depth = R + r - (ratio < 3 ? 0.1 * R : 0);
			s.put(middle + std::sqrt(depth * depth - edge * edge / 3) * inwardsOf(s.tube, t), r);
		}
		FacetContact kernel = s.kernel();
		s.compute(kernel);
		EXPECT_TRUE(kernel.touching().empty()) << "R/r = " << ratio;
		EXPECT_GT(kernel.firstRing(), kernel.lastRing());
		EXPECT_EQ(kernel.energy(), 0);
		EXPECT_EQ(kernel.largestShare(), 0);
	}
}

TEST(FacetContact, actsFromTheLengthAtWhichASoftContactReachesIt)
{
	// an equilateral triangle at the limit: the smallest grain, driven into its corners by R/10, just touches; no other place of it brings it nearer
	const double R = 0.002, h = R / 4, r = R / 1.5, soft = 0.9 * R + r, limit = FacetContact::actingLength(R, h, r);
	EXPECT_NEAR(std::sqrt(soft * soft - limit * limit / 3), r + h, 1e-12 * R);
	std::mt19937_64 random(3);
	std::uniform_real_distribution<double> u(-1, 1);
	int tried = 0;
	for (int n = 0; n < 400000; ++n) {
		std::array<Vec3, 3> p;
		for (Vec3& corner : p) corner = Vec3(u(random), u(random), 0) * limit;
		const double longest = std::max({(p[1] - p[0]).norm(), (p[2] - p[1]).norm(), (p[0] - p[2]).norm()});
		if (longest == 0) continue;
		for (Vec3& corner : p) corner *= limit / longest;
		const Vec3 c(limit * u(random), limit * u(random), (r + h) * u(random));
		if (std::min({(c - p[0]).norm(), (c - p[1]).norm(), (c - p[2]).norm()}) < soft) continue;
		++tried;
		ASSERT_GE((c - reference::nearestOfTriangle(c, p)).norm(), (r + h) * (1 - 1e-9));
	}
	EXPECT_GT(tried, 1000);
}

TEST(FacetContact, besideABrokenBondNothingIsCarried)
{
	const Filled s = stretched(1.5, 1.5, 7);
	FacetContact kernel = s.kernel();
	s.compute(kernel);
	const auto contact = kernel.touching()[kernel.touching().size() / 2];
	std::vector<int> broken(s.tube.bonds.size(), 0);
	for (size_t b = 0; b < broken.size(); ++b)
		for (int c = 0; c < 3; ++c) {
			const std::array<int, 2> edge{contact.corners[c], contact.corners[(c + 1) % 3]};
			if (c == 0 && std::is_permutation(edge.begin(), edge.end(), s.tube.bonds[b].begin())) broken[b] = 1;
		}
	ASSERT_EQ(std::count(broken.begin(), broken.end(), 1), 1);
	kernel.setBroken(broken);
	s.compute(kernel);
	for (const auto& other : kernel.touching()) EXPECT_NE(other.corners, contact.corners);
	EXPECT_FALSE(kernel.touching().empty());
	kernel.setBroken(std::vector<int>(broken.size(), 0));
	s.compute(kernel);
	FacetContact whole = s.kernel();
	s.compute(whole);
	EXPECT_EQ(kernel.force.vectors(), whole.force.vectors());
	EXPECT_COMPLAINT(kernel.setBroken({1, 0}), "broken = 2");
}

TEST(FacetContact, bitsDependOnThePlacesAlone)
{
	// stretched step by step while the grains move too, and with the grains in another order
	const Filled end = stretched(1.5, 1.6, 8);
	const HexLattice start = support::smallTube();
	Filled s = end;
	FacetContact onTheWay = s.kernel(), told = s.kernel(); // one is told how far things have gone at most
	Travel travel{1, 0};
	const int steps = 200;
	for (int step = 0; step <= steps; ++step) {
		const double share = 0.8 + 0.2 * step / steps;
		const Filled at = s;
		double way = 0;
		for (size_t i = 0; i < s.tube.positions.size(); ++i)
			s.tube.positions[i] = start.positions[i] + share * (end.tube.positions[i] - start.positions[i]);
		for (size_t g = 0; g < s.grains.size(); ++g) s.grains[g].centre = (0.5 + 0.5 * share) * end.grains[g].centre;
		s.compute(onTheWay);
		for (size_t i = 0; i < s.tube.positions.size(); ++i) way = std::max(way, (s.tube.positions[i] - at.tube.positions[i]).norm());
		for (size_t g = 0; g < s.grains.size(); ++g) way = std::max(way, (s.grains[g].centre - at.grains[g].centre).norm());
		travel.way += way;
		s.compute(told, travel);
		EXPECT_EQ(told.force.vectors(), onTheWay.force.vectors()) << "step " << step;
		if (step % 40 != 0) continue;
		Filled turned = s;
		std::reverse(turned.grains.begin(), turned.grains.end());
		std::reverse(turned.ids.begin(), turned.ids.end());
		for (const int threads : {1, 3}) {
			const int before = omp_get_max_threads();
			omp_set_num_threads(threads);
			FacetContact fresh = s.kernel();
			turned.compute(fresh);
			omp_set_num_threads(before);
			EXPECT_EQ(onTheWay.force.vectors(), fresh.force.vectors()) << "step " << step;
			EXPECT_EQ(onTheWay.touching().size(), fresh.touching().size());
		}
		if (step % 80 != 0) continue;
		const std::vector<Vec3> before = onTheWay.force.vectors();
		turned.compute(onTheWay); // the same kernel meets another order
		EXPECT_EQ(onTheWay.force.vectors(), before);
		++travel.order;
		turned.compute(told, travel);
		EXPECT_EQ(told.force.vectors(), before);
		++travel.order;
	}
	EXPECT_FALSE(onTheWay.touching().empty());
	EXPECT_GT(onTheWay.listsMade(), 5);
	EXPECT_LT(onTheWay.listsMade(), steps / 2);
	EXPECT_LT(told.listsMade(), steps / 2);
	s.tube = start;
	s.compute(onTheWay);
	for (const Vec3& f : onTheWay.force.vectors()) EXPECT_EQ(f, Vec3::Zero());
}

TEST(FacetContact, openSheetDoesNotAskForGrains)
{
	Filled s{support::smallTube(), {}, {}};
	s.put(Vec3::Zero(), smallestOf(s.tube));
	FacetContact kernel = s.kernel();
	int asked = 0;
	for (int step = 0; step < 20; ++step) {
		support::shake(s.tube.positions, 1e-6, step);
		kernel.compute(rowsOf(s.tube, s.tube.positions), [&] { return ++asked, s.rows(); });
	}
	EXPECT_EQ(asked, 1);
	EXPECT_EQ(kernel.listsMade(), 1);
}

TEST(FacetContact, largestShareIsOfTheParticleThatBearsMost)
{
	const Filled s = stretched(1.5, 1.6, 9);
	FacetContact kernel = s.kernel();
	s.compute(kernel);
	std::vector<double> shares(s.tube.particles(), 0);
	for (const auto& contact : kernel.touching())
		for (int c = 0; c < 3; ++c) shares[contact.corners[c]] += contact.shares[c] * contact.stiffness;
	EXPECT_EQ(kernel.largestShare(), *std::max_element(shares.begin(), shares.end()));
	EXPECT_GT(kernel.largestShare(), 0.3);
}

TEST(FacetContact, refusesWhatIsNoSheetOrPlace)
{
	Filled s = stretched(1.5, 1.6, 10);
	EXPECT_COMPLAINT(FacetContact(s.tube, 0, 1, kn), "radius = 0");
	EXPECT_COMPLAINT(FacetContact(s.tube, 1, 0, kn), "offset = 0");
	EXPECT_COMPLAINT(FacetContact(s.tube, 1, 0.95, kn), "offset = 0.95: reaches through the particles");
	EXPECT_COMPLAINT(FacetContact(s.tube, 1, 0.2, -1), "kn = -1");
	s.grains[3].centre[1] = std::numeric_limits<double>::quiet_NaN();
	FacetContact kernel = s.kernel();
	EXPECT_COMPLAINT(s.compute(kernel), "nan");
}
