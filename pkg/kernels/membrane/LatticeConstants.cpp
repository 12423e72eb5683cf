// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/membrane/LatticeConstants.hpp"

#include "kernels/base/Check.hpp"
#include "SharedValues.hpp"

#include <algorithm>
#include <cmath>

namespace hexmembrane {

namespace {

void check(const BondStiffness& b)
{
	requirePositive("normal", b.normal, "N/m");
	requireNonNegative("shear", b.shear, "N/m");
}

} // namespace

SheetConstants sheetFromBonds(const BondStiffness& b)
{
	check(b);
	const double sum = 3 * b.normal + b.shear;
	return {2 * std::sqrt(3.) * b.normal * (b.normal + b.shear) / sum, (b.normal - b.shear) / sum};
}

BondStiffness bondsFromSheet(const SheetConstants& s)
{
	requirePositive("stretch", s.stretch, "N/m");
	requireFinite("poisson", s.poisson, "1");
	// a third in binary is a rounding away from 1/3: ks = 0 must be reachable
	const double third = 1. / 3, eps = 1e-12;
	if (!shared::lattice_poisson.holds(s.poisson))
		reject("poisson", s.poisson, "a hexagonal lattice of springs reaches 0 to 1/3 only (rubber's 0.5 cannot be had)",
		       "1/3 for central springs (ks = 0), which is nearest to rubber");
	const double kn = s.stretch / (std::sqrt(3.) * (1 - s.poisson));
	const double ks = kn * (1 - 3 * s.poisson) / (1 + s.poisson);
	return {kn, s.poisson > third - eps ? 0. : ks};
}

double criticalStepOfBonds(const BondStiffness& b, double mass)
{
	check(b);
	requirePositive("mass", mass, "kg");
	return 2 * std::sqrt(mass / std::max(6 * b.normal + 2 * b.shear, 30 * b.shear));
}

} // namespace hexmembrane
