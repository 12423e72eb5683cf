// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/measure/FacetCycles.hpp"

#include "kernels/base/Check.hpp"

#include <algorithm>
#include <map>
#include <numeric>

namespace hexmembrane {

namespace {

// Rising corners; an odd exchange turns the facet.
Facet sorted(Facet facet)
{
	auto& c = facet.corners;
	for (auto [a, b] : {std::pair{0, 1}, {1, 2}, {0, 1}})
		if (c[a] > c[b]) {
			std::swap(c[a], c[b]);
			facet.times = -facet.times;
		}
	return facet;
}

struct Edge {
	int times = 0, facet = -1; // the first facet at it
};

// The facet's group after others were joined.
int groupOf(std::vector<int>& parent, int facet)
{
	while (parent[facet] != facet) facet = parent[facet] = parent[parent[facet]];
	return facet;
}

} // namespace

std::vector<Facet> sumOf(std::vector<Facet> facets)
{
	for (Facet& facet : facets) facet = sorted(facet);
	std::sort(facets.begin(), facets.end(), [](const Facet& a, const Facet& b) { return a.corners < b.corners; });
	std::vector<Facet> sum;
	for (const Facet& facet : facets) {
		if (!sum.empty() && sum.back().corners == facet.corners)
			sum.back().times += facet.times;
		else
			sum.push_back(facet);
	}
	sum.erase(std::remove_if(sum.begin(), sum.end(), [](const Facet& facet) { return facet.times == 0; }), sum.end());
	return sum;
}

std::vector<Filling> fillCycles(const std::vector<Facet>& facets, const std::function<int(int)>& beyond)
{
	std::vector<int> parent(facets.size());
	std::iota(parent.begin(), parent.end(), 0);
	std::map<std::pair<int, int>, Edge> edges;
	for (int f = 0; f < static_cast<int>(facets.size()); ++f)
		for (int k = 0; k < 3; ++k) {
			const int a = facets[f].corners[k], b = facets[f].corners[(k + 1) % 3];
			Edge& edge = edges[std::minmax(a, b)];
			edge.times += a < b ? facets[f].times : -facets[f].times;
			if (edge.facet < 0)
				edge.facet = f;
			else
				parent[groupOf(parent, f)] = groupOf(parent, edge.facet);
		}
	// A cycle that was cut open beyond an end is joined to a corner there: what that adds lies beyond the end as well.
	std::vector<int> apex(facets.size(), -1);
	for (const auto& [ends, edge] : edges) {
		if (edge.times == 0) continue;
		int& of = apex[groupOf(parent, edge.facet)];
		const int side = beyond(ends.first);
		if (side == 0 || beyond(ends.second) != side || (of >= 0 && beyond(of) != side))
			fail("triangles", double(ends.first), "is a corner at which the tube is open between the faces",
			     "a tube that goes from below the lower face to above the upper one");
		if (of < 0) of = ends.first;
	}
	std::vector<Filling> found;
	for (int f = 0; f < static_cast<int>(facets.size()); ++f) {
		int& of = apex[groupOf(parent, f)];
		const auto& c = facets[f].corners;
		if (of < 0) of = c[0];
		if (of != c[0] && of != c[1] && of != c[2]) found.push_back({{of, c[0], c[1], c[2]}, facets[f].times});
	}
	return found;
}

} // namespace hexmembrane
