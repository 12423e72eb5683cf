// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "Support.hpp"
#include "kernels/membrane/PressureForce.hpp"
#include "kernels/membrane/SurfaceMeasure.hpp"
#include "tests/kernels/oracle/PressureForceReference.hpp"

#include <omp.h>

using namespace hexmembrane;
using support::relativeDifference;

namespace {

constexpr double pressure = 1e5;

/// A closed tube with shaken vertices: a random closed mesh.
HexLattice randomClosedMesh(unsigned seed)
{
	HexLattice tube = support::smallTube();
	support::closeTube(tube);
	support::shake(tube.positions, 8e-4, seed);
	return tube;
}

std::vector<Vec3> forces(const HexLattice& mesh, double offset)
{
	PressureForce kernel(TriangleMesh(static_cast<int>(mesh.positions.size()), mesh.triangles), offset);
	std::vector<Vec3> f;
	kernel.compute(pressure, mesh.positions, f);
	return f;
}

} // namespace

TEST(PressureForce, fastEqualsReference)
{
	for (unsigned seed = 1; seed < 6; ++seed) {
		const auto mesh = randomClosedMesh(seed);
		for (const double offset : {0., 0.002})
			EXPECT_LT(relativeDifference(forces(mesh, offset), reference::pressureForces(mesh.triangles, pressure, mesh.positions, offset)), 1e-12);
	}
}

TEST(PressureForce, isMinusPressureTimesVolumeGradient)
{
	for (unsigned seed = 1; seed < 4; ++seed) {
		auto mesh = randomClosedMesh(seed);
		const auto f = forces(mesh, 0);
		const double h = 1e-5; // the volume is linear in each coordinate: no truncation error, a large step only helps
		double worst = 0, size = 0;
		for (size_t v = 0; v < mesh.positions.size(); v += 7)
			for (int a = 0; a < 3; ++a) {
				const double x = mesh.positions[v][a];
				mesh.positions[v][a] = x + h;
				const double up = closedVolume(mesh.triangles, mesh.positions);
				mesh.positions[v][a] = x - h;
				const double down = closedVolume(mesh.triangles, mesh.positions);
				mesh.positions[v][a] = x;
				worst = std::max(worst, std::abs(f[v][a] + pressure * (up - down) / (2 * h)));
				size = std::max(size, f[v].norm());
			}
		EXPECT_LT(worst, 1e-8 * size) << "rounding of a volume of 1e-5 m3 over a step of 1e-5 m";
	}
}

TEST(PressureForce, closedSurfaceHasNoResultantAndNoMoment)
{
	for (unsigned seed = 1; seed < 6; ++seed)
		for (const double offset : {0., 0.002}) {
			const auto mesh = randomClosedMesh(seed);
			const auto f = forces(mesh, offset);
			Vec3 resultant = Vec3::Zero(), moment = Vec3::Zero();
			double size = 0;
			for (size_t i = 0; i < f.size(); ++i) {
				resultant += f[i];
				moment += mesh.positions[i].cross(f[i]);
				size += f[i].norm();
			}
			EXPECT_LT(resultant.norm(), 1e-12 * size);
			if (offset > 0) continue; // acts at the centres, see the class
			EXPECT_LT(moment.norm(), 1e-12 * size * 0.05);
		}
}

TEST(PressureForce, degenerateTriangleGivesZeroAndNoNan)
{
	// three vertices on a line, and all in one point
	for (const double spread : {1., 0.}) {
		std::vector<Vec3> x = {{0, 0, 0}, {spread, 0, 0}, {2 * spread, 0, 0}}, f;
		for (const double offset : {0., 0.1}) {
			PressureForce kernel(TriangleMesh(3, {{0, 1, 2}}), offset);
			kernel.compute(pressure, x, f);
			for (const auto& v : f) EXPECT_EQ(v.norm(), 0);
		}
	}
}

TEST(PressureForce, innerSurfaceTakesTheBiasAway)
{
	// a long tube: the force a ring transmits over its inner surface; the polygon's own error is (pi/n)^2/6 and common to both
	const HexLattice l = makeHexLattice({0.020, 0.080, 0.001, Placement::outside, 2, 2});
	const int k = l.rings / 2;
	for (const bool inner : {true, false}) {
		const auto f = forces(l, inner ? l.sphereRadius : 0);
		double inward = 0;
		for (int i = 0; i < l.perRing; ++i) {
			const Vec3& x = l.positions[l.at(k, i)];
			inward -= f[l.at(k, i)].dot(Vec3(x[0], x[1], 0).normalized());
		}
		const double onSoil = inward / (2 * M_PI * l.innerRadius * l.ringSpacing);
		const double expected = inner ? 1 : l.centreRadius / l.innerRadius;
		EXPECT_NEAR(onSoil / pressure, expected, 2e-3);
	}
}

TEST(PressureForce, areasOfVerticesAddUpToTheSurface)
{
	auto mesh = randomClosedMesh(2);
	PressureForce kernel(TriangleMesh(static_cast<int>(mesh.positions.size()), mesh.triangles), 0);
	std::vector<Vec3> f;
	kernel.compute(pressure, mesh.positions, f);
	std::vector<double> third;
	kernel.vertexAreas(third);
	double sum = 0, direct = 0;
	for (const double a : third) sum += a;
	for (const auto& t : mesh.triangles)
		direct += 0.5 * (mesh.positions[t[1]] - mesh.positions[t[0]]).cross(mesh.positions[t[2]] - mesh.positions[t[0]]).norm();
	EXPECT_NEAR(sum / direct, 1, 1e-12);
}

TEST(PressureForce, threadsDoNotChangeABit)
{
	const auto mesh = randomClosedMesh(9);
	omp_set_num_threads(1);
	const auto one = forces(mesh, 0.001);
	omp_set_num_threads(3);
	const auto three = forces(mesh, 0.001);
	omp_set_num_threads(1);
	EXPECT_EQ(relativeDifference(three, one), 0);
}

TEST(PressureForce, badMeshIsNamed)
{
	EXPECT_COMPLAINT(TriangleMesh(3, {{0, 1, 3}}), "triangles[0] = 3");
	EXPECT_COMPLAINT(TriangleMesh(3, {{0, 1, 2}, {0, 1, 1}}), "triangles[1]");
	EXPECT_COMPLAINT(PressureForce(TriangleMesh(3, {{0, 1, 2}}), std::nan("")), "offset");
}
