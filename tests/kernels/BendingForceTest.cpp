// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "Support.hpp"
#include "kernels/membrane/BendingForce.hpp"
#include "kernels/membrane/BondForce.hpp"
#include "kernels/membrane/LatticeConstants.hpp"
#include "tests/kernels/oracle/BendingForceReference.hpp"

#include <omp.h>

using namespace hexmembrane;
using support::rowsOf;

namespace {

constexpr double spring = 120, D = 5e-5;

BendingForce ofTube(const HexLattice& tube, double kb = spring) { return {tube, kb, BendingForce::restOfTube(tube.perRing, tube.centreRadius)}; }

Vec3 sum(const std::vector<Vec3>& vectors)
{
	Vec3 total = Vec3::Zero();
	for (const Vec3& v : vectors) total += v;
	return total;
}

double largest(const std::vector<Vec3>& vectors)
{
	double most = 0;
	for (const Vec3& v : vectors) most = std::max(most, v.norm());
	return most;
}

/// A sheet whose particles are displaced along x alone. The bending is linear and acts on each coordinate by itself, so this is a flat plate, endless round
/// the ring, whose deflection is x.
struct Plate {
	HexStencil lattice;
	double spacing = 1e-3;
	std::vector<char> free; ///< 1: moves
	BendingForce bending{lattice, bendingSpring(D, spacing), BendingForce::flat(lattice.perRing)};

	Plate(int perRing, int rings) : lattice{perRing, rings}, free(lattice.particles(), 1) {}

	double area() const { return 0.5 * std::sqrt(3.) * spacing * spacing; }

	std::vector<double> stiffnessTimes(const std::vector<double>& w) const
	{
		std::vector<Vec3> u(w.size(), Vec3::Zero());
		for (size_t i = 0; i < w.size(); ++i)
			if (free[i]) u[i][0] = w[i];
		PaddedRings answer(lattice.perRing, lattice.rings);
		bending.addAnswer(rowsOf(lattice, u), answer);
		const std::vector<Vec3> force = answer.vectors();
		std::vector<double> kw(w.size());
		for (size_t i = 0; i < w.size(); ++i) kw[i] = free[i] ? -force[i][0] : 0;
		return kw;
	}

	/// Deflections under loads (N), by conjugate gradients; on one thread, the loops are short.
	std::vector<double> deflections(std::vector<double> load) const
	{
		const int threads = omp_get_max_threads();
		omp_set_num_threads(1);
		const auto dot = [](const std::vector<double>& a, const std::vector<double>& b) {
			double s = 0;
			for (size_t i = 0; i < a.size(); ++i) s += a[i] * b[i];
			return s;
		};
		for (size_t i = 0; i < load.size(); ++i) load[i] *= free[i];
		std::vector<double> w(load.size(), 0.), r = load, p = r;
		const double start = dot(r, r);
		for (double rr = start; rr > 1e-22 * start;) {
			const std::vector<double> kp = stiffnessTimes(p);
			const double step = rr / dot(p, kp);
			for (size_t i = 0; i < w.size(); ++i) {
				w[i] += step * p[i];
				r[i] -= step * kp[i];
			}
			const double next = dot(r, r);
			for (size_t i = 0; i < w.size(); ++i) p[i] = r[i] + next / rr * p[i];
			rr = next;
		}
		omp_set_num_threads(threads);
		return w;
	}
};

} // namespace

TEST(BendingForce, equalsTheOracle)
{
	const HexLattice rest = support::smallTube();
	for (unsigned seed = 1; seed < 4; ++seed) {
		HexLattice tube = rest;
		support::shake(tube.positions, 8e-4, seed);
		BendingForce fast = ofTube(tube);
		fast.compute(rowsOf(tube, tube.positions));
		EXPECT_LT(support::relativeDifference(fast.force.vectors(), reference::bendingForces(tube.bonds, spring, tube.positions, rest.positions)),
		          1e-13);
		EXPECT_NEAR(fast.energy() / reference::bendingEnergy(tube.bonds, spring, tube.positions, rest.positions), 1, 1e-13);
	}
}

TEST(BendingForce, isMinusTheGradientOfItsEnergy)
{
	HexLattice tube = support::smallTube();
	support::shake(tube.positions, 5e-4, 5);
	BendingForce kernel = ofTube(tube);
	kernel.compute(rowsOf(tube, tube.positions));
	const std::vector<Vec3> force = kernel.force.vectors();
	const double step = 1e-5; // the energy is of second order: central differences are exact but for rounding
	for (const int k : {0, 1, 2, tube.rings / 2, tube.rings - 1})
		for (int a = 0; a < 3; ++a) {
			const int v = tube.at(k, 3);
			double energy[2];
			for (int side = 0; side < 2; ++side) {
				std::vector<Vec3> moved = tube.positions;
				moved[v][a] += side ? step : -step;
				kernel.compute(rowsOf(tube, moved));
				energy[side] = kernel.energy();
			}
			EXPECT_NEAR(force[v][a], -(energy[1] - energy[0]) / (2 * step), 1e-8 * largest(force)) << "ring " << k << ", axis " << a;
		}
}

TEST(BendingForce, generatedTubeIsFreeOfMomentsWhereverItStands)
{
	HexLattice tube = support::smallTube();
	BendingForce kernel = ofTube(tube);
	for (Vec3& x : tube.positions) x += Vec3(0.3, -0.2, 0.1);
	kernel.compute(rowsOf(tube, tube.positions));
	EXPECT_LT(largest(kernel.force.vectors()), 1e-13 * spring);
}

TEST(BendingForce, forcesAddUpToNothing)
{
	HexLattice tube = support::smallTube();
	support::shake(tube.positions, 8e-4, 2);
	BendingForce kernel = ofTube(tube);
	kernel.compute(rowsOf(tube, tube.positions));
	const std::vector<Vec3> force = kernel.force.vectors();
	EXPECT_LT(sum(force).norm(), 1e-13 * tube.particles() * largest(force));
}

TEST(BendingForce, answerIsTheChangeOfForces)
{
	HexLattice tube = support::smallTube();
	BendingForce kernel = ofTube(tube);
	const std::vector<Vec3> u = support::randomVectors(tube.positions.size(), 1e-3, 7);
	PaddedRings answer = rowsOf(tube, std::vector<Vec3>(tube.positions.size(), Vec3(1, 2, 3)));
	kernel.addAnswer(rowsOf(tube, u), answer);
	for (size_t i = 0; i < u.size(); ++i) tube.positions[i] += u[i];
	kernel.compute(rowsOf(tube, tube.positions));
	std::vector<Vec3> expected = kernel.force.vectors();
	for (Vec3& f : expected) f += Vec3(1, 2, 3);
	EXPECT_LT(support::relativeDifference(answer.vectors(), expected), 1e-13);
}

TEST(BendingForce, flatSheetRolledIntoATube)
{
	// D kappa^2/2 an area; the lattice's own error is of second order in spacing over radius
	for (const double fine : {1., 0.5}) {
		const HexLattice tube = makeHexLattice({0.020, 0.030, 0.001 * fine, Placement::centred, 1, 1});
		BendingForce kernel(tube, bendingSpring(D, 2 * tube.sphereRadius), BendingForce::flat(tube.perRing));
		kernel.compute(rowsOf(tube, tube.positions));
		const double area = tube.perRing * (tube.rings - 2) * 2 * std::sqrt(3.) * std::pow(tube.sphereRadius, 2);
		EXPECT_NEAR(kernel.energy() / (0.5 * D * area / std::pow(tube.centreRadius, 2)), 1, 2.5e-3 * fine * fine) << "fine " << fine;
	}
}

TEST(BendingForce, cantileverUnderAnEndLoad)
{
	// F L^3/(3 D) a width. Clamped are the rings 0 and 1: the slope vanishes half a ring's distance before ring 1
	for (const int length : {10, 40}) {
		Plate plate(6, length + 2);
		for (int i = 0; i < 2 * 6; ++i) plate.free[i] = 0;
		const double perWidth = 0.01;
		std::vector<double> load(plate.lattice.particles(), 0.);
		for (int i = 0; i < 6; ++i) load[plate.lattice.at(length + 1, i)] = perWidth * plate.spacing;
		const double L = (length + 0.5) * 0.5 * std::sqrt(3.) * plate.spacing;
		const double expected = perWidth * L * L * L / (3 * D);
		EXPECT_NEAR(plate.deflections(load)[plate.lattice.at(length + 1, 2)] / expected, 1, 0.3 / (length * length)) << "length " << length;
	}
}

TEST(BendingForce, clampedDiscUnderPressure)
{
	// p a^4/(64 D) at the centre. What is clamped are the particles beyond a, and the slope vanishes a part of the spacing further out, whatever a is: the
	// fourth root of the sag grows with a as theory says
	const double pressure = 1000;
	double size[2] = {10, 20}, root[2];
	for (int fine = 0; fine < 2; ++fine) {
		Plate plate(int(2 * size[fine]) + 8, 2 * int(size[fine] / 0.866) + 7);
		const double a = size[fine] * plate.spacing;
		const int middle = plate.lattice.rings / 2, half = plate.lattice.perRing / 2;
		for (int k = 0; k < plate.lattice.rings; ++k)
			for (int i = 0; i < plate.lattice.perRing; ++i) {
				const double x = (i - half + 0.5 * (k % 2 - middle % 2)) * plate.spacing,
				             y = (k - middle) * 0.5 * std::sqrt(3.) * plate.spacing;
				plate.free[plate.lattice.at(k, i)] = x * x + y * y < a * a;
			}
		const std::vector<double> w = plate.deflections(std::vector<double>(plate.lattice.particles(), pressure * plate.area()));
		root[fine] = std::pow(w[plate.lattice.at(middle, half)] / (pressure * std::pow(plate.spacing, 4) / (64 * D)), 0.25);
		EXPECT_GT(root[fine], size[fine]);
		EXPECT_LT(root[fine], size[fine] + 1);
	}
	EXPECT_NEAR((root[1] - root[0]) / (size[1] - size[0]), 1, 0.01);
}

TEST(BendingForce, axialLoadAtWhichAWideTubeBuckles)
{
	// the stiffness of one half wave w = cos(q z), q = pi/L, vanishes under the axial compression N = D q^2 + E t/(1 - nu^2)/(R q)^2 when nothing moves
	// axially: Euler's load of a strip, and 8 % of the tube's own
	const HexLattice tube = makeHexLattice({0.2, 0.030, 0.001, Placement::centred, 1, 1});
	const double kn = 200, Et = sheetFromBonds({kn, 0}).stretch, nu = 1. / 3, R = tube.centreRadius;
	const double middle = 0.5 * (tube.rings - 1), q = M_PI / ((tube.rings - 1) * tube.ringSpacing);
	const double stiff = 10 * D;
	BendingForce bending = ofTube(tube, bendingSpring(stiff, 2 * tube.sphereRadius));
	BondLaw law;
	law.kn = kn;
	BondForce bonds(tube, law);
	const std::vector<double> rest(tube.bondCount(), 2 * tube.sphereRadius);
	std::vector<Vec3> shear;
	std::vector<int> broken;
	// force along the wave over its size, of a tube shortened by a strain with its radius held
	const auto stiffness = [&](double strain) {
		double along[2], square = 0;
		const double size = 1e-6;
		for (int side = 0; side < 2; ++side) {
			std::vector<Vec3> x = tube.positions, wave(x.size());
			square = 0;
			for (int k = 0; k < tube.rings; ++k)
				for (int i = 0; i < tube.perRing; ++i) {
					const int v = tube.at(k, i);
					wave[v] = std::cos(q * (k - middle) * tube.ringSpacing) * Vec3(x[v][0] / R, x[v][1] / R, 0);
					x[v][2] *= 1 - strain;
					x[v] += (side ? size : -size) * wave[v];
					square += wave[v].squaredNorm();
				}
			bonds.position = rowsOf(tube, x);
			bonds.compute({rest, shear, broken}, 0);
			bending.compute(bonds.position);
			along[side] = 0;
			for (int k = 0; k < tube.rings; ++k)
				for (int i = 0; i < tube.perRing; ++i)
					along[side] += (bonds.force.get(k, i) + bending.force.get(k, i)).dot(wave[tube.at(k, i)]);
		}
		return -(along[1] - along[0]) / (2 * size * square);
	};
	const double wanted = stiff * q * q + Et / (1 - nu * nu) / (R * R * q * q);
	const double strain = wanted * (1 - nu * nu) / Et;
	const double slope = (stiffness(0) - stiffness(strain)) / wanted, found = stiffness(0) / slope;
	EXPECT_NEAR(found / wanted, 1, 0.03);
	EXPECT_LT(stiffness(1.04 * strain), 0);
	EXPECT_GT(stiffness(0.96 * strain), 0);
}

TEST(BendingForce, criticalStepIsThatOfTheHighestFrequency)
{
	// power iteration on the plate; perRing is divisible by 3, so that the fastest wave fits round the ring
	const Plate plate(12, 60);
	const double kb = bendingSpring(D, plate.spacing), mass = 4e-6;
	std::vector<double> w;
	for (const Vec3& v : support::randomVectors(plate.lattice.particles(), 1, 3)) w.push_back(v[0]);
	double eigenvalue = 0;
	for (int iteration = 0; iteration < 600; ++iteration) {
		double norm = 0;
		for (const double x : w) norm += x * x;
		for (double& x : w) x /= std::sqrt(norm);
		w = plate.stiffnessTimes(w);
		eigenvalue = 0;
		for (const double x : w) eigenvalue += x * x;
		eigenvalue = std::sqrt(eigenvalue);
	}
	const double step = 2 / std::sqrt(eigenvalue / mass);
	EXPECT_GT(step, criticalStepOfBending(kb, mass));
	EXPECT_LT(step, 1.01 * criticalStepOfBending(kb, mass));
	EXPECT_EQ(criticalStepOfBending(0, mass), std::numeric_limits<double>::infinity());
}

TEST(BendingForce, sameBitsForAnyNumberOfThreads)
{
	HexLattice tube = support::smallTube();
	support::shake(tube.positions, 8e-4, 1);
	BendingForce one = ofTube(tube), three = one;
	const int before = omp_get_max_threads();
	omp_set_num_threads(1);
	one.compute(rowsOf(tube, tube.positions));
	omp_set_num_threads(3);
	three.compute(rowsOf(tube, tube.positions));
	omp_set_num_threads(before);
	EXPECT_EQ(one.force.vectors(), three.force.vectors());
}

TEST(BendingForce, refusesWhatItCannotBend)
{
	const PaddedRings flat = BendingForce::flat(6);
	EXPECT_COMPLAINT(BendingForce({6, 2}, 1, flat), "rings = 2");
	EXPECT_COMPLAINT(BendingForce({6, 5}, -1, flat), "spring = -1");
	EXPECT_COMPLAINT(BendingForce({7, 5}, 1, flat), "rest = 2");
	EXPECT_COMPLAINT(bendingSpring(-1, 1), "stiffness = -1");
	EXPECT_COMPLAINT(bendingSpring(1, 0), "spacing = 0");
	EXPECT_COMPLAINT(criticalStepOfBending(1, 0), "mass = 0");
}
