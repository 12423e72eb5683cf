// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/base/Vec3.hpp"

#include <array>
#include <vector>

namespace hexmembrane {

/// A triangulated surface whose vertices move. Triangles are counter-clockwise seen from the side where the pressure acts (outside).
/// Loops run over triangles and then over vertices, each writing its own entries only, always in the same order: results do not depend on the number
/// of threads, to the last bit.
class TriangleMesh {
public:
	TriangleMesh() = default;
	/// \throws std::invalid_argument when an index is outside 0 .. vertexCount - 1 or a triangle names a vertex twice
	TriangleMesh(int vertexCount, std::vector<std::array<int, 3>> triangles);

	int vertexCount() const { return static_cast<int>(start.size()) - 1; }
	int triangleCount() const { return static_cast<int>(triangles.size()); }

	/// Twice the area vector of each triangle, (b - a) x (c - a).
	void areaVectors(const std::vector<Vec3>& x, std::vector<Vec3>& out) const;
	/// Calls use(vertex, sum of `perTriangle` over the triangles round it) for every vertex, in parallel: what is done with a sum is done while it is at hand.
	template <typename Use>
	void forEachVertexSum(const std::vector<Vec3>& perTriangle, const Use& use) const
	{
		const long count = vertexCount();
#pragma omp parallel for schedule(static)
		for (long v = 0; v < count; ++v) {
			Vec3 sum = Vec3::Zero();
			for (int e = start[v]; e < start[v + 1]; ++e) sum += perTriangle[around[e]];
			use(v, sum);
		}
	}
	/// Sum over the triangles round each vertex.
	void sumAtVertices(const std::vector<Vec3>& perTriangle, std::vector<Vec3>& out) const;
	/// Sum of a number per triangle over the triangles round each vertex.
	void sumAtVertices(const std::vector<double>& perTriangle, std::vector<double>& out) const;

private:
	std::vector<std::array<int, 3>> triangles;
	std::vector<int> start = {0}; ///< first entry of `around` of each vertex, and one past the last
	std::vector<int> around;      ///< triangles round each vertex, ascending
};

/// Follower pressure on a triangulated surface, acting on the surface itself or on a parallel one `offset` further in.
///
/// A triangle (a, b, c) under pressure p from outside gives each of its vertices -p/6 (b - a) x (c - a): Eqs. 3-5 of the source study (p A n, one third to
/// each vertex, summed over the triangles of a vertex), written without a square root, so that a degenerate triangle gives exactly 0. With offset 0
/// on a closed surface this is -p dV/dx of every vertex; resultant and moment vanish.
///
/// With offset d > 0 the triangles are those of the surface that is reached by moving every vertex by d against its outward vertex normal (the normalised
/// sum of the area vectors round it). Particles of radius d touch the soil there, not at their centres: on a cylinder the centres' surface would
/// transmit p Rc/(Rc - d). The resultant on a closed surface still vanishes; the forces act at the centres, so a moment of the order d times the
/// tangential part of the force remains (zero by symmetry on a tube).
class PressureForce {
public:
	PressureForce() = default;
	/// \param offset distance of the loaded surface inwards from the vertices (m), >= 0
	PressureForce(TriangleMesh mesh, double offset);

	/// Forces (N) on all vertices at positions x. `area` of the last call follows.
	void compute(double pressure, const std::vector<Vec3>& x, std::vector<Vec3>& force);

	/// Third of the area of the triangles round each vertex, on the loaded surface, after compute() (m2).
	void vertexAreas(std::vector<double>& out) const;
	/// Outward unit normals of the vertices; zero where the triangles round a vertex cancel. Available after compute() when offset > 0 (else filled here).
	void vertexNormals(std::vector<Vec3>& out) const;

	const TriangleMesh& surface() const { return mesh; }

private:
	TriangleMesh mesh;
	double offset = 0;
	std::vector<Vec3> twiceArea, normals, inner; ///< work arrays
};

/// Normalises in place; a zero vector stays zero.
void normaliseAll(std::vector<Vec3>& vectors);

} // namespace hexmembrane
