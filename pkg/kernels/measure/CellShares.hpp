// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/measure/PowerTriangulation.hpp"

#include <deque>

namespace hexmembrane {

/// A convex part of a tetrahedron, in coordinates in which the tetrahedron is 0, e1, e2, e3. Faces in one list: number of corners, then the corners, which go
/// round counter-clockwise seen from outside.
struct ConvexPart {
	std::vector<Vec3> corners;
	std::vector<int> faces;

	static ConvexPart whole();
	/// Volume over that of the tetrahedron.
	double fraction() const;
	/// That of the part where `side` (one a corner) is not negative; some are negative and some positive.
	double fractionBeyond(const std::vector<double>& side) const;
	/// Makes this the part of `of` where `side` (one a corner of `of`) is not negative; some are negative and some positive. The other part, by the opposite
	/// sides, meets this one in the very same corners, so that the two add up to the whole.
	void clip(const ConvexPart& of, const std::vector<double>& side);

private:
	std::vector<int> renumbered;
	std::vector<std::array<int, 3>> crossings; // ends of an edge, the corner on it
	std::vector<std::array<int, 2>> rim;
};

/// Who owns which part of a tetrahedron: space is divided into the power cells of sites and cut at two heights. The tetrahedron is halved by the border of two
/// cells, and each half again by the next one, until each part has one owner. Parts are fractions of the whole, so a flat tetrahedron is no special
/// case, and they add up to the whole to rounding.
class CellShares {
public:
	/// \param sites the first of them have cells \param starts, neighbours who is beside whom, as in PowerTriangulation \param bottom, top heights of the cuts
	/// (m). The lists are referred to and must outlive this.
	CellShares(const std::vector<PowerSite>& sites, const std::vector<int>& starts, const std::vector<int>& neighbours, double bottom, double top);

	/// A part of a tetrahedron that lies in one cell, between the heights.
	struct Share {
		int site;
		double fraction; ///< of the tetrahedron's volume
	};

	/// The site in whose cell a point lies: a walk downhill from `from`, which ends nowhere else in a triangulation.
	int cellAt(const Vec3& x, int from) const;

	/// Shares of a tetrahedron with the corners x, which lie in the cells `at`, appended to `out`, one for each site with a part.
	void divide(const std::array<Vec3, 4>& x, const std::array<int, 4>& at, std::vector<Share>& out);

private:
	using AtCorners = std::array<double, 4>;
	double power(int site, const Vec3& x) const { return (x - sites[site].centre).squaredNorm() - sites[site].radius * sites[site].radius; }
	void gather(const std::array<Vec3, 4>& x, const std::array<int, 4>& at);
	bool mayOwn(const AtCorners& powers) const;
	void settle(const ConvexPart& part, double fraction, int begin, std::size_t depth);
	/// Fills `sides` with a linear function, given at the tetrahedron's corners, at those of a part; whether it is somewhere negative, somewhere positive.
	std::array<bool, 2> signs(const ConvexPart& part, const AtCorners& values);
	ConvexPart& spare(std::size_t depth);

	const std::vector<PowerSite>& sites;
	const std::vector<int>&starts, &neighbours;
	double bottom, top;

	// of the tetrahedron at hand
	std::vector<int> candidates;   // sites whose cells may reach in
	std::vector<AtCorners> powers; // theirs
	std::vector<int> seenBy;       // by site: the last tetrahedron that looked at it
	int turn = 0;
	std::vector<int> active;   // stacked lists of candidates
	std::vector<double> owned; // by candidate
	std::vector<double> sides;
	std::deque<ConvexPart> spares; // by depth: parts keep their memory
	const ConvexPart unit = ConvexPart::whole();
};

} // namespace hexmembrane
