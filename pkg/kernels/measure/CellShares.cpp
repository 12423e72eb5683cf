// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/measure/CellShares.hpp"

#include <algorithm>

namespace hexmembrane {

namespace {

constexpr int planes = 2;
// Less of a tetrahedron than this is given away undivided: rounding, not geometry.
constexpr double negligible = 1e-16;

} // namespace

CellShares::CellShares(const std::vector<PowerSite>& theSites, const std::vector<int>& theStarts, const std::vector<int>& theNeighbours, double low, double high)
        : sites(theSites), starts(theStarts), neighbours(theNeighbours), bottom(low), top(high)
{
	const std::size_t count = starts.size() - 1;
	level.reserve(count);
	for (std::size_t i = 0; i < count; ++i) level.push_back(sites[i].centre.squaredNorm() - sites[i].radius * sites[i].radius);
	seenBy.assign(count, 0);
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

bool CellShares::mayOwn(int candidate) const
{
	const auto& mine = atCorner[candidate];
	for (int c = 0; c < candidate; ++c) {
		const auto& theirs = atCorner[c];
		if (theirs[0] <= mine[0] && theirs[1] <= mine[1] && theirs[2] <= mine[2] && theirs[3] <= mine[3]) return false;
	}
	return true;
}

// A point is in the cell of the site that no neighbour undercuts. So once the neighbours of all candidates have been looked at, no cell is missing.
void CellShares::gather(const std::array<Vec3, 4>& x, const std::array<int, 4>& at)
{
	candidates.clear();
	atCorner.clear();
	++turn;
	const auto look = [&](int site) {
		if (seenBy[site] == turn) return;
		seenBy[site] = turn;
		atCorner.push_back({power(site, x[0]), power(site, x[1]), power(site, x[2]), power(site, x[3])});
		if (mayOwn(static_cast<int>(atCorner.size()) - 1))
			candidates.push_back(site);
		else
			atCorner.pop_back();
	};
	for (int site : at) look(site);
	for (std::size_t c = 0; c < candidates.size(); ++c)
		for (int k = starts[candidates[c]], end = starts[candidates[c] + 1]; k < end; ++k) look(neighbours[k]);
}

void CellShares::divide(const std::array<Vec3, 4>& x, const std::array<int, 4>& at, std::vector<Share>& out)
{
	const bool oneCell = at[0] == at[1] && at[0] == at[2] && at[0] == at[3]; // cells are convex
	const bool uncut = std::all_of(x.begin(), x.end(), [&](const Vec3& c) { return c[2] >= bottom && c[2] <= top; });
	if (oneCell && uncut) {
		out.push_back({at[0], 1});
		return;
	}
	if (oneCell) {
		candidates = {at[0]};
		atCorner.assign(1, {0, 0, 0, 0});
	} else
		gather(x, at);
	const int count = static_cast<int>(candidates.size());
	width = planes + count;
	values.resize(4 * width);
	corners = 4;
	for (int k = 0; k < 4; ++k) {
		double* to = row(k);
		to[0] = x[k][2] - bottom;
		to[1] = top - x[k][2];
		for (int c = 0; c < count; ++c) to[planes + c] = atCorner[c][k];
	}
	owned.assign(count, 0);
	active.resize(count);
	for (int c = 0; c < count; ++c) active[c] = c;
	if (uncut)
		settle({0, 1, 2, 3}, 1, 0, count);
	else
		cut({0, 1, 2, 3}, 1, 0);
	for (int c = 0; c < count; ++c)
		if (owned[c] > 0) out.push_back({candidates[c], owned[c]});
}

int CellShares::between(const Crossing& crossing, const Corners& of)
{
	if (values.size() < std::size_t(corners + 1) * width) values.resize(2 * std::size_t(corners + 1) * width);
	const double *a = row(of[crossing.from]), *b = row(of[crossing.to]);
	double* to = row(corners);
	for (int i = 0; i < width; ++i) to[i] = a[i] + crossing.share * (b[i] - a[i]);
	return corners++;
}

// Drops what lies beyond the two planes.
void CellShares::cut(Corners of, double part, int plane)
{
	if (plane == planes) {
		const int begin = static_cast<int>(active.size()), count = width - planes;
		for (int c = 0; c < count; ++c) active.push_back(c);
		settle(of, part, begin, begin + count);
		active.resize(begin);
		return;
	}
	int within = -1, beyond = -1;
	for (int k = 0; k < 4; ++k) {
		const double side = row(of[k])[plane];
		if (side > 0) within = k;
		if (side < 0) beyond = k;
	}
	if (within < 0) return; // nothing, or a face on the plane
	if (beyond < 0) return cut(of, part, plane + 1);
	const double in = row(of[within])[plane], out = row(of[beyond])[plane], share = in / (in - out);
	const int kept = corners, middle = between({within, beyond, share}, of);
	row(middle)[plane] = 0;
	Corners near = of, far = of;
	near[beyond] = middle;
	far[within] = middle;
	cut(near, part * share, plane);
	cut(far, part * (1 - share), plane);
	corners = kept;
}

// Compares the first candidate of the list with the others until one is left, or a border is found that crosses an edge.
void CellShares::settle(Corners of, double part, int begin, int end)
{
	const double* values4[4] = {row(of[0]) + planes, row(of[1]) + planes, row(of[2]) + planes, row(of[3]) + planes};
	int rival = -1;
	for (int k = begin + 1; k < end;) {
		const int a = active[begin], b = active[k];
		bool aWins = false, bWins = false;
		for (const double* v : values4) {
			aWins |= v[a] < v[b];
			bWins |= v[b] < v[a];
		}
		if (aWins && bWins) {
			if (rival < 0) rival = k;
			++k;
			continue;
		}
		if (bWins) {
			active[begin] = b;
			active[k] = active[--end];
			rival = -1;
			k = begin + 1; // those that stood up to the former first meet this one
		} else
			active[k] = active[--end];
	}
	const int a = active[begin];
	if (rival < 0 || part < negligible) {
		owned[a] += part;
		return;
	}
	const int b = active[rival];
	int mine = 0, theirs = 0;
	for (int k = 0; k < 4; ++k) {
		const double* v = values4[k];
		if (v[a] < v[b]) mine = k;
		if (v[b] < v[a]) theirs = k;
	}
	const double ahead = values4[mine][b] - values4[mine][a], behind = values4[theirs][a] - values4[theirs][b], share = ahead / (ahead + behind);
	const int kept = corners, middle = between({mine, theirs, share}, of);
	row(middle)[planes + b] = row(middle)[planes + a]; // on the border exactly: this edge is not divided again
	const int list = static_cast<int>(active.size());
	const auto half = [&](int replaced, double fraction) {
		for (int k = begin; k < end; ++k) active.push_back(active[k]);
		Corners child = of;
		child[replaced] = middle;
		settle(child, part * fraction, list, static_cast<int>(active.size()));
		active.resize(list);
	};
	half(theirs, share);
	half(mine, 1 - share);
	corners = kept;
}

} // namespace hexmembrane
