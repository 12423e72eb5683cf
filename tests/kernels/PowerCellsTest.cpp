// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "Support.hpp"
#include "kernels/base/Random.hpp"
#include "kernels/measure/PowerCells.hpp"
#include "kernels/membrane/SurfaceMeasure.hpp"

#include <chrono>

using namespace hexmembrane;
using namespace hexmembrane::support;

namespace {

constexpr double low = 0, high = 0.03;

/// Grains at random in the tube, none within another.
std::vector<PowerSite> grainsIn(double radius, double from, double to, double smallest, double largest, int tries, unsigned seed)
{
	Random random(seed);
	std::vector<PowerSite> grains;
	for (int k = 0; k < tries; ++k) {
		const double r = random.uniform(smallest, largest);
		const Vec3 x(random.uniform(-radius, radius), random.uniform(-radius, radius), random.uniform(from, to));
		if (std::hypot(x[0], x[1]) > radius - r || x[2] < from + r || x[2] > to - r) continue;
		bool free = true;
		for (const auto& other : grains) free = free && (other.centre - x).norm() > 0.9 * (r + other.radius);
		if (free) grains.push_back({x, r});
	}
	return grains;
}

Enclosure tubeRound(const HexLattice& tube, double dent, unsigned seed)
{
	Enclosure made{tube.positions, tube.sphereRadius, {}, tube.triangles, low, high};
	shake(made.centres, dent, seed);
	for (const Vec3& c : made.centres) made.inner.push_back(c - tube.sphereRadius * Vec3(c[0], c[1], 0).normalized());
	return made;
}

double enclosed(const Enclosure& e) { return measureTube(e.triangles, e.inner, e.bottom, e.top).volume; }

double sum(const std::vector<double>& values)
{
	double all = 0;
	for (double v : values) all += v;
	return all;
}

} // namespace

TEST(PowerCells, fillWhatTheTubeEncloses)
{
	for (double dent : {0., 3e-4, 1.5e-3}) {
		const Enclosure tube = tubeRound(smallTube(), dent, 3);
		const auto grains = grainsIn(0.019, low, high, 1e-3, 2.5e-3, 20000, 5);
		const PowerCells cells(grains, tube);
		const double volume = enclosed(tube);
		EXPECT_NEAR(sum(cells.volumes()), volume, 1e-10 * volume);
		printf("dent %g grains %zu tets %zu filled %d  sum-vol %g\n", dent, grains.size(), cells.tetrahedra().size(), cells.filled(), sum(cells.volumes()) / volume - 1);
	}
}

TEST(PowerCells, aPointBelongsToTheGrainOfLeastPower)
{
	const Enclosure tube = tubeRound(smallTube(), 3e-4, 3);
	const auto grains = grainsIn(0.019, low, high, 2e-3, 4e-3, 20000, 5);
	const PowerCells cells(grains, tube);
	// shares of a fine grid of points in the tube of the plain lattice
	std::vector<double> expected(grains.size(), 0);
	const double step = 2e-4;
	double radius = 1e9;
	for (const Vec3& x : tube.inner) radius = std::min(radius, std::hypot(x[0], x[1]));
	const int n = int(radius / step);
	for (int i = -n; i <= n; ++i)
		for (int j = -n; j <= n; ++j)
			for (double z = low + step / 2; z < high; z += step) {
				const Vec3 x(i * step, j * step, z);
				if (std::hypot(x[0], x[1]) > radius) continue;
				int best = 0;
				double least = 1e9;
				for (std::size_t g = 0; g < grains.size(); ++g) {
					const double power = (grains[g].centre - x).squaredNorm() - grains[g].radius * grains[g].radius;
					if (power < least) {
						least = power;
						best = int(g);
					}
				}
				expected[best] += step * step * step;
			}
	double worst = 0;
	for (std::size_t g = 0; g < grains.size(); ++g) {
		// only grains whose cell ends before the tube
		if (std::hypot(grains[g].centre[0], grains[g].centre[1]) > 0.008) continue;
		worst = std::max(worst, std::abs(cells.volumes()[g] / expected[g] - 1));
		printf("%g %g\n", cells.volumes()[g], expected[g]);
	}
	EXPECT_LT(worst, 0.01);
}

TEST(PowerCells, speed)
{
	const HexLattice lattice = makeHexLattice({0.020, 0.080, 0.00068, Placement::outside, 2, 2});
	Enclosure tube = tubeRound(lattice, 1e-5, 3);
	tube.top = 0.08;
	const auto grains = grainsIn(0.020, 0, 0.08, 0.9e-3, 1.15e-3, 100000, 5);
	const auto t0 = clock();
	const auto time = [&] { return double(clock() - t0) / CLOCKS_PER_SEC; };
	const PowerCells cells(grains, tube);
	const double t1 = time();
	const auto g = cells.gradients(std::vector<Vec3>(grains.size(), Vec3::Zero()), std::vector<Vec3>(tube.inner.size(), Vec3::Zero()), 0, 0);
	printf("grains %zu tube %zu tets %zu filled %d: %g s, gradients %g s; %g\n", grains.size(), tube.inner.size(), cells.tetrahedra().size(), cells.filled(), t1, time() - t1, sum(cells.volumes()) / enclosed(tube) - 1);
}
