// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/base/Vec3.hpp"

#include <array>
#include <vector>

namespace hexmembrane {

/// A plane with a thickness: dip (rad), azimuth (rad), offset along its upward normal (m), logarithm of the thickness over 1 m.
using BandPlane = Eigen::Vector4d;

/// The grains of a step as columns of numbers, for the passes over them that BandSearch.hpp needs.
///
/// The powers of a place: a = x and y over the largest |x| or |y|, r2 = x^2 + y^2 over the largest, z over the largest |z|. Symmetric ones are r2^p L_q(z), p = 0 to 2,
/// L_q Legendre's polynomials, q = 0 to 5, q running first. After the symmetric ones come a_x times them, then a_y times them.
struct BandColumns {
	static constexpr int heights = 6, radii = 3, symmetric = heights * radii, powers = 3 * symmetric;
	static constexpr int measured = powers + 4; ///< and displacements and strain
	static constexpr int mostBeside = 4;        ///< planes that a sum can have beside it

	BandColumns(const std::vector<Vec3>& places, const std::vector<Vec3>& displacements, const std::vector<double>& weights,
	            const std::vector<double>& strains);
	std::array<double, powers> powersAt(std::size_t grain) const;

	/// Filled up with grains without weight, so that lanes need no end.
	std::vector<double> x, y, z, ax, ay, square, weight, ux, uy, uz, strain;
	std::array<std::vector<double>, heights> legendre;
};

/// Weighted products of the powers, ux, uy, uz and the strain with each other: the lower triangle, row by row.
std::vector<double> bandProducts(const BandColumns& columns);

/// What a sum is of: both smooth profiles of a plane, one of them, or the displacement across a slab of uniform shear.
enum class BandProfile { both, step, slab, ramp };

/// The profiles of planes, times the weights.
struct BandRows {
	std::vector<std::vector<double>> step, slab;
};

/// Weighted sums of a plane's profiles with all else. With s the distance and t the thickness, step: erf(sqrt(6) s/t)/2, or s/t within -1/2 to 1/2 (ramp);
/// slab: exp(-6 s^2/t^2).
struct BandSums {
	std::array<double, BandColumns::powers> step{};
	std::array<double, BandColumns::symmetric> slab{};
	std::array<double, BandColumns::mostBeside> stepBeside{}, slabBeside{};
	std::array<double, 3> moved{}; ///< step with ux, uy, uz
	double stepSquare = 0, slabSquare = 0, strained = 0;
};

/// \param beside rows to add up the profiles with \param keep where both profiles go, as a row more; nullptr: nowhere
BandSums bandSums(const BandColumns& columns, const BandPlane& plane, BandProfile profile, const BandRows& beside, BandRows* keep = nullptr);

} // namespace hexmembrane
