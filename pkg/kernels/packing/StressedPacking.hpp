// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/packing/GrainAssembly.hpp"
#include "kernels/packing/SpherePacking.hpp"

namespace hexmembrane {

/// A packing in equilibrium under a small isotropic stress at a given porosity.
struct StressedPackingSpec {
	SpherePackingSpec packing;       ///< its porosity is required; without friction NaN is the packing's own
	double stress;                   ///< Pa, > 0: mean pressure on the smooth walls; at most 1e-2 of the modulus
	GrainLaw law;                    ///< friction and rolling friction are those of the finished packing
	double porosityTolerance = 1e-3; ///< in (0, 0.1)
};

/// Centres and radii as in SpherePacking (`scale` and `porosity` are those reached, contacts overlap by what the stress asks for), and:
struct StressedPacking : SpherePacking {
	double radialStress = 0;    ///< on the cylinder's side (Pa, compression positive)
	double axialStress = 0;     ///< on its ends (Pa, compression positive)
	double coordination = 0;    ///< contacts with grains of a grain, mean
	double rattlers = 0;        ///< share of grains without any contact
	double unbalanced = 0;      ///< mean net force over mean contact force
	double frictionReached = 0; ///< down to which friction was lowered on the way: the measure of how dense the packing is for its friction
};

/// Compresses a loose packing that is not yet even (SpherePacking at 0.08 above the wanted porosity, not spread). The grains grow inside fixed smooth walls,
/// slowly (inertial number 2e-3 and less), with the friction of the finished packing at first. Where the mean stress exceeds the wanted one, friction is
/// lowered until the grains give way, and rolling friction with it. So the packing reaches the wanted size at the wanted stress on one path and without
/// trials. Then friction is set to its final value. The size is trimmed within the tolerance of the porosity until the stress (3 %) and the equilibrium
/// (unbalanced ratio 1e-3) are reached.
///
/// In reach is what lies between the packing without friction (dense) and the one that keeps its friction throughout (loose; rolling friction holds looser
/// ones). Anything beyond is an error that names the porosity reached. Measured ranges: pkg/specimen/README.md.
///
/// Without friction (below 1e-4) there is one porosity at a stress, up to the chance of the start. The packing grows until it carries the stress, from the
/// same start whatever porosity is asked for. A porosity that is asked for must be that one within the tolerance.
/// \throws FieldError for bad input, FieldFailure for a porosity out of reach or no equilibrium
StressedPacking packUnderStress(const StressedPackingSpec& spec);

} // namespace hexmembrane
