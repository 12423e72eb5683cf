// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "Support.hpp"
#include "kernels/membrane/LatticeConstants.hpp"

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

} // namespace

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
}
