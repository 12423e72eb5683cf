// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "Support.hpp"
#include "kernels/membrane/PressureForce.hpp"
#include "kernels/membrane/TubePressure.hpp"

#include <omp.h>

using namespace hexmembrane;

namespace {

constexpr double pressure = 1e5;

PaddedRings field(const HexLattice& tube) { return support::rowsOf(tube, tube.positions); }

/// Largest difference on the loaded rings from the kernel for any mesh, over the largest force.
double difference(const HexLattice& tube, int first, int last, double offset, double* areaError = nullptr)
{
	TubePressure rows(tube, first, last, offset);
	rows.compute(pressure, field(tube));
	PressureForce mesh(TriangleMesh(tube.particles(), tube.triangles), offset);
	std::vector<Vec3> expected;
	mesh.compute(pressure, tube.positions, expected);
	std::vector<double> areas;
	mesh.vertexAreas(areas);
	double worst = 0, size = 0, area = 0;
	for (int k = first; k <= last; ++k)
		for (int i = 0; i < tube.perRing; ++i) {
			const int v = tube.at(k, i);
			worst = std::max(worst, (rows.force.get(k, i) - expected[v]).norm());
			size = std::max(size, expected[v].norm());
			area += areas[v];
		}
	if (areaError) *areaError = std::abs(rows.area() / area - 1);
	return worst / size;
}

} // namespace

TEST(TubePressure, equalsTheKernelForAnyMesh)
{
	for (unsigned seed = 1; seed < 4; ++seed)
		for (const double offset : {0., 0.002}) {
			HexLattice tube = support::smallTube();
			support::shake(tube.positions, 8e-4, seed);
			double areaError;
			EXPECT_LT(difference(tube, 0, tube.rings - 1, offset, &areaError), 1e-13);
			EXPECT_LT(areaError, 1e-13);
			EXPECT_LT(difference(tube, 3, tube.rings - 4, offset, &areaError), 1e-13);
			EXPECT_LT(areaError, 1e-13);
			EXPECT_LT(difference(tube, 2, 2, offset), 1e-13);
		}
}

TEST(TubePressure, sameBitsForAnyNumberOfThreads)
{
	HexLattice tube = support::smallTube();
	support::shake(tube.positions, 8e-4, 1);
	TubePressure one(tube, 1, tube.rings - 2, 0.001), three = one;
	const int before = omp_get_max_threads();
	omp_set_num_threads(1);
	one.compute(pressure, field(tube));
	omp_set_num_threads(3);
	three.compute(pressure, field(tube));
	omp_set_num_threads(before);
	for (int k = 1; k < tube.rings - 1; ++k)
		for (int i = 0; i < tube.perRing; ++i) ASSERT_EQ(one.force.get(k, i), three.force.get(k, i));
}

TEST(TubePressure, refusesRingsThatAreNotThere)
{
	const HexLattice tube = support::smallTube();
	EXPECT_THROW(TubePressure(tube, -1, 2, 0), std::invalid_argument);
	EXPECT_THROW(TubePressure(tube, 3, 2, 0), std::invalid_argument);
	EXPECT_THROW(TubePressure(tube, 0, tube.rings, 0), std::invalid_argument);
	EXPECT_THROW(TubePressure(tube, 0, 1, -1e-3), std::invalid_argument);
}
