// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

namespace hexmembrane {

/// In-plane constants of a thin isotropic sheet. `stretch` is Young's modulus times thickness, E t (N/m).
struct SheetConstants {
	double stretch; ///< E t (N/m)
	double poisson; ///< nu
};

/// Bond stiffnesses of the hexagonal lattice (N/m).
struct BondStiffness {
	double normal; ///< kn
	double shear;  ///< ks
};

/// E t = 2 sqrt(3) kn (kn + ks)/(3 kn + ks), nu = (kn - ks)/(3 kn + ks). Exact for the infinite lattice under homogeneous strain.
/// \throws std::invalid_argument unless kn > 0 and ks >= 0
SheetConstants sheetFromBonds(const BondStiffness& bonds);

/// The inverse: kn = E t/(sqrt(3) (1 - nu)), ks = kn (1 - 3 nu)/(1 + nu). nu lies in [0, 1/3]: rubber's 0.5 is out of reach of any such lattice.
/// \throws std::invalid_argument outside that range or unless E t > 0
BondStiffness bondsFromSheet(const SheetConstants& sheet);

} // namespace hexmembrane
