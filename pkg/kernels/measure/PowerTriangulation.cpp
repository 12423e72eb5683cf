// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
// The one file that includes CGAL: its headers take most of a minute to compile. CGAL's triangulations are GPL-3.0-or-later.
#include "kernels/measure/PowerTriangulation.hpp"

#include "kernels/base/Check.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Regular_triangulation_3.h>
#include <CGAL/Triangulation_cell_base_with_info_3.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>

#include <algorithm>

namespace hexmembrane {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_3<int, Kernel, CGAL::Regular_triangulation_vertex_base_3<Kernel>>;
using CellBase = CGAL::Triangulation_cell_base_with_info_3<int, Kernel, CGAL::Regular_triangulation_cell_base_3<Kernel>>;
using Regular = CGAL::Regular_triangulation_3<Kernel, CGAL::Triangulation_data_structure_3<VertexBase, CellBase>>;

std::vector<std::pair<Regular::Weighted_point, int>> weighted(const std::vector<PowerSite>& sites, int from, int to)
{
	std::vector<std::pair<Regular::Weighted_point, int>> points;
	points.reserve(to - from);
	for (int i = from; i < to; ++i) {
		const Vec3& x = sites[i].centre;
		if (!x.allFinite() || !std::isfinite(sites[i].radius))
			reject("sites[" + std::to_string(i) + "]", x.norm(), "is not finite", "finite centres and radii (m)");
		points.emplace_back(Regular::Weighted_point(Kernel::Point_3(x[0], x[1], x[2]), sites[i].radius * sites[i].radius), i);
	}
	return points;
}

void listNeighbours(const Regular& regular, int sites, PowerTriangulation& out)
{
	std::vector<int> count(sites + 1, 0);
	const auto eachEdge = [&](auto&& take) {
		for (const auto& edge : regular.finite_edges()) {
			const int a = edge.first->vertex(edge.second)->info(), b = edge.first->vertex(edge.third)->info();
			take(a, b);
			take(b, a);
		}
	};
	eachEdge([&](int a, int) { ++count[a + 1]; });
	for (int i = 0; i < sites; ++i) count[i + 1] += count[i];
	out.starts = count;
	out.neighbours.resize(count[sites]);
	eachEdge([&](int a, int b) { out.neighbours[count[a]++] = b; });
	// CGAL lists edges in an order that depends on addresses in memory: sums over neighbours would differ from run to run in their last bit
	for (int i = 0; i < sites; ++i) std::sort(out.neighbours.begin() + out.starts[i], out.neighbours.begin() + out.starts[i + 1]);
}

} // namespace

PowerTriangulation triangulate(const std::vector<PowerSite>& sites, int first)
{
	PowerTriangulation out;
	const int all = static_cast<int>(sites.size());
	const auto foremost = weighted(sites, 0, first), others = weighted(sites, first, all);
	Regular regular(foremost.begin(), foremost.end());
	listNeighbours(regular, first, out);
	regular.insert(others.begin(), others.end());
	if (regular.dimension() < 3) return out;
	for (auto cell : regular.all_cell_handles()) cell->info() = -1;
	int number = 0;
	for (auto cell : regular.finite_cell_handles()) cell->info() = number++;
	out.tetrahedra.reserve(number);
	out.beside.reserve(number);
	for (auto cell : regular.finite_cell_handles()) {
		std::array<int, 4> corners, beside;
		for (int k = 0; k < 4; ++k) {
			corners[k] = cell->vertex(k)->info();
			beside[k] = cell->neighbor(k)->info();
		}
		out.tetrahedra.push_back(corners);
		out.beside.push_back(beside);
	}
	return out;
}

} // namespace hexmembrane
