// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/base/Vec3.hpp"

#include <array>
#include <vector>

namespace hexmembrane {

/// A sphere as a site: the power of a point x is |x - centre|^2 - radius^2.
struct PowerSite {
	Vec3 centre;   ///< (m)
	double radius; ///< (m)
};

/// The power triangulation (regular, weighted Delaunay) of sites.
struct PowerTriangulation {
	/// Sites of each tetrahedron, turned so that det(b - a, c - a, d - a) > 0.
	std::vector<std::array<int, 4>> tetrahedra;
	/// Beside each tetrahedron, across the facet opposite to each corner; -1: the outside.
	std::vector<std::array<int, 4>> beside;
	/// Neighbours of the first sites in the triangulation of the first sites alone: those of site i lie from starts[i] to starts[i + 1].
	std::vector<int> starts, neighbours;
};

/// The triangulation of all sites, and who is beside whom among the first ones alone. By CGAL with exact predicates, so any input gives a valid one.
/// A site whose power cell is empty is in no tetrahedron and has no neighbours.
/// \throws FieldError for sites that are not finite
PowerTriangulation triangulate(const std::vector<PowerSite>& sites, int first);

} // namespace hexmembrane
