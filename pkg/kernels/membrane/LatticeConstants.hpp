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
/// \throws FieldError unless kn > 0 and ks >= 0
SheetConstants sheetFromBonds(const BondStiffness& bonds);

/// The inverse: kn = E t/(sqrt(3) (1 - nu)), ks = kn (1 - 3 nu)/(1 + nu). nu lies in [0, 1/3]: rubber's 0.5 is out of reach of any such lattice.
/// \throws FieldError outside that range or unless E t > 0
BondStiffness bondsFromSheet(const SheetConstants& sheet);

/// Critical time step (s) of central differences, 2/omega, of the bonds alone: omega^2 = max(6 kn + 2 ks, 30 ks)/m, for spheres of mass m (kg), radius R
/// and moment of inertia 0.4 m R^2 at distances of 2R.
///
/// Exact for the free, flat, unstretched lattice. The first term is the wave in which neighbouring rows move against each other, the second the mode in
/// which all spheres spin alike: a bond resists the mean of its two spins. A lower bound for the tube, and for one whose end rows are held. Not bounded are
/// contacts, and bonds that are stretched by a strain e: their tension adds some 2 kn e to the first term, their length multiplies the second by (1 + e)^2.
/// \throws FieldError unless kn > 0, ks >= 0 and mass > 0
double criticalStepOfBonds(const BondStiffness& bonds, double mass);

} // namespace hexmembrane
