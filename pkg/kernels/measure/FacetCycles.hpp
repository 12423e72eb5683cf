// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>
#include <functional>
#include <vector>

namespace hexmembrane {

/// An oriented facet that counts a number of times; turning it round is counting it negative.
struct Facet {
	std::array<int, 3> corners;
	int times;
};

/// Adds up facets of the same corners and leaves out those that cancel.
std::vector<Facet> sumOf(std::vector<Facet> facets);

/// A tetrahedron that counts a number of times.
struct Filling {
	std::array<int, 4> corners;
	int times;
};

/// Fills the cycles that facets make with tetrahedra: their boundary is the facets. Facets that share an edge belong together and are joined to one of their own
/// corners. Facets may be left out where all corners are beyond the same end: `beyond(corner)` is -1 or 1 there, and 0 elsewhere.
/// \returns the tetrahedra, corners first, and how often each counts
/// \throws FieldFailure when an edge that is not beyond an end stays open
std::vector<Filling> fillCycles(const std::vector<Facet>& facets, const std::function<int(int)>& beyond);

} // namespace hexmembrane
