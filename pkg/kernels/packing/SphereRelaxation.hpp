// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/base/CellGrid.hpp"
#include "kernels/base/Random.hpp"
#include "kernels/base/Vec3.hpp"

#include <vector>

namespace hexmembrane {

/// Frictionless soft spheres inside a vertical cylinder with flat ends, pushed apart until they no longer overlap.
///
/// Energy: half the sum of the squared overlaps (m2) of all pairs and of spheres with the walls; a sphere's force is the sum of its overlaps along the
/// normals. Minimised by FIRE (Bitzek, Koskinen, Gaehler, Moseler, Gumbsch: Structural relaxation made simple, Phys. Rev. Lett. 97, 170201, 2006): unit
/// masses and unit stiffness, so that steps and limits are free of dimension. The axis is z, the lower end on z = 0. All spheres grow and shrink by one
/// common factor. One thread, sums in a fixed order: the same input gives the same bits.
class SphereRelaxation {
public:
	enum class Outcome {
		separated, ///< the largest overlap is within the tolerance
		jammed,    ///< in equilibrium with larger overlaps: this size does not go in from here
		exhausted  ///< neither within the allowed number of steps
	};

	/// Spheres of `radii` (m, at factor 1) at `centres` (m) in a cylinder of `radius` and `height` (m). Input is the caller's to check.
	SphereRelaxation(std::vector<Vec3> centres, std::vector<double> radii, double radius, double height);

	/// Minimises at radii multiplied by `factor` until the largest overlap is at most `tolerance` (m), equilibrium, or `maxSteps`.
	Outcome relax(double factor, double tolerance, int maxSteps);

	/// Moves every sphere by a random step, uniform in a cube of half side `amplitude` (m), and back inside the cylinder.
	void shake(double amplitude, Random& random);

	const std::vector<Vec3>& centres() const { return x; }
	/// Of the last step: largest overlap and sum over all contacts (m), number of contacts, mean net force over mean contact force.
	double largestOverlap() const { return maxOverlap; }
	double meanOverlap() const { return contacts > 0 ? sumOverlap / contacts : 0; }
	int contactCount() const { return contacts; }
	double unbalancedRatio() const;
	/// Steps made so far, over all calls.
	long steps() const { return totalSteps; }

private:
	void refreshPairs();
	void computeForces();
	void addWalls(std::size_t i);

	std::vector<Vec3> x, v, f;
	std::vector<double> r;      // at factor 1
	std::vector<double> scaled; // r * factor
	double cylinderRadius, cylinderHeight;
	double meanRadius, largestRadius;
	double factor = 1;

	NearPairs pairs;
	std::vector<Vec3> listed; // positions when `pairs` was made
	double listedFactor = 0;  // 0: no list yet
	double skin;

	double maxOverlap = 0, sumOverlap = 0;
	int contacts = 0;
	long totalSteps = 0;
};

} // namespace hexmembrane
