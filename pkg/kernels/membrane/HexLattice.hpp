// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/membrane/HexStencil.hpp"
#include "kernels/base/Vec3.hpp"
#include "SharedValues.hpp"

#include <array>
#include <vector>

namespace hexmembrane {

/// Where the membrane stands relative to the specimen's lateral surface.
enum class Placement {
	outside, ///< the membrane's inner surface touches the specimen (centres one particle radius outside)
	centred  ///< the particles' centres lie on the specimen's surface, as in the source study
};

/// What a hexagonal membrane is asked to be. Lengths in m.
struct HexLatticeSpec {
	double specimenRadius; ///< > 0
	double specimenHeight; ///< > 0
	double particleRadius; ///< > 0; see HexLattice::sphereRadius for what becomes of it
	Placement placement = Placement::outside;
	int oRingRows = HEXMEMBRANE_O_RING_ROWS_DEFAULT;  ///< rows beyond each end of the specimen (group 1)
	int platenRows = HEXMEMBRANE_PLATEN_ROWS_DEFAULT; ///< rows at each platen inside the specimen's ends (group 2)
};

/// A hexagonal membrane: rings of touching spheres round the z axis, every other ring turned by half a spacing. The specimen stands on z = 0.
///
/// Ring closure: with s = sin(pi/n), n spheres of radius R touch in a ring of centre radius R/s. 'outside' keeps the specimen's surface and fits the
/// sphere radius to it, R = Rs s/(1 - s) (it moves by less than 1/(2n) of what was asked); 'centred' keeps the sphere radius and takes the ring radius
/// that closes, R/s. The rings stand at the stress-free distance of the curved lattice, 2R sqrt(1 - 1/(4 cos^2(pi/2n))), which tends to sqrt(3) R.
/// Every particle of the inside has six neighbours at exactly 2R.
struct HexLattice : HexStencil {
	double sphereRadius; ///< radius of the spheres (m)
	double centreRadius; ///< radius of the cylinder through the centres (m)
	double innerRadius;  ///< centreRadius - sphereRadius: the side of the soil (m)
	double ringSpacing;  ///< distance of neighbouring rings along the axis (m)

	std::vector<Vec3> positions;               ///< centres; particle i of ring k (from the bottom) at k perRing + i
	std::vector<int> groups;                   ///< 1 O-ring, 2 beside a platen, 3 main body
	std::vector<std::array<int, 3>> triangles; ///< 2 n (rings - 1), counter-clockwise seen from outside
	std::vector<std::array<int, 2>> bonds;     ///< n (3 rings - 2), in the order of HexStencil
};

/// Triangles between ring k and the next, counter-clockwise seen from outside, appended to `out`.
void appendTriangles(const HexStencil& tube, int k, std::vector<std::array<int, 3>>& out);

/// All bonds as pairs, in the order of HexStencil.
std::vector<std::array<int, 2>> bondList(const HexStencil& tube);

/// Builds the lattice. Rows over the specimen: round((H - 2R)/h) + 1, centred at mid-height.
/// \throws std::invalid_argument naming parameter, value and fix: non-finite or non-positive lengths, fewer than 6 spheres a ring, a specimen lower
/// than one particle, negative row counts, platen rows of the two ends that leave no main body between them.
HexLattice makeHexLattice(const HexLatticeSpec& spec);

/// Largest membrane sphere radius that lets no grain through the gap of three touching spheres: 3/(2 sqrt(3) - 3) r (Eq. 1 of the source study).
double largestMembraneRadius(double smallestGrainRadius);

} // namespace hexmembrane
