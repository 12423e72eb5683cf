// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "Support.hpp"
#include "kernels/base/Check.hpp"
#include "kernels/base/Random.hpp"
#include "kernels/measure/LocalStrain.hpp"
#include "kernels/measure/PowerCells.hpp"
#include "kernels/membrane/SurfaceMeasure.hpp"

#include <numeric>

using namespace hexmembrane;
using namespace hexmembrane::support;

namespace {

constexpr double low = 0, high = 0.03;

/// Grains at random in the tube, none far within another.
std::vector<PowerSite> someGrains(int tries, double smallest, double largest)
{
	Random random(5);
	std::vector<PowerSite> grains;
	for (int k = 0; k < tries; ++k) {
		const double r = random.uniform(smallest, largest);
		const Vec3 x(random.uniform(-0.019, 0.019), random.uniform(-0.019, 0.019), random.uniform(low + r, high - r));
		if (std::hypot(x[0], x[1]) > 0.019 - r) continue;
		const auto touches = [&](const PowerSite& other) { return (other.centre - x).norm() < 0.9 * (r + other.radius); };
		if (std::none_of(grains.begin(), grains.end(), touches)) grains.push_back({x, r});
	}
	return grains;
}

Enclosure tubeRound(const HexLattice& tube, double dent)
{
	Enclosure made{tube.positions, tube.sphereRadius, {}, tube.triangles, low, high};
	shake(made.centres, dent, 3);
	for (const Vec3& c : made.centres) made.inner.push_back(c - tube.sphereRadius * Vec3(c[0], c[1], 0).normalized());
	return made;
}

double enclosed(const Enclosure& e) { return measureTube(e.triangles, e.inner, {e.bottom, e.top})[0].volume; }

double sum(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.); }

Mat3 sum(const std::vector<Mat3>& values)
{
	Mat3 all = Mat3::Zero();
	for (const Mat3& one : values) all += one;
	return all;
}

/// A corner of a polygon on which u is linear.
using Corner = std::pair<Vec3, Vec3>; // place, displacement

/// Sum of u (x) n.
Mat3 overPolygon(const std::vector<Corner>& p)
{
	Mat3 all = Mat3::Zero();
	for (std::size_t k = 1; k + 1 < p.size(); ++k)
		all += (p[0].second + p[k].second + p[k + 1].second) / 3 * 0.5 * (p[k].first - p[0].first).cross(p[k + 1].first - p[0].first).transpose();
	return all;
}

/// The part over a height (sign 1) or below it (sign -1).
std::vector<Corner> clipped(const std::vector<Corner>& p, double height, double sign)
{
	std::vector<Corner> kept;
	for (std::size_t k = 0; k < p.size(); ++k) {
		const Corner &a = p[k], &b = p[(k + 1) % p.size()];
		const double da = sign * (a.first[2] - height), db = sign * (b.first[2] - height), s = da / (da - db);
		if (da >= 0) kept.push_back(a);
		if ((da > 0 && db < 0) || (da < 0 && db > 0)) kept.push_back({a.first + s * (b.first - a.first), a.second + s * (b.second - a.second)});
	}
	return kept;
}

/// Sum of u (x) n over the tube's part between the faces.
Mat3 overTube(const Enclosure& e, const std::vector<Vec3>& inner)
{
	Mat3 all = Mat3::Zero();
	for (const auto& t : e.triangles) {
		std::vector<Corner> polygon;
		for (int c : t) polygon.push_back({e.inner[c], inner[c]});
		all += overPolygon(clipped(clipped(polygon, e.bottom, 1), e.top, -1));
	}
	return all;
}

/// Sum of u (x) n over a face: the mesh's section right inside it. `side`: -1 the lower face, 1 the upper one.
Mat3 overFace(const PowerCells& cells, const std::vector<Vec3>& u, double height, int side)
{
	Mat3 all = Mat3::Zero();
	const auto& x = cells.corners();
	for (const auto& t : cells.tetrahedra()) {
		std::vector<int> within, beyond;
		for (int c : t.corners) (side * (x[c][2] - height) < 0 ? within : beyond).push_back(c);
		std::vector<Corner> section;
		const auto cross = [&](int a, int b) {
			const double s = (height - x[a][2]) / (x[b][2] - x[a][2]);
			section.push_back({x[a] + s * (x[b] - x[a]), u[a] + s * (u[b] - u[a])});
		};
		if (within.size() == 1)
			for (int b : beyond) cross(within[0], b);
		if (beyond.size() == 1)
			for (int a : within) cross(a, beyond[0]);
		if (within.size() == 2) {
			cross(within[0], beyond[0]);
			cross(within[0], beyond[1]);
			cross(within[1], beyond[1]);
			cross(within[1], beyond[0]);
		}
		if (section.empty()) continue;
		const auto& c = t.corners;
		const double turned = (x[c[1]] - x[c[0]]).dot((x[c[2]] - x[c[0]]).cross(x[c[3]] - x[c[0]])) < 0 ? -1 : 1;
		const Mat3 part = overPolygon(section);
		// the section's sense of rotation is whatever it is
		double up = 0;
		for (std::size_t k = 1; k + 1 < section.size(); ++k)
			up += (section[k].first - section[0].first).cross(section[k + 1].first - section[0].first)[2];
		all += t.times * turned * side * (up < 0 ? -1 : 1) * part;
	}
	return all;
}

} // namespace

TEST(PowerCells, fillWhatTheTubeEncloses)
{
	const auto grains = someGrains(5000, 1.3e-3, 2.5e-3);
	for (double dent : {0., 3e-4, 1.5e-3}) {
		const Enclosure tube = tubeRound(smallTube(), dent);
		const PowerCells cells(grains, tube);
		EXPECT_NEAR(sum(cells.volumes()), enclosed(tube), 1e-12 * enclosed(tube)) << dent;
		// a sheet of touching spheres is in the triangulation as it is; a ruined one is not
		if (dent < 1e-3)
			EXPECT_EQ(cells.filled(), 0);
		else
			EXPECT_GT(cells.filled(), 100);
	}
}

TEST(PowerCells, aPointBelongsToTheGrainOfLeastPower)
{
	const Enclosure tube = tubeRound(smallTube(), 3e-4);
	const auto grains = someGrains(3000, 3e-3, 5e-3);
	const PowerCells cells(grains, tube);
	std::vector<double> expected(grains.size(), 0);
	constexpr double step = 5e-4;
	double inside = 1;
	for (const Vec3& x : tube.inner) inside = std::min(inside, std::hypot(x[0], x[1]));
	const int n = int(inside / step);
	for (int i = -n; i <= n; ++i)
		for (int j = -n; j <= n; ++j)
			for (double z = low + step / 2; z < high; z += step) {
				const Vec3 x(i * step, j * step, z);
				if (std::hypot(x[0], x[1]) > inside) continue;
				const auto power = [&](const PowerSite& g) { return (g.centre - x).squaredNorm() - g.radius * g.radius; };
				const auto nearest = std::min_element(grains.begin(), grains.end(), [&](auto& a, auto& b) { return power(a) < power(b); });
				expected[nearest - grains.begin()] += step * step * step;
			}
	int compared = 0;
	for (std::size_t g = 0; g < grains.size(); ++g) {
		if (std::hypot(grains[g].centre[0], grains[g].centre[1]) > 0.008) continue; // its cell may reach the tube
		EXPECT_NEAR(cells.volumes()[g], expected[g], 0.03 * expected[g]) << g;
		++compared;
	}
	EXPECT_GT(compared, 10);
}

TEST(PowerCells, meanGradientIsThatOfTheBoundary)
{
	const auto grains = someGrains(5000, 1.3e-3, 2.5e-3);
	for (double dent : {3e-4, 1.5e-3}) {
		const Enclosure tube = tubeRound(smallTube(), dent);
		const PowerCells cells(grains, tube);
		const auto u = randomVectors(grains.size(), 1e-4, 8), sheet = randomVectors(tube.inner.size(), 1e-4, 9);
		const double bottom = 2e-5, top = -1e-4;
		std::vector<Vec3> corners = u;
		corners.insert(corners.end(), sheet.begin(), sheet.end());
		for (int grain : cells.feet()) {
			const Vec3& foot = cells.corners()[corners.size()];
			corners.emplace_back(u[grain][0], u[grain][1], foot[2] == low ? bottom : top);
		}
		const Mat3 found = sum(cells.gradients(u, sheet, bottom, top)), tubes = overTube(tube, sheet);
		const Mat3 expected = tubes + overFace(cells, corners, low, -1) + overFace(cells, corners, high, 1);
		EXPECT_LT((found - expected).norm(), 1e-10 * found.norm()) << dent;
		EXPECT_LT((found - tubes).leftCols(2).norm(), 1e-10 * found.norm()) << "the faces have no sideways normal";
	}
}

TEST(PowerCells, anEvenStrainIsFoundInEachCell)
{
	const auto grains = someGrains(5000, 1.3e-3, 2.5e-3);
	const Enclosure tube = tubeRound(smallTube(), 3e-4);
	const PowerCells cells(grains, tube);
	Mat3 a;
	a << 0.01, 0.004, 0, -0.002, 0.02, 0, 0, 0, -0.05; // a foot moves sideways as its grain does
	std::vector<Vec3> x, u, sheet;
	for (const auto& g : grains) x.push_back(g.centre), u.push_back(a * g.centre);
	for (const Vec3& p : tube.inner) sheet.push_back(a * p);
	const auto found = cells.gradients(u, sheet, a(2, 2) * low, a(2, 2) * high);
	const auto left = nonAffine(x, u, cells.starts(), cells.neighbours());
	for (std::size_t g = 0; g < grains.size(); ++g) {
		EXPECT_LT((found[g] / cells.volumes()[g] - a).norm(), 1e-10) << g;
		EXPECT_LT(left[g], 1e-24) << g;
	}
}

TEST(PowerCells, aLatticeWhereAllCellsMeetInPoints)
{
	// equal grains on a cubic lattice: every border of cells passes through corners of tetrahedra
	const Enclosure tube = tubeRound(smallTube(), 0);
	std::vector<PowerSite> grains;
	for (int i = -6; i <= 6; ++i)
		for (int j = -6; j <= 6; ++j)
			for (int k = 0; k < 10; ++k)
				if (std::hypot(i, j) < 5.8) grains.push_back({{i * 0.003, j * 0.003, (k + 0.5) * 0.003}, 0.0015});
	const PowerCells cells(grains, tube);
	EXPECT_NEAR(sum(cells.volumes()), enclosed(tube), 1e-12 * enclosed(tube));
	for (std::size_t g = 0; g < grains.size(); ++g)
		if (std::hypot(grains[g].centre[0], grains[g].centre[1]) < 0.0125) {
			EXPECT_NEAR(cells.volumes()[g], 27e-9, 1e-17) << g;
		}
}

TEST(PowerCells, oneGrainHasItAll)
{
	const Enclosure tube = tubeRound(smallTube(), 0);
	EXPECT_NEAR(PowerCells({{{0, 0, 0.015}, 0.002}}, tube).volumes()[0], enclosed(tube), 1e-12 * enclosed(tube));
}

TEST(PowerCells, aGrainWithoutACellHasNoVolume)
{
	const Enclosure tube = tubeRound(smallTube(), 0);
	EXPECT_EQ(PowerCells({{{0, 0, 0.015}, 0.002}, {{0, 0, 0.016}, 0.007}}, tube).volumes()[0], 0) << "its cell lies below the lower face";
	std::vector<PowerSite> inside{{{0, 0, 0.015}, 0.001}};
	for (double a : {-1, 1})
		for (int axis = 0; axis < 3; ++axis) inside.push_back({Vec3(0, 0, 0.015) + a * 1e-3 * Vec3::Unit(axis), 0.004});
	const PowerCells cells(inside, tube);
	EXPECT_EQ(cells.volumes()[0], 0) << "no cell anywhere";
	EXPECT_NEAR(sum(cells.volumes()), enclosed(tube), 1e-12 * enclosed(tube));
}

TEST(PowerCells, aGrainThatEscapedTakesNothingFromTheSum)
{
	const Enclosure tube = tubeRound(smallTube(), 3e-4);
	auto grains = someGrains(5000, 1.3e-3, 2.5e-3);
	grains.push_back({{0.04, 0, 0.015}, 1e-3});
	const PowerCells cells(grains, tube);
	EXPECT_NEAR(sum(cells.volumes()), enclosed(tube), 1e-12 * enclosed(tube));
	EXPECT_EQ(cells.volumes().back(), 0);
}

TEST(PowerCells, refusesWhatIsNoInput)
{
	Enclosure tube = tubeRound(smallTube(), 0);
	EXPECT_THROW(PowerCells({}, tube), FieldError);
	EXPECT_THROW(PowerCells({{{0, 0, NAN}, 0.002}}, tube), FieldError);
	EXPECT_THROW(PowerCells({{{0, 0, 0.01}, -1}}, tube), FieldError);
	tube.top = 1; // beyond the tube's end
	EXPECT_THROW(PowerCells({{{0, 0, 0.015}, 0.002}}, tube), FieldFailure);
	tube.top = low;
	EXPECT_THROW(PowerCells({{{0, 0, 0.015}, 0.002}}, tube), FieldError);
}

TEST(LocalStrain, invariantsOfATriaxialStrainAndOfARotation)
{
	const auto triaxial = invariantsOf(Vec3(0.01, 0.01, -0.02).asDiagonal());
	EXPECT_NEAR(triaxial.volumetric, 0, 1e-15);
	EXPECT_NEAR(triaxial.deviatoric, 0.02, 1e-15);
	Mat3 turn = Mat3::Zero();
	turn(1, 0) = 1e-3;
	turn(0, 1) = -1e-3;
	EXPECT_LT((invariantsOf(turn).rotation - Vec3(0, 0, 1e-3)).norm(), 1e-18);
	EXPECT_NEAR(invariantsOf(turn).deviatoric, 0, 1e-18);
}

TEST(LocalStrain, whatAnAffineFitLeaves)
{
	// four neighbours on axes and their opposites: the even part of their motion is not affine
	const std::vector<Vec3> x{Vec3::Zero(), Vec3::UnitX(), -Vec3::UnitX(), Vec3::UnitY(), -Vec3::UnitY(), Vec3::UnitZ(), -Vec3::UnitZ()};
	std::vector<Vec3> u(7, Vec3::Zero());
	u[1] = u[2] = Vec3(0, 0.3, 0);
	const auto left = nonAffine(x, u, {0, 6, 6, 6, 6, 6, 6, 6}, {1, 2, 3, 4, 5, 6});
	EXPECT_NEAR(left[0], 2 * 0.09 / 6, 1e-15);
	EXPECT_TRUE(std::isnan(left[1])) << "no neighbours";
}
