// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/membrane/HexLattice.hpp"

#include "kernels/base/Check.hpp"

#include <cmath>

namespace hexmembrane {

namespace {

/// Fewer spheres than this make no ring that encloses anything.
constexpr int minPerRing = 6;

void check(const HexLatticeSpec& s)
{
	requirePositive("specimenRadius", s.specimenRadius, "m");
	requirePositive("specimenHeight", s.specimenHeight, "m");
	requirePositive("particleRadius", s.particleRadius, "m");
	requireIn(shared::o_ring_rows, "oRingRows", s.oRingRows, "rows (2 in the source study)");
	requireIn(shared::platen_rows, "platenRows", s.platenRows, "rows");
}

/// Number of spheres a ring and the radii that follow; see the class comment.
void closeRing(const HexLatticeSpec& s, HexLattice& out)
{
	const bool outside = s.placement == Placement::outside;
	const double wanted = outside ? s.specimenRadius + s.particleRadius : s.specimenRadius;
	const double sine = s.particleRadius / wanted;
	const long n = sine < 1 ? std::lround(M_PI / std::asin(sine)) : 0;
	if (n < minPerRing) {
		const double s6 = std::sin(M_PI / minPerRing);
		const double max = s.specimenRadius * (outside ? s6 / (1 - s6) : s6);
		reject("particleRadius", s.particleRadius, "too coarse, a ring would have " + std::to_string(n) + " spheres",
		       "at most " + formatNumber(max) + " m for this specimen (6 spheres a ring)");
	}
	out.perRing = static_cast<int>(n);

	const double closed = std::sin(M_PI / static_cast<double>(n));
	out.sphereRadius = outside ? s.specimenRadius * closed / (1 - closed) : s.particleRadius;
	out.centreRadius = out.sphereRadius / closed;
	out.innerRadius = out.centreRadius - out.sphereRadius;
	const double c = std::cos(M_PI / (2. * static_cast<double>(n)));
	out.ringSpacing = 2 * out.sphereRadius * std::sqrt(1 - 1 / (4 * c * c));
}

/// Rows over the specimen's height, checked against the rows that the groups take from it.
int specimenRows(const HexLatticeSpec& s, const HexLattice& l)
{
	if (s.specimenHeight < 2 * l.sphereRadius)
		reject("specimenHeight", s.specimenHeight, "lower than one membrane particle, no ring fits",
		       "more than " + formatNumber(2 * l.sphereRadius) + " m, or a smaller particleRadius");
	const int rows = 1 + static_cast<int>(std::lround((s.specimenHeight - 2 * l.sphereRadius) / l.ringSpacing));
	if (2 * s.platenRows >= rows)
		reject("platenRows", s.platenRows, "the rows at both platens overlap: only " + std::to_string(rows) + " rows stand over the specimen",
		       "at most " + std::to_string((rows - 1) / 2) + ", so that group 3 keeps a row");
	return rows;
}

} // namespace

std::vector<std::array<int, 2>> bondList(const HexStencil& tube)
{
	std::vector<std::array<int, 2>> bonds;
	bonds.reserve(tube.bondCount());
	for (int family = 0; family < 3; ++family)
		for (int k = 0; k < tube.familyRows(family); ++k) {
			const auto far = HexStencil::farEnd(family, k);
			for (int i = 0; i < tube.perRing; ++i) bonds.push_back({tube.at(k, i), tube.at(k + far[0], i + far[1])});
		}
	return bonds;
}

void appendTriangles(const HexStencil& tube, int k, std::vector<std::array<int, 3>>& out)
{
	for (int i = 0; i < tube.perRing; ++i) {
		// the upper right neighbour of (k, i) is the upper left one of (k, i + 1): it stands between them
		const int above = i + HexStencil::right(k);
		out.push_back({tube.at(k, i), tube.at(k, i + 1), tube.at(k + 1, above)});
		out.push_back({tube.at(k, i + 1), tube.at(k + 1, above + 1), tube.at(k + 1, above)});
	}
}

HexLattice makeHexLattice(const HexLatticeSpec& spec)
{
	check(spec);
	HexLattice l;
	closeRing(spec, l);
	const int rows = specimenRows(spec, l);
	l.rings = rows + 2 * spec.oRingRows;

	const int n = l.perRing;
	l.positions.reserve(l.particles());
	l.groups.reserve(l.particles());
	for (int k = 0; k < l.rings; ++k) {
		const double z = 0.5 * spec.specimenHeight + (k - 0.5 * (l.rings - 1)) * l.ringSpacing;
		const int fromEnd = std::min(k, l.rings - 1 - k);
		const int group = fromEnd < spec.oRingRows ? 1 : fromEnd < spec.oRingRows + spec.platenRows ? 2 : 3;
		for (int i = 0; i < n; ++i) {
			const double angle = 2 * M_PI * (i + 0.5 * (k % 2)) / n;
			l.positions.emplace_back(l.centreRadius * std::cos(angle), l.centreRadius * std::sin(angle), z);
			l.groups.push_back(group);
		}
	}
	l.bonds = bondList(l);
	l.triangles.reserve(2 * n * (l.rings - 1));
	for (int k = 0; k + 1 < l.rings; ++k) appendTriangles(l, k, l.triangles);
	return l;
}

double largestMembraneRadius(double smallestGrainRadius) { return 3 / (2 * std::sqrt(3.) - 3) * smallestGrainRadius; }

} // namespace hexmembrane
