// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/measure/CylinderTube.hpp"

#include "kernels/base/Check.hpp"
#include "kernels/membrane/HexLattice.hpp"

#include <algorithm>
#include <cmath>

namespace hexmembrane {

namespace {

constexpr int beyond = 2; // rows past each face
constexpr int fewest = 6; // points of a ring

} // namespace

CylinderLattice cylinderLattice(double radius, double height, double spacing)
{
	requirePositive("radius", radius, "m");
	requirePositive("height", height, "m");
	requirePositive("spacing", spacing, "m");
	const int around = std::max(fewest, static_cast<int>(std::lround(2 * M_PI * radius / spacing)));
	return {around, std::max(1, static_cast<int>(std::lround(height / (std::sqrt(3.) / 2 * spacing))))};
}

Enclosure cylinderTube(const Vec3& axis, double radius, double bottom, double top, const CylinderLattice& lattice)
{
	requirePositive("radius", radius, "m");
	if (lattice.around < fewest) reject("around", lattice.around, "are too few points for a ring", "6 or more");
	if (lattice.rows < 1) reject("rows", lattice.rows, "is no row", "1 or more");
	const double n = lattice.around;
	// A row's cross-section is a polygon of n corners at its rings and one of 2n midway: Simpson's rule is exact for its volume.
	const double atRing = n / 2 * std::sin(2 * M_PI / n), midway = n * std::pow(std::cos(M_PI / (2 * n)), 2) * std::sin(M_PI / n);
	const double inner = radius * std::sqrt(M_PI / ((2 * atRing + 4 * midway) / 6));
	// spheres of a ring touch each other
	const double s = std::sin(M_PI / n), sphere = inner * s / (1 - s);
	Enclosure made{{}, sphere, {}, {}, bottom, top};
	const HexStencil stencil{lattice.around, lattice.rows + 1 + 2 * beyond};
	for (int k = 0; k < stencil.rings; ++k) {
		// the rows at the faces are at them to the last bit
		const double z = k - beyond == lattice.rows ? top : bottom + (top - bottom) * (k - beyond) / lattice.rows;
		for (int i = 0; i < stencil.perRing; ++i) {
			const double angle = 2 * M_PI * (i + (k % 2 ? 0.5 : 0)) / n;
			const Vec3 out(std::cos(angle), std::sin(angle), 0), middle(axis[0], axis[1], z);
			made.centres.push_back(middle + (inner + sphere) * out);
			made.inner.push_back(middle + inner * out);
		}
		if (k > 0) appendTriangles(stencil, k - 1, made.triangles);
	}
	return made;
}

} // namespace hexmembrane
