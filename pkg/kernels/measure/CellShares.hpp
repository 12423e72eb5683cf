// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/measure/PowerTriangulation.hpp"

namespace hexmembrane {

/// Who owns which part of a tetrahedron: space is divided into the power cells of sites and cut at two heights. A tetrahedron is halved at an edge that a
/// border crosses, again and again, until no border crosses any part. The parts are fractions of the whole, so a flat tetrahedron is no special case, and
/// they add up to the whole to rounding.
class CellShares {
public:
	/// \param sites those with cells \param starts, neighbours who is beside whom, as in PowerTriangulation \param bottom, top heights of the cuts (m)
	/// All are referred to and must outlive this.
	CellShares(const std::vector<PowerSite>& sites, const std::vector<int>& starts, const std::vector<int>& neighbours, double bottom, double top);

	/// A part of a tetrahedron that lies in one cell, between the heights.
	struct Share {
		int site;
		double fraction; ///< of the tetrahedron's volume
	};

	/// The site in whose cell a point lies: a walk downhill from `from`, which the triangulation cannot stop early.
	int cellAt(const Vec3& x, int from) const;

	/// Shares of a tetrahedron with the corners x, which lie in the cells `at`, appended to `out`, one for each site with a part.
	void divide(const std::array<Vec3, 4>& x, const std::array<int, 4>& at, std::vector<Share>& out);

private:
	using Corners = std::array<int, 4>;
	struct Crossing {
		int from = -1, to = -1;
		double share = 0;
	};
	double power(int site, const Vec3& x) const { return x.dot(x) - 2 * x.dot(sites[site].centre) + level[site]; }
	void gather(const std::array<Vec3, 4>& x, const std::array<int, 4>& at);
	bool mayOwn(int candidate) const;
	void cut(Corners corners, double part, int plane);
	void settle(Corners corners, double part, int begin, int end);
	int between(const Crossing& crossing, const Corners& corners);
	double* row(int corner) { return &values[std::size_t(corner) * width]; }

	const std::vector<PowerSite>& sites;
	const std::vector<int>&starts, &neighbours;
	double bottom, top;
	std::vector<double> level; // |centre|^2 - radius^2

	// of the tetrahedron at hand
	int width = 0;
	std::vector<int> candidates;                 // sites whose cells may reach in
	std::vector<std::array<double, 4>> atCorner; // their powers
	std::vector<int> seenBy;                     // by site: the last tetrahedron that looked at it
	int turn = 0;
	std::vector<double> values; // a row a corner: height over bottom, below top, powers of the candidates
	int corners = 0;            // rows in use
	std::vector<int> active;    // stacked lists of candidates
	std::vector<double> owned;  // by candidate: fraction
};

} // namespace hexmembrane
