// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "Support.hpp"
#include "kernels/membrane/LatticeConstants.hpp"

#include <Eigen/Eigenvalues>

#include <complex>

using namespace hexmembrane;

namespace {

/// In-plane stiffness of the lattice by summing the springs of one cell under a homogeneous strain: independent of the closed form under test.
/// Energy per area of a strain e: three bonds a particle, cell area 2 sqrt(3) R^2, length 2R.
SheetConstants bySummation(double kn, double ks)
{
	const double R = 0.37, cell = 2 * std::sqrt(3.) * R * R;
	const auto energy = [&](double exx, double eyy, double exy) {
		double sum = 0;
		for (int b = 0; b < 3; ++b) {
			const double c = std::cos(b * M_PI / 3), s = std::sin(b * M_PI / 3), length = 2 * R;
			const double normal = length * (exx * c * c + eyy * s * s + 2 * exy * c * s);
			const double shear = length * ((eyy - exx) * c * s + exy * (c * c - s * s));
			sum += 0.5 * kn * normal * normal + 0.5 * ks * shear * shear;
		}
		return sum / cell;
	};
	// quadratic form: c11 = 2 W(1, 0), c12 from W(1, 1)
	const double c11 = 2 * energy(1, 0, 0), c22 = 2 * energy(0, 1, 0), c12 = energy(1, 1, 0) - 0.5 * c11 - 0.5 * c22;
	EXPECT_NEAR(c11, c22, 1e-12 * c11) << "isotropic";
	EXPECT_NEAR(2 * energy(0, 0, 0.5), (c11 - c12) / 2, 1e-12 * c11) << "isotropic";
	return {c11 - c12 * c12 / c11, c12 / c11};
}

/// A spring of a bond: stiffness times the square of a linear form in displacements and spins of its ends, x1, turn1, x2, turn2.
struct Spring {
	double stiffness;
	Eigen::Matrix<double, 12, 1> form;
};

/// The three springs of a bond along n of a given length. Shear is the relative displacement at mid-bond, both spins at half the length.
std::array<Spring, 3> springsOf(const BondStiffness& bonds, const Vec3& n, double length)
{
	const Vec3 t = n.unitOrthogonal(), s = n.cross(t);
	std::array<Spring, 3> springs;
	const Vec3 directions[3] = {n, t, s};
	for (int d = 0; d < 3; ++d) {
		const Vec3& e = directions[d];
		// e . (x2 - x1 - (turn1 + turn2)/2 x length n) = e . (x2 - x1) - length/2 (n x e) . (turn1 + turn2)
		const Vec3 lever = 0.5 * length * n.cross(e);
		springs[d].stiffness = d == 0 ? bonds.normal : bonds.shear;
		springs[d].form << -e, -lever, e, -lever;
	}
	return springs;
}

/// Largest omega^2 of spheres of mass 1 and radius 1 on an infinite flat lattice, over all wave vectors of a grid that holds the zone's centre and the middles
/// of its edges: Bloch's theorem, six unknowns.
double highestOfFlatLattice(const BondStiffness& bonds, int grid)
{
	const double inertia = 0.4, length = 2;
	double most = 0;
	for (int a = 0; a < grid; ++a)
		for (int b = 0; b < grid; ++b) {
			// phases along two of the three directions; the third is their difference
			const double first = 2 * M_PI * a / grid, second = 2 * M_PI * b / grid;
			Eigen::Matrix<std::complex<double>, 6, 6> matrix = Eigen::Matrix<std::complex<double>, 6, 6>::Zero();
			for (int family = 0; family < 3; ++family) {
				const double angle = family * M_PI / 3, phase = family == 0 ? first : family == 1 ? second : second - first;
				for (const Spring& spring : springsOf(bonds, Vec3(std::cos(angle), std::sin(angle), 0), length)) {
					Eigen::Matrix<std::complex<double>, 6, 1> form = spring.form.head<6>() + std::polar(1., phase) * spring.form.tail<6>();
					form.tail<3>() /= std::sqrt(inertia);
					matrix += spring.stiffness * form.conjugate() * form.transpose();
				}
			}
			const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<std::complex<double>, 6, 6>> solver(matrix, Eigen::EigenvaluesOnly);
			most = std::max(most, solver.eigenvalues()[5]);
		}
	return most;
}

/// The same of a whole tube of spheres of mass 1, assembled; `held` rows at each end do not move.
double highestOfTube(const BondStiffness& bonds, const HexLattice& tube, int held)
{
	const double root = std::sqrt(0.4) * tube.sphereRadius;
	const int n = tube.particles();
	Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(6 * n, 6 * n);
	for (const auto& bond : tube.bonds) {
		const Vec3 branch = tube.positions[bond[1]] - tube.positions[bond[0]];
		for (Spring spring : springsOf(bonds, branch.normalized(), branch.norm())) {
			spring.form.segment<3>(3) /= root;
			spring.form.segment<3>(9) /= root;
			for (int p = 0; p < 2; ++p)
				for (int q = 0; q < 2; ++q)
					matrix.block<6, 6>(6 * bond[p], 6 * bond[q]) +=
					        spring.stiffness * spring.form.segment<6>(6 * p) * spring.form.segment<6>(6 * q).transpose();
		}
	}
	const int free = 6 * tube.perRing * (tube.rings - 2 * held);
	const Eigen::MatrixXd inside = matrix.block(6 * tube.perRing * held, 6 * tube.perRing * held, free, free);
	return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(inside, Eigen::EigenvaluesOnly).eigenvalues()[free - 1];
}

double omegaSquared(const BondStiffness& bonds)
{
	const double step = criticalStepOfBonds(bonds, 1);
	return 4 / (step * step);
}

} // namespace

TEST(LatticeConstants, criticalStepIsThatOfTheFlatLattice)
{
	for (const double nu : {1. / 3, 0.25, 0.2, 0.1, 0.}) {
		const BondStiffness bonds = bondsFromSheet({420, nu});
		EXPECT_NEAR(highestOfFlatLattice(bonds, 60) / omegaSquared(bonds), 1, 1e-12) << "nu " << nu;
	}
	// between the two modes, where both are as fast, and beyond nu = 0
	for (const double ratio : {0.2, 3. / 14, 0.23, 1.5, 20.})
		EXPECT_NEAR(highestOfFlatLattice({1, ratio}, 36) / omegaSquared({1, ratio}), 1, 1e-12) << ratio;
	EXPECT_NEAR(criticalStepOfBonds({1, 0.5}, 9) / criticalStepOfBonds({1, 0.5}, 1), 3, 1e-14);
}

TEST(LatticeConstants, criticalStepBoundsEveryTube)
{
	// six spheres a ring is the most bent one there is
	for (const double radius : {0.0095, 0.006})
		for (const double nu : {1. / 3, 0.25, 0.2, 0.1, 0.}) {
			const HexLattice tube = makeHexLattice({0.010, 0.070, radius, Placement::outside, 1, 0});
			const BondStiffness bonds = bondsFromSheet({420, nu});
			const double free = highestOfTube(bonds, tube, 0), held = highestOfTube(bonds, tube, 1);
			EXPECT_LE(free, omegaSquared(bonds)) << tube.perRing << " spheres a ring, nu " << nu;
			EXPECT_LE(held, free * (1 + 1e-12));
			EXPECT_GT(free, 0.6 * omegaSquared(bonds)) << tube.perRing << " spheres a ring, nu " << nu;
		}
}

TEST(LatticeConstants, closedFormEqualsSummation)
{
	for (const double ratio : {0., 0.1, 1. / 3, 0.77, 1.}) {
		const double kn = 346.4, ks = ratio * kn;
		const auto sum = bySummation(kn, ks), closed = sheetFromBonds({kn, ks});
		EXPECT_NEAR(closed.stretch / sum.stretch, 1, 1e-12);
		EXPECT_NEAR(closed.poisson, sum.poisson, 1e-12);
	}
}

TEST(LatticeConstants, thereAndBack)
{
	for (const double nu : {0., 0.1, 0.25, 0.33}) {
		const auto b = bondsFromSheet({420, nu});
		const auto s = sheetFromBonds(b);
		EXPECT_NEAR(s.stretch / 420, 1, 1e-12);
		EXPECT_NEAR(s.poisson, nu, 1e-12);
	}
}

TEST(LatticeConstants, aThirdMeansCentralSprings)
{
	EXPECT_EQ(bondsFromSheet({420, 1. / 3}).shear, 0);
	EXPECT_NEAR(bondsFromSheet({420, 0}).shear, bondsFromSheet({420, 0}).normal, 1e-12 * 420);
}

TEST(LatticeConstants, badInputIsNamed)
{
	EXPECT_COMPLAINT(bondsFromSheet({420, 0.5}), "rubber");
	EXPECT_COMPLAINT(bondsFromSheet({420, -0.1}), "poisson = -0.1");
	EXPECT_COMPLAINT(bondsFromSheet({-1, 0.3}), "stretch = -1");
	EXPECT_COMPLAINT(sheetFromBonds({std::nan(""), 0}), "normal = nan");
	EXPECT_COMPLAINT(sheetFromBonds({1, -1}), "shear = -1");
	EXPECT_COMPLAINT(criticalStepOfBonds({0, 0}, 1), "normal = 0");
	EXPECT_COMPLAINT(criticalStepOfBonds({1, 0}, 0), "mass = 0");
}
