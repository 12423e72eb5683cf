// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "Support.hpp"
#include "kernels/base/Random.hpp"
#include "kernels/measure/SphereRegions.hpp"

using namespace hexmembrane;

namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

Vec3 any(Random& random, double size) { return size * Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)); }

/// Equal spheres of diameter 1 on a lattice: `cell` has the edges of a rectangular cell, `sites` the centres in it in parts of the edges.
struct Lattice {
	Vec3 cell;
	std::vector<Vec3> sites;

	/// All with centres within `reach` of the origin in each direction.
	std::vector<MeasuredGrain> grains(double reach) const
	{
		std::vector<MeasuredGrain> all;
		std::array<int, 3> n;
		for (int a = 0; a < 3; ++a) n[a] = int(std::ceil(reach / cell[a])) + 1;
		for (int i = -n[0]; i <= n[0]; ++i)
			for (int j = -n[1]; j <= n[1]; ++j)
				for (int k = -n[2]; k <= n[2]; ++k)
					for (const Vec3& site : sites) {
						const Vec3 x = (Vec3(i, j, k) + site).cwiseProduct(cell);
						if (x.cwiseAbs().maxCoeff() <= reach) all.push_back({x, 0.5, Vec3::Zero()});
					}
		return all;
	}
	double porosity() const { return 1 - double(sites.size()) * M_PI / 6 / cell.prod(); }

	/// Places that fill the cell evenly, in each projection too: multiples of powers of 1/g, g^4 = g + 1.
	std::vector<Vec3> places(int count) const
	{
		std::vector<Vec3> all;
		for (int i = 1; i <= count; ++i) {
			Vec3 part;
			for (int a = 0; a < 3; ++a) part[a] = std::fmod(i * std::pow(1.2207440846057596, -(a + 1)), 1);
			all.push_back(part.cwiseProduct(cell));
		}
		return all;
	}
};

const Lattice cubic{{1, 1, 1}, {{0, 0, 0}}};
const Lattice faceCentred{Vec3::Constant(std::sqrt(2)), {{0, 0, 0}, {0.5, 0.5, 0}, {0.5, 0, 0.5}, {0, 0.5, 0.5}}};
const Lattice hexagonal{{1, std::sqrt(3), std::sqrt(8. / 3)}, {{0, 0, 0}, {0.5, 0.5, 0}, {0, 1. / 3, 0.5}, {0.5, 5. / 6, 0.5}}};

/// Contacts of all grains nearer than touching by a rounding, with the force `stress` times the normal.
std::vector<MeasuredContact> contactsOf(const std::vector<MeasuredGrain>& grains, const Mat3& stress = Mat3::Identity())
{
	std::vector<MeasuredContact> all;
	for (int i = 0; i < int(grains.size()); ++i)
		for (int j = i + 1; j < int(grains.size()); ++j) {
			const Vec3 a = grains[i].centre, b = grains[j].centre;
			const double apart = (b - a).norm();
			if (apart > (grains[i].radius + grains[j].radius) * (1 + 1e-9)) continue;
			const Vec3 normal = (b - a) / apart, force = stress * normal;
			all.push_back({i, j, a, b, a + (b - a) * 0.5, force, force.dot(normal), 0.5});
		}
	return all;
}

double mean(const std::vector<double>& values)
{
	double sum = 0;
	for (const double v : values) sum += v;
	return sum / double(values.size());
}

Mat3 mean(const std::vector<Mat3>& values)
{
	Mat3 sum = Mat3::Zero();
	for (const Mat3& v : values) sum += v;
	return sum / double(values.size());
}

/// Grains of many sizes anywhere in a box of edge 2, overlapping or not.
std::vector<MeasuredGrain> cloud(Random& random, int count, double smallest, double largest)
{
	std::vector<MeasuredGrain> all;
	for (int i = 0; i < count; ++i) all.push_back({any(random, 1), random.uniform(smallest, largest), any(random, 1)});
	return all;
}

} // namespace

TEST(SphereRegions, lensIsThatOfCaps)
{
	// two equal caps of height h: 2 pi h^2 (3 r - h)/3
	const double r = 0.7, h = 0.2;
	EXPECT_NEAR(lensVolume(r, r, 2 * (r - h)), 2 * M_PI * h * h * (3 * r - h) / 3, 1e-15);
	EXPECT_EQ(lensVolume(1, 0.5, 1.5), 0);
	EXPECT_DOUBLE_EQ(lensVolume(0.5, 1, 0.2), M_PI / 6);
	EXPECT_NEAR(lensVolume(1, 0.5, 0.5 + 1e-12), M_PI / 6, 1e-11) << "no jump where the small ball begins to look out";
	EXPECT_NEAR(lensVolume(1, 1, 1e-9), 4 * M_PI / 3, 1e-8);
}

// the mean over all places is the lattice's porosity: each point of it is as often inside as any other
TEST(SphereRegions, latticesHaveTheirPorosityAndCoordination)
{
	struct Case {
		const Lattice& lattice;
		double porosity, coordination;
	};
	for (const auto& [lattice, porosity, coordination] : {Case{cubic, 0.4764, 6}, Case{faceCentred, 0.2595, 12}, Case{hexagonal, 0.2595, 12}}) {
		EXPECT_NEAR(lattice.porosity(), porosity, 5e-5);
		const auto grains = lattice.grains(6);
		const SphereRegions regions(grains, contactsOf(grains));
		const auto places = lattice.places(300);
		const auto found = regions.measure(places, std::vector<double>(places.size(), 2.5));
		EXPECT_NEAR(mean(found.porosity), lattice.porosity(), 3e-5);
		for (const double z : found.coordination) EXPECT_EQ(z, coordination);
	}
}

TEST(SphereRegions, porosityIsThatOfAFineRaster)
{
	Random random(3);
	const auto grains = cloud(random, 60, 0.05, 0.4);
	const SphereRegions regions(grains, {});
	const std::vector<Vec3> centres{{0.1, -0.2, 0.3}, {0.9, 0.9, -0.9}, {0, 0, 0}, {-0.5, 0.2, 0.1}};
	const std::vector<double> radii{0.5, 0.3, 1.5, 0.05};
	const auto found = regions.measure(centres, radii, {0, 0.3, 0.6, 0.9});
	// without overlaps taken away: volumes of grains, one by one
	const int n = 100;
	for (int k = 0; k < 4; ++k) {
		double inside = 0, covered = 0;
		std::vector<double> sizes(3, 0);
		for (int a = 0; a < n * n * n; ++a) {
			const Vec3 x = radii[k] * (2. / n * (Vec3(a % n, a / n % n, a / n / n) + Vec3::Constant(0.5)) - Vec3::Ones());
			if (x.norm() >= radii[k]) continue;
			++inside;
			for (const auto& g : grains)
				if ((g.centre - centres[k] - x).norm() < g.radius) {
					++covered;
					++sizes[int(2 * g.radius / 0.3)];
				}
		}
		EXPECT_NEAR(found.porosity[k], 1 - covered / inside, 2e-4 * (1 + covered / inside)) << k;
		const double volume = 4. / 3 * M_PI * std::pow(radii[k], 3);
		for (int b = 0; b < 3; ++b) EXPECT_NEAR(found.sizes[3 * k + b] / volume, sizes[b] / inside, 4e-4) << k << " " << b;
	}
}

// what three grains share is taken away once too often: the raster tells how much
TEST(SphereRegions, overlapsAreTakenAwayOnce)
{
	const double u = 0.2; // 20 % of the diameter: three of them share a little
	std::vector<MeasuredGrain> grains;
	for (const Vec3& x : {Vec3(0, 0, 0), Vec3(1 - u, 0, 0), Vec3((1 - u) / 2, (1 - u) * std::sqrt(0.75), 0)}) grains.push_back({x, 0.5, Vec3::Zero()});
	const Vec3 centre(0.4, 0.25, 0);
	const auto porosity = [&](const std::vector<MeasuredGrain>& some) { return SphereRegions(some, contactsOf(some)).measure({centre}, {2}).porosity[0]; };
	const auto raster = [&](const std::vector<MeasuredGrain>& some, bool all) {
		const int n = 200;
		double hit = 0;
		for (int a = 0; a < n * n * n; ++a) {
			const Vec3 x = centre + 1.2 * (2. / n * (Vec3(a % n, a / n % n, a / n / n) + Vec3::Constant(0.5)) - Vec3::Ones());
			unsigned in = 0;
			for (const auto& g : some) in += (g.centre - x).squaredNorm() < g.radius * g.radius;
			hit += all ? in == some.size() : in > 0;
		}
		return hit * std::pow(2.4 / n, 3) / (4. / 3 * M_PI * 8);
	};
	const std::vector<MeasuredGrain> two{grains[0], grains[1]};
	EXPECT_NEAR(porosity(two), 1 - raster(two, false), 1e-5);
	EXPECT_NEAR(porosity(two), 1 - (M_PI / 3 - lensVolume(0.5, 0.5, 1 - u)) / (4. / 3 * M_PI * 8), 1e-14);
	EXPECT_NEAR(porosity(grains) - (1 - raster(grains, false)), raster(grains, true), 1e-5);
}

TEST(SphereRegions, stressOfALatticeIsTheOneThatIsApplied)
{
	Mat3 stress;
	stress << 3, 0.5, -0.2, 0.4, 2, 0.1, -0.3, 0.2, 1;
	const auto grains = cubic.grains(6);
	const SphereRegions regions(grains, contactsOf(grains, stress)); // F = sigma n on a face of area 1
	const auto places = cubic.places(5000);
	const auto found = regions.measure(places, std::vector<double>(places.size(), 3));
	EXPECT_LT((mean(found.stress) - stress).norm(), 1e-4 * stress.norm());
	for (const Mat3& one : found.stress) EXPECT_LT((one - stress).norm(), 0.05 * stress.norm()) << "single places scatter";
	EXPECT_EQ(found.stress[0](0, 1) * stress(1, 1), found.stress[0](1, 1) * stress(0, 1)) << "row: force, column: branch";
}

// a branch that leaves the region counts with the part inside, sampled here point by point
TEST(SphereRegions, branchesCountWithTheirPartInside)
{
	Random random(11);
	const auto grains = cloud(random, 50, 0.1, 0.2);
	std::vector<MeasuredContact> contacts;
	for (int c = 0; c < 300; ++c) {
		const Vec3 start = any(random, 1), end = start + any(random, 0.4);
		contacts.push_back({c % 50, c % 3 ? (c + 1) % 50 : -1, start, end, 0.5 * (start + end), any(random, 2), 1, 0.5});
	}
	const SphereRegions regions(grains, contacts);
	const std::vector<Vec3> centres{{0, 0, 0}, {0.4, 0.1, -0.3}, {0.2, 0.2, 0.2}};
	const std::vector<double> radii{3, 0.5, 0.25};
	const auto found = regions.measure(centres, radii);
	for (int k = 0; k < 3; ++k) {
		Mat3 sum = Mat3::Zero();
		double size = 0;
		for (const auto& c : contacts) {
			int inside = 0;
			const int n = 4000;
			for (int s = 0; s < n; ++s) inside += (c.start + (s + 0.5) / n * (c.end - c.start) - centres[k]).norm() < radii[k];
			sum += double(inside) / n * c.force * (c.end - c.start).transpose();
			size += double(inside) / n * c.force.norm() * (c.end - c.start).norm();
		}
		const double volume = 4. / 3 * M_PI * std::pow(radii[k], 3);
		EXPECT_LT((volume * found.stress[k] - sum).norm(), (k == 0 ? 1e-13 : 1e-3) * size) << k;
	}
}

TEST(SphereRegions, aUniformGradientIsRecovered)
{
	Random random(5);
	Mat3 gradient;
	gradient << 0.3, -2, 1, 0.7, -0.4, 0.2, 1.1, 0, 0.9;
	const Vec3 drift(3, -1, 2);
	auto grains = cloud(random, 400, 0.05, 0.1);
	for (auto& g : grains) g.velocity = drift + gradient * g.centre;
	const auto found = SphereRegions(grains, {}).measure({{0, 0, 0}, {0.3, 0.2, -0.5}, {0.6, 0, 0}}, {2, 0.6, 0.4});
	for (int k = 0; k < 3; ++k) {
		EXPECT_GT(found.grains[k], 4);
		EXPECT_LT((found.velocityGradient[k] - gradient).norm(), 1e-12 * gradient.norm()) << k;
	}
	EXPECT_EQ(found.grains[0], 400);
	Vec3 expected = Vec3::Zero();
	for (const auto& g : grains) expected += g.velocity / 400;
	EXPECT_LT((found.velocity[0] - expected).norm(), 1e-13);
}

TEST(SphereRegions, slidingIsAtTheLimitOfFriction)
{
	const std::vector<MeasuredGrain> grains{{{0, 0, 0}, 0.5, {0, 0, 0}}, {{1, 0, 0}, 0.5, {0, 0, 0}}};
	const auto sliding = [&](double tangential, double normal, double friction, int second = 1) {
		const MeasuredContact held{0, 1, {0, 0, 0}, {1, 0, 0}, {0.5, 0, 0}, {1, 0, 0}, 1, inf};
		const MeasuredContact asked{0, second, {0, 0, 0}, {1, 0, 0}, {0.5, 0, 0}, {normal, tangential, 0}, normal, friction};
		return SphereRegions(grains, {held, asked, held}).measure({{0.5, 0, 0}}, {0.2}).sliding[0];
	};
	EXPECT_DOUBLE_EQ(sliding(0.4, 1, 0.4), 1. / 3);
	EXPECT_DOUBLE_EQ(sliding(0.4 * (1 - 1e-9), 1, 0.4), 1. / 3) << "but for rounding";
	EXPECT_EQ(sliding(0.39, 1, 0.4), 0);
	EXPECT_EQ(sliding(9, 1, inf), 0) << "held by a bond";
	EXPECT_TRUE(std::isnan(sliding(0.1, 1, NAN)));
	EXPECT_EQ(sliding(1, 1, 0.4, -1), 0) << "no grain";
	EXPECT_EQ(sliding(0.4, -1, 0.4), 0) << "in tension";
}

TEST(SphereRegions, nothingInsideIsNoNumber)
{
	const auto grains = cubic.grains(2);
	const SphereRegions regions(grains, contactsOf(grains));
	const auto found = regions.measure({{0.5, 0.5, 0.5}, {0.1, 0.1, 0.1}, {0.5, 0, 0}}, {0.1, 0.05, 1});
	EXPECT_EQ(found.porosity[0], 1);
	EXPECT_NEAR(found.porosity[1], 0, 1e-12) << "inside a grain";
	for (int k = 0; k < 2; ++k) {
		EXPECT_EQ(found.grains[k], 0);
		EXPECT_EQ(found.contacts[k], 0);
		EXPECT_TRUE(std::isnan(found.coordination[k]) && std::isnan(found.sliding[k]) && found.stress[k].hasNaN() && found.velocity[k].hasNaN() &&
		            found.velocityGradient[k].hasNaN());
	}
	EXPECT_EQ(found.grains[2], 2);
	EXPECT_TRUE(found.velocityGradient[2].hasNaN() && found.velocity[2].allFinite()) << "two grains have no gradient";
}

TEST(SphereRegions, membersAreTheGrainsInside)
{
	Random random(9);
	const auto grains = cloud(random, 300, 0.05, 0.1);
	const std::vector<Vec3> centres{{0, 0, 0}, {0.8, -0.7, 0.1}, {0.1, 0.1, 0.1}};
	const std::vector<double> radii{0.7, 0.5, 1e-3};
	const auto found = SphereRegions(grains, {}).members(centres, radii);
	RegionMembers expected{{0}, {}};
	for (int k = 0; k < 3; ++k) {
		for (int i = 0; i < 300; ++i)
			if ((grains[i].centre - centres[k]).norm() < radii[k]) expected.grain.push_back(i);
		expected.start.push_back(int(expected.grain.size()));
	}
	EXPECT_EQ(found.start, expected.start);
	EXPECT_EQ(found.grain, expected.grain);
	EXPECT_GT(found.start[2], 50);
}

TEST(SphereRegions, refusesWhatIsNoRegion)
{
	const SphereRegions regions({{{0, 0, 0}, 0.5, {0, 0, 0}}}, {});
	EXPECT_COMPLAINT(regions.measure({{0, 0, 0}}, {0}), "radii[0] = 0");
	EXPECT_COMPLAINT(regions.measure({{0, 0, 0}}, {NAN}), "radii[0]");
	EXPECT_COMPLAINT(regions.measure({{0, NAN, 0}}, {1}), "centres[0] = nan");
	EXPECT_COMPLAINT(regions.measure({{0, 0, 0}, {2, 0, 0}}, {1, 1}), "centres[1] = (2, 0, 0): the region lies outside the specimen; fix: ");
	EXPECT_COMPLAINT(regions.members({{0, 0, 0}}, {1, 1}), "radii = 2");
	EXPECT_COMPLAINT(regions.measure({{0, 0, 0}}, {1}, {1}), "diameters = 1");
	EXPECT_COMPLAINT(regions.measure({{0, 0, 0}}, {1}, {1, 1}), "diameters[1] = 1");
	EXPECT_COMPLAINT(SphereRegions({}, {}), "grains = 0");
	EXPECT_COMPLAINT(SphereRegions({{{0, 0, 0}, -1, {0, 0, 0}}}, {}), "radii[0] = -1");
	EXPECT_COMPLAINT(SphereRegions({{{0, NAN, 0}, 1, {0, 0, 0}}}, {}), "nan");
}
