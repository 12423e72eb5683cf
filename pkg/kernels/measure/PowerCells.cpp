// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/measure/PowerCells.hpp"

#include "kernels/base/Check.hpp"
#include "kernels/measure/FacetCycles.hpp"

#include <algorithm>
#include <cmath>

namespace hexmembrane {

namespace {

/// Facets of a tetrahedron by the corner opposite to them, outward.
constexpr int outward[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

void check(const std::vector<PowerSite>& grains, const Enclosure& enclosure)
{
	if (grains.empty()) reject("grains", 0, "are no grains", "one at least");
	for (std::size_t i = 0; i < grains.size(); ++i) requirePositive("radii[" + std::to_string(i) + "]", grains[i].radius, "m");
	requirePositive("radius", enclosure.radius, "m");
	requireFinite("bottom", enclosure.bottom, "m");
	if (!(enclosure.bottom < enclosure.top))
		reject("bottom", enclosure.bottom, "not below top = " + formatNumber(enclosure.top), "the lower face's height first");
	if (enclosure.centres.size() != enclosure.inner.size())
		reject("inner", int(enclosure.inner.size()), "is not the number of centres", "one point of the surface for each sphere");
}

} // namespace

PowerCells::PowerCells(const std::vector<PowerSite>& grains, const Enclosure& enclosure)
    : grainCount(static_cast<int>(grains.size())), tubeCount(static_cast<int>(enclosure.inner.size())), low(enclosure.bottom), high(enclosure.top)
{
	check(grains, enclosure);
	std::vector<PowerSite> sites = grains;
	for (const Vec3& centre : enclosure.centres) sites.push_back({centre, enclosure.radius});
	for (const PowerSite& grain : grains) place.push_back(grain.centre);
	place.insert(place.end(), enclosure.inner.begin(), enclosure.inner.end());
	listFeet(sites);
	const PowerTriangulation all = triangulate(sites, grainCount);
	select(all, enclosure);
	share(sites, all);
	listNeighbours();
}

// Grains that may be the nearest to a face: their images behind it are sites, their projections on it are corners.
void PowerCells::listFeet(std::vector<PowerSite>& sites)
{
	double largest = 0;
	for (int i = 0; i < grainCount; ++i) largest = std::max(largest, sites[i].radius);
	for (int side : {-1, 1}) {
		const double face = side < 0 ? low : high;
		for (int i = 0; i < grainCount; ++i) {
			const Vec3 x = sites[i].centre;
			if (std::abs(x[2] - face) > sites[i].radius + 2 * largest) continue;
			footOf.push_back(i);
			sites.push_back({Vec3(x[0], x[1], 2 * face - x[2]), sites[i].radius});
			place.emplace_back(x[0], x[1], face);
		}
		if (side < 0) lowerFeet = footOf.size();
	}
}

void PowerCells::select(const PowerTriangulation& all, const Enclosure& enclosure)
{
	const int count = static_cast<int>(all.tetrahedra.size());
	std::vector<char> within(count);
	for (int t = 0; t < count; ++t) {
		const auto& c = all.tetrahedra[t];
		// Tetrahedra of the tube's points alone lie outside, in hollows of the tube; those that do not are filled in below.
		const bool soil = !std::all_of(c.begin(), c.end(), [&](int corner) { return isTube(corner); });
		const int side = beyond(c[0]);
		const bool outside = side != 0 && std::all_of(c.begin(), c.end(), [&](int corner) { return beyond(corner) == side; });
		within[t] = soil && !outside;
	}
	std::vector<Facet> open;
	const auto add = [&](std::array<int, 3> c, int times) {
		const int side = beyond(c[0]);
		if (side == 0 || beyond(c[1]) != side || beyond(c[2]) != side) open.push_back({c, times});
	};
	for (const auto& t : enclosure.triangles) add({grainCount + t[0], grainCount + t[1], grainCount + t[2]}, 1);
	for (int t = 0; t < count; ++t) {
		if (!within[t]) continue;
		const auto& c = all.tetrahedra[t];
		mesh.push_back({c, 1});
		for (int k = 0; k < 4; ++k)
			if (all.beside[t][k] < 0 || !within[all.beside[t][k]]) add({c[outward[k][0]], c[outward[k][1]], c[outward[k][2]]}, -1);
	}
	const auto filling = fillCycles(sumOf(std::move(open)), [this](int corner) { return beyond(corner); });
	filledIn = static_cast<int>(filling.size());
	for (const auto& one : filling) mesh.push_back({one.corners, one.times});
}

void PowerCells::share(const std::vector<PowerSite>& sites, const PowerTriangulation& all)
{
	CellShares cells(sites, all.starts, all.neighbours, low, high);
	std::vector<int> at(place.size(), 0);
	// A walk cannot start at a grain within others, which has no neighbours.
	const auto isAlone = [&](int grain) { return all.starts[grain] == all.starts[grain + 1]; };
	int start = 0;
	while (start + 1 < grainCount && isAlone(start)) ++start;
	for (int i = 0; i < grainCount; ++i) at[i] = isAlone(i) ? start : i;
	for (std::size_t f = 0; f < footOf.size(); ++f) at[grainCount + tubeCount + f] = at[footOf[f]];
	// the walk of a tube's point starts at a grain beside it
	for (const auto& t : mesh)
		for (int grain : t.corners)
			if (grain < grainCount)
				for (int corner : t.corners)
					if (isTube(corner)) at[corner] = at[grain];
	for (std::size_t c = 0; c < place.size(); ++c) at[c] = cells.cellAt(place[c], at[c]);
	volume.assign(grainCount, 0);
	shareStarts.assign(1, 0);
	for (const auto& t : mesh) {
		const auto& c = t.corners;
		const std::array<Vec3, 4> x{place[c[0]], place[c[1]], place[c[2]], place[c[3]]};
		cells.divide(x, {at[c[0]], at[c[1]], at[c[2]], at[c[3]]}, shares);
		const double whole = t.times * (x[1] - x[0]).dot((x[2] - x[0]).cross(x[3] - x[0])) / 6;
		for (std::size_t s = shareStarts.back(); s < shares.size(); ++s) volume[shares[s].site] += shares[s].fraction * whole;
		shareStarts.push_back(static_cast<int>(shares.size()));
	}
	// what parts that cancel leave of an escaped grain's cell is rounding
	for (int i = 0; i < grainCount; ++i)
		if (std::abs(volume[i]) < 1e-9 * std::pow(sites[i].radius, 3)) volume[i] = 0;
}

void PowerCells::listNeighbours()
{
	std::vector<std::vector<int>> beside(grainCount);
	for (const auto& t : mesh)
		for (int a : t.corners)
			for (int b : t.corners) {
				if (a == b || a >= grainCount || b >= grainCount) continue;
				if (std::find(beside[a].begin(), beside[a].end(), b) == beside[a].end()) beside[a].push_back(b);
			}
	firstNeighbour.assign(1, 0);
	for (const auto& list : beside) {
		meshNeighbour.insert(meshNeighbour.end(), list.begin(), list.end());
		firstNeighbour.push_back(static_cast<int>(meshNeighbour.size()));
	}
}

std::vector<Mat3> PowerCells::gradients(const std::vector<Vec3>& grains, const std::vector<Vec3>& inner, double bottom, double top) const
{
	if (int(grains.size()) != grainCount)
		reject("grains", int(grains.size()), "is not the number of grains", std::to_string(grainCount) + " displacements");
	if (int(inner.size()) != tubeCount)
		reject("inner", int(inner.size()), "is not the number of the tube's points", std::to_string(tubeCount) + " displacements");
	std::vector<Vec3> moved = grains;
	moved.insert(moved.end(), inner.begin(), inner.end());
	for (std::size_t f = 0; f < footOf.size(); ++f) moved.emplace_back(grains[footOf[f]][0], grains[footOf[f]][1], f < lowerFeet ? bottom : top);
	std::vector<Mat3> integral(grainCount, Mat3::Zero());
	for (std::size_t t = 0; t < mesh.size(); ++t) {
		const auto& c = mesh[t].corners;
		const Vec3 b = place[c[1]] - place[c[0]], d = place[c[2]] - place[c[0]], e = place[c[3]] - place[c[0]];
		// volume times gradient has no division: a flat tetrahedron is no special case
		const Mat3 whole = mesh[t].times / 6. *
		                   ((moved[c[1]] - moved[c[0]]) * d.cross(e).transpose() + (moved[c[2]] - moved[c[0]]) * e.cross(b).transpose() +
		                    (moved[c[3]] - moved[c[0]]) * b.cross(d).transpose());
		for (int s = shareStarts[t]; s < shareStarts[t + 1]; ++s) integral[shares[s].site] += shares[s].fraction * whole;
	}
	return integral;
}

} // namespace hexmembrane
