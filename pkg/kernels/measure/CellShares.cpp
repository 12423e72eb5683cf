// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/measure/CellShares.hpp"

#include <algorithm>

namespace hexmembrane {

namespace {

// A corner nearer to a border than this, relative to the tetrahedron's farthest, is on it: far above rounding, so that no face is crossed twice.
constexpr double onBorder = 1e-12;

} // namespace

ConvexPart ConvexPart::whole()
{
	ConvexPart made;
	made.corners = {Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
	made.faces = {3, 1, 2, 3, 3, 0, 3, 2, 3, 0, 1, 3, 3, 0, 2, 1};
	return made;
}

double ConvexPart::fraction() const
{
	double sum = 0;
	const Vec3& apex = corners[0];
	for (std::size_t f = 0; f < faces.size(); f += faces[f] + 1) {
		const int* corner = &faces[f + 1];
		const Vec3 first = corners[corner[0]] - apex;
		for (int k = 1; k + 1 < faces[f]; ++k) sum += first.dot((corners[corner[k]] - apex).cross(corners[corner[k + 1]] - apex));
	}
	return sum;
}

double ConvexPart::fractionBeyond(const std::vector<double>& side) const
{
	const auto crossing = [&](int a, int b) -> Vec3 { return (side[a] * corners[b] - side[b] * corners[a]) / (side[a] - side[b]); };
	const auto differ = [&](int a, int b) { return (side[a] > 0 && side[b] < 0) || (side[a] < 0 && side[b] > 0); };
	// seen from a point of the border, the face on the border has no volume
	const Vec3 apex = [&]() -> Vec3 {
		for (std::size_t f = 0; f < faces.size(); f += faces[f] + 1)
			for (int k = 1; k < faces[f]; ++k) {
				const int a = faces[f + k], b = faces[f + k + 1];
				if (side[a] == 0) return corners[a];
				if (differ(a, b)) return crossing(a, b);
			}
		return corners[0];
	}();
	double sum = 0;
	for (std::size_t f = 0; f < faces.size(); f += faces[f] + 1) {
		const int count = faces[f], *corner = &faces[f + 1];
		Vec3 first = Vec3::Zero(), last = Vec3::Zero();
		int met = 0;
		const auto meet = [&](const Vec3& x) {
			const Vec3 seen = x - apex;
			if (++met > 2) sum += first.dot(last.cross(seen));
			(met == 1 ? first : last) = seen;
		};
		for (int k = 0; k < count; ++k) {
			const int a = corner[k], b = corner[k + 1 < count ? k + 1 : 0];
			if (side[a] >= 0) meet(corners[a]);
			if (differ(a, b)) meet(crossing(a, b));
		}
	}
	return sum;
}

void ConvexPart::clip(const ConvexPart& of, const std::vector<double>& side)
{
	corners.clear();
	faces.clear();
	crossings.clear();
	rim.clear();
	renumbered.assign(of.corners.size(), -1);
	for (std::size_t c = 0; c < of.corners.size(); ++c)
		if (side[c] >= 0) {
			renumbered[c] = static_cast<int>(corners.size());
			corners.push_back(of.corners[c]);
		}
	const auto crossing = [&](int a, int b) {
		if (a > b) std::swap(a, b);
		for (const auto& known : crossings)
			if (known[0] == a && known[1] == b) return known[2];
		// in the order of the numbers: the other part finds the very same point
		corners.push_back((side[a] * of.corners[b] - side[b] * of.corners[a]) / (side[a] - side[b]));
		crossings.push_back({a, b, static_cast<int>(corners.size()) - 1});
		return crossings.back()[2];
	};
	for (std::size_t f = 0; f < of.faces.size(); f += of.faces[f] + 1) {
		const int count = of.faces[f], *corner = &of.faces[f + 1];
		const std::size_t start = faces.size();
		faces.push_back(0);
		int left = -1, entered = -1; // where this face leaves the kept side, where it comes back
		bool kept = false;
		for (int k = 0; k < count; ++k) {
			const int a = corner[k], b = corner[k + 1 < count ? k + 1 : 0];
			if (side[a] >= 0) {
				faces.push_back(renumbered[a]);
				kept = kept || side[a] > 0;
				if (side[a] == 0) {
					// the border runs through this corner: which way does the face go on?
					const int before = corner[k > 0 ? k - 1 : count - 1];
					if (side[b] <= 0 && side[before] > 0) left = renumbered[a];
					if (side[b] > 0 && side[before] <= 0) entered = renumbered[a];
				}
			}
			if (side[a] > 0 && side[b] < 0) faces.push_back(left = crossing(a, b));
			if (side[a] < 0 && side[b] > 0) faces.push_back(entered = crossing(a, b));
		}
		faces[start] = static_cast<int>(faces.size() - start) - 1;
		if (!kept)
			faces.resize(start); // an edge or a corner on the border
		else if (left >= 0 && entered >= 0 && left != entered)
			rim.push_back({entered, left});
	}
	// the face on the border runs against the others' edges
	if (rim.size() < 3) return;
	faces.push_back(static_cast<int>(rim.size()));
	for (std::size_t k = 0, at = 0; k < rim.size(); ++k) {
		faces.push_back(rim[at][0]);
		const int next = rim[at][1];
		for (at = 0; at + 1 < rim.size() && rim[at][0] != next;) ++at;
	}
}

CellShares::CellShares(const std::vector<PowerSite>& theSites, const std::vector<int>& theStarts, const std::vector<int>& theNeighbours, double low,
                       double high)
    : sites(theSites), starts(theStarts), neighbours(theNeighbours), bottom(low), top(high), seenBy(theStarts.size() - 1, 0)
{
}

int CellShares::cellAt(const Vec3& x, int from) const
{
	int best = from;
	double least = power(from, x);
	for (bool moved = true; moved;) {
		moved = false;
		const int here = best;
		for (int k = starts[here]; k < starts[here + 1]; ++k) {
			const double other = power(neighbours[k], x);
			if (!(other < least)) continue;
			least = other;
			best = neighbours[k];
			moved = true;
		}
	}
	return best;
}

bool CellShares::mayOwn(const AtCorners& mine) const
{
	for (const AtCorners& theirs : powers)
		if (theirs[0] <= mine[0] && theirs[1] <= mine[1] && theirs[2] <= mine[2] && theirs[3] <= mine[3]) return false;
	return true;
}

// A point is in the cell of the site that no neighbour undercuts. So once the neighbours of all candidates have been looked at, no cell is missing.
void CellShares::gather(const std::array<Vec3, 4>& x, const std::array<int, 4>& at)
{
	candidates.clear();
	powers.clear();
	++turn;
	// less the square of the corner's place, which is the same for all sites; seen from the first corner, lest large numbers cancel
	const std::array<Vec3, 3> edges{x[1] - x[0], x[2] - x[0], x[3] - x[0]};
	const auto look = [&](int site) {
		if (seenBy[site] == turn) return;
		seenBy[site] = turn;
		const Vec3 d = sites[site].centre - x[0];
		const double first = d.squaredNorm() - sites[site].radius * sites[site].radius;
		const AtCorners mine{first, first - 2 * d.dot(edges[0]), first - 2 * d.dot(edges[1]), first - 2 * d.dot(edges[2])};
		if (!mayOwn(mine)) return;
		powers.push_back(mine);
		candidates.push_back(site);
	};
	for (int site : at) look(site);
	for (std::size_t c = 0; c < candidates.size(); ++c)
		for (int k = starts[candidates[c]], end = starts[candidates[c] + 1]; k < end; ++k) look(neighbours[k]);
}

ConvexPart& CellShares::spare(std::size_t depth)
{
	if (spares.size() <= depth) spares.resize(depth + 1);
	return spares[depth];
}

std::array<bool, 2> CellShares::signs(const ConvexPart& part, const AtCorners& values)
{
	const double near = onBorder * std::max({std::abs(values[0]), std::abs(values[1]), std::abs(values[2]), std::abs(values[3])});
	const Vec3 slope(values[1] - values[0], values[2] - values[0], values[3] - values[0]);
	std::array<bool, 2> found{false, false};
	sides.resize(part.corners.size());
	for (std::size_t c = 0; c < sides.size(); ++c) {
		const double side = values[0] + slope.dot(part.corners[c]);
		sides[c] = std::abs(side) <= near ? 0 : side;
		found[0] |= sides[c] < 0;
		found[1] |= sides[c] > 0;
	}
	return found;
}

void CellShares::divide(const std::array<Vec3, 4>& x, const std::array<int, 4>& at, std::vector<Share>& out)
{
	const bool oneCell = at[0] == at[1] && at[0] == at[2] && at[0] == at[3]; // cells are convex
	if (oneCell) {
		candidates = {at[0]};
		powers.assign(1, {0, 0, 0, 0});
	} else
		gather(x, at);
	const ConvexPart* part = &unit;
	std::size_t depth = 0;
	for (double sign : {1., -1.}) {
		const double face = sign > 0 ? bottom : top;
		const auto over = [&](int k) { return sign * (x[k][2] - face); };
		const auto [negative, positive] = signs(*part, {over(0), over(1), over(2), over(3)});
		if (negative && !positive) return;
		if (!negative) continue;
		ConvexPart& within = spare(depth++);
		within.clip(*part, sides);
		part = &within;
	}
	owned.assign(candidates.size(), 0);
	active.resize(candidates.size());
	for (std::size_t c = 0; c < active.size(); ++c) active[c] = static_cast<int>(c);
	settle(*part, part == &unit ? 1 : part->fraction(), 0, depth);
	for (std::size_t c = 0; c < candidates.size(); ++c)
		if (owned[c] > 0) out.push_back({candidates[c], owned[c]});
}

// Compares the first candidate of the last list with the others until one is left, or the border of two crosses the part.
void CellShares::settle(const ConvexPart& part, double fraction, int begin, std::size_t depth)
{
	const auto apart = [&](int a, int b) {
		const AtCorners &one = powers[a], &other = powers[b];
		return AtCorners{other[0] - one[0], other[1] - one[1], other[2] - one[2], other[3] - one[3]};
	};
	int rival = -1;
	for (std::size_t k = begin + 1; k < active.size();) {
		const auto [bWins, aWins] = signs(part, apart(active[begin], active[k]));
		if (aWins && bWins) {
			if (rival < 0) rival = static_cast<int>(k);
			++k;
			continue;
		}
		if (bWins) {
			active[begin] = active[k];
			rival = -1; // those that stood up to the former first meet this one
		}
		active[k] = active.back();
		active.pop_back();
		if (bWins) k = begin + 1;
	}
	const int a = active[begin];
	if (rival < 0) {
		owned[a] += fraction;
		return;
	}
	const int b = active[rival], end = static_cast<int>(active.size());
	signs(part, apart(a, b));
	if (end - begin == 2) {
		const double mine = part.fractionBeyond(sides);
		owned[a] += mine;
		owned[b] += fraction - mine;
		return;
	}
	ConvexPart& half = spare(depth);
	double left = fraction;
	for (int winner : {a, b}) {
		if (winner == b) signs(part, apart(b, a));
		half.clip(part, sides);
		active.push_back(winner);
		for (int k = begin; k < end; ++k)
			if (active[k] != a && active[k] != b) active.push_back(active[k]);
		const double own = winner == a ? half.fraction() : left;
		left -= own;
		settle(half, own, end, depth + 1);
		active.resize(end);
	}
}

} // namespace hexmembrane
