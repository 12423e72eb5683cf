// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/base/Vec3.hpp"

#include <cstdint>
#include <limits>
#include <vector>

namespace hexmembrane {

/// What a packing is asked to be. Lengths in m.
struct SpherePackingSpec {
	double radius;                                              ///< of the cylinder, > 0
	double height;                                              ///< of the cylinder, > 0
	std::vector<double> radii;                                  ///< of the spheres, each > 0
	double porosity = std::numeric_limits<double>::quiet_NaN(); ///< in (0, 1): radii are scaled to meet it; NaN: radii are kept
	std::uint64_t seed = 1;
	double tolerance = 1e-4; ///< room left round the spheres over the mean radius, in (0, 0.01]; see packSpheres
	int shakes = 8;          ///< times that a jammed packing is loosened, shaken and grown again before it is given up, >= 0
	double even = 0.58;      ///< solid fraction up to which a looser packing is spread, in [0, 0.6]; 0: not at all
};

/// Spheres inside a vertical cylinder whose axis is z and whose lower end lies on z = 0; sphere i has the i-th of the given radii.
struct SpherePacking {
	std::vector<Vec3> centres; ///< m
	std::vector<double> radii; ///< m: the given ones times `scale`
	double scale;              ///< common factor on the radii (1 when they are kept)
	double porosity;           ///< 1 - volume of the spheres / volume of the cylinder
	double maxOverlap;         ///< largest overlap of two spheres, or of a sphere with the wall, over the mean radius
	int shakesUsed;            ///< how often it jammed on the way
	long steps;                ///< steps of the relaxation
};

/// Dense random packing without overlaps, statistically isotropic and homogeneous, without gravity; reproducible from the seed.
///
/// Centres are drawn uniformly in the cylinder; spheres of reduced size are pushed apart as frictionless soft spheres (SphereRelaxation) and grown in
/// steps. Sizes are drawn to places at random, so they do not segregate. Loose packings are grown to the solid fraction `even` all the same and shrunk to
/// their size afterwards: grains keep clear of each other and the packing is as even as a dense one. Dense ones are relaxed at radii larger by the
/// factor 1 + tolerance until those overlap by less than tolerance times the smallest radius, so that none overlap at their own size.
///
/// What can be reached is the random close packing of frictionless spheres of these sizes, less what the walls cost (a layer half a grain wide): for
/// about 7,000 grains of a uniform sand in a cylinder of H = 2 D a porosity of 0.38, for 1,200 grains 0.40. Shaking gains about 0.005. Anything denser
/// is an error that names the densest state found.
/// \throws FieldError for bad input, FieldFailure for a porosity out of reach
SpherePacking packSpheres(const SpherePackingSpec& spec);

/// 1 - volume of spheres of `radii` / volume of the cylinder. All in m. \throws std::invalid_argument for lengths that are not positive
double packingPorosity(const std::vector<double>& radii, double cylinderRadius, double cylinderHeight);

/// Factor on `radii` that gives `porosity` in the cylinder. \throws std::invalid_argument for a porosity outside (0, 1), no radii, bad lengths
double scaleForPorosity(const std::vector<double>& radii, double cylinderRadius, double cylinderHeight, double porosity);

/// Largest overlap (m; 0 if none) of two spheres or of a sphere with the cylinder of SpherePacking. O(N).
/// \throws std::invalid_argument for unequal lengths, bad lengths, or centres that are not finite
double largestOverlap(const std::vector<Vec3>& centres, const std::vector<double>& radii, double cylinderRadius, double cylinderHeight);

} // namespace hexmembrane
