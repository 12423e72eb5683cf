// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/base/Vec3.hpp"

#include <array>
#include <vector>

namespace hexmembrane {

/// Area and volume of the part of an upright, outward oriented tube between two horizontal planes.
struct TubeSlab {
	double area;   ///< lateral area between the planes (m2)
	double volume; ///< volume enclosed by the tube and the two planes (m3)
};

/// Measures a triangulated tube between each two neighbours of rising heights, triangles that a plane cuts exactly included: one slab less than heights.
/// Volume by the divergence theorem with the field (x, y, 0)/2, to which the horizontal ends contribute nothing. Planes beyond the tube's ends stand for
/// the ends themselves, whose rings are taken as plane. One pass over the triangles. \throws std::invalid_argument unless the heights rise
std::vector<TubeSlab> measureTube(const std::vector<std::array<int, 3>>& triangles, const std::vector<Vec3>& x, const std::vector<double>& heights);

/// Volume of a closed outward oriented surface (m3).
double closedVolume(const std::vector<std::array<int, 3>>& triangles, const std::vector<Vec3>& x);

} // namespace hexmembrane
