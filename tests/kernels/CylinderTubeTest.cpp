// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "Support.hpp"
#include "kernels/base/Check.hpp"
#include "kernels/base/Random.hpp"
#include "kernels/measure/CylinderTube.hpp"
#include "kernels/membrane/SurfaceMeasure.hpp"

#include <numeric>

using namespace hexmembrane;
using namespace hexmembrane::support;

namespace {

constexpr double radius = 0.02, low = 0.001, high = 0.031;
const Vec3 axis(0.003, -0.002, 0.1);

} // namespace

TEST(CylinderTube, enclosesTheCylindersVolume)
{
	for (int around : {6, 7, 30, 90})
		for (int rows : {1, 4, 23}) {
			const Enclosure tube = cylinderTube(axis, radius, low, high, {around, rows});
			const double expected = M_PI * radius * radius * (high - low);
			EXPECT_NEAR(measureTube(tube.triangles, tube.inner, {low, high})[0].volume, expected, 1e-13 * expected) << around << " " << rows;
			const double most = 3 * radius / (around * around);
			for (const auto& t : tube.triangles) {
				Vec3 middle = Vec3::Zero();
				for (int c : t) {
					const double out = std::hypot(tube.inner[c][0] - axis[0], tube.inner[c][1] - axis[1]) - radius;
					EXPECT_TRUE(out > 0 && out < most) << out / radius;
					middle += tube.inner[c] / 3;
				}
				EXPECT_LT(std::abs(std::hypot(middle[0] - axis[0], middle[1] - axis[1]) - radius), most);
			}
			for (std::size_t i = 0; i < tube.inner.size(); ++i) EXPECT_NEAR((tube.centres[i] - tube.inner[i]).norm(), tube.radius, 1e-12 * radius);
		}
}

TEST(CylinderTube, isFilledByPowerCells)
{
	Random random(7);
	std::vector<PowerSite> grains;
	for (int k = 0; k < 4000; ++k) {
		const double r = random.uniform(1.3e-3, 2.5e-3);
		const Vec3 x(random.uniform(-radius, radius), random.uniform(-radius, radius), random.uniform(low + r, high - r));
		if (std::hypot(x[0], x[1]) > radius - 0.99 * r) continue; // some overlap the wall
		const auto touches = [&](const PowerSite& other) { return (other.centre - x).norm() < 0.9 * (r + other.radius); };
		if (std::none_of(grains.begin(), grains.end(), touches)) grains.push_back({x, r});
	}
	const CylinderLattice lattice = cylinderLattice(radius, high - low, 2e-3);
	const Enclosure tube = cylinderTube(Vec3::Zero(), radius, low, high, lattice);
	const PowerCells cells(grains, tube);
	const double volume = std::accumulate(cells.volumes().begin(), cells.volumes().end(), 0.), expected = M_PI * radius * radius * (high - low);
	EXPECT_NEAR(volume, expected, 1e-12 * expected);
	EXPECT_EQ(cells.filled(), 0);
	// a uniform field has the same gradient in every cell
	const double strain = 0.01;
	std::vector<Vec3> u, sheet;
	for (const auto& g : grains) u.push_back(strain * Vec3(g.centre[0], g.centre[1], -g.centre[2]));
	for (const Vec3& x : tube.inner) sheet.push_back(strain * Vec3(x[0], x[1], -x[2]));
	for (const Mat3& g : cells.gradients(u, sheet, -strain * low, -strain * high)) {
		const double size = std::abs(g(2, 2)) / strain;
		EXPECT_NEAR(g(2, 2), -strain * size, 1e-12 * size);
		EXPECT_NEAR(g(0, 0), strain * size, 1e-9 * size);
	}
}

TEST(CylinderTube, latticeAndBadInput)
{
	const CylinderLattice lattice = cylinderLattice(radius, high - low, 1.4e-3);
	EXPECT_EQ(lattice.around, 90);
	EXPECT_EQ(lattice.rows, 25);
	EXPECT_EQ(cylinderLattice(1e-3, 1e-3, 1).around, 6);
	EXPECT_THROW(cylinderLattice(0, 1, 1), FieldError);
	EXPECT_THROW(cylinderTube(axis, radius, low, high, {5, 1}), FieldError);
	EXPECT_THROW(cylinderTube(axis, radius, low, high, {6, 0}), FieldError);
	EXPECT_THROW(cylinderTube(axis, 0, low, high, {6, 1}), FieldError);
}
