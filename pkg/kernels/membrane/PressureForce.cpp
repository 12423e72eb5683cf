// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/membrane/PressureForce.hpp"

#include "kernels/base/Check.hpp"

#include <cmath>

namespace hexmembrane {

TriangleMesh::TriangleMesh(int vertexCount, std::vector<std::array<int, 3>> tris) : triangles(std::move(tris)), start(vertexCount + 1, 0)
{
	for (size_t t = 0; t < triangles.size(); ++t) {
		const auto& v = triangles[t];
		const auto name = "triangles[" + std::to_string(t) + "]";
		for (int corner : v)
			if (corner < 0 || corner >= vertexCount)
				reject(name, corner, "no such vertex", "indices from 0 to " + std::to_string(vertexCount - 1) + " into ids");
		if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) reject(name, v[0] == v[1] ? v[0] : v[2], "the same vertex twice", "three different vertices");
		for (int corner : v) ++start[corner + 1];
	}
	for (int v = 0; v < vertexCount; ++v) start[v + 1] += start[v];
	around.resize(start.back());
	std::vector<int> next(start.begin(), start.end() - 1);
	for (size_t t = 0; t < triangles.size(); ++t)
		for (int corner : triangles[t]) around[next[corner]++] = static_cast<int>(t);
}

void TriangleMesh::areaVectors(const std::vector<Vec3>& x, std::vector<Vec3>& out) const
{
	out.resize(triangles.size());
	const long count = static_cast<long>(triangles.size());
#pragma omp parallel for schedule(static)
	for (long t = 0; t < count; ++t) {
		const auto& v = triangles[t];
		const Vec3& a = x[v[0]];
		out[t] = (x[v[1]] - a).cross(x[v[2]] - a);
	}
}

void TriangleMesh::sumAtVertices(const std::vector<Vec3>& in, std::vector<Vec3>& out) const
{
	out.resize(vertexCount());
	forEachVertexSum(in, [&](long v, const Vec3& sum) { out[v] = sum; });
}

void TriangleMesh::sumAtVertices(const std::vector<double>& in, std::vector<double>& out) const
{
	out.assign(vertexCount(), 0.);
	for (int v = 0; v < vertexCount(); ++v)
		for (int e = start[v]; e < start[v + 1]; ++e) out[v] += in[around[e]];
}

void normaliseAll(std::vector<Vec3>& vectors)
{
	const long count = static_cast<long>(vectors.size());
#pragma omp parallel for schedule(static)
	for (long i = 0; i < count; ++i) {
		const double length = vectors[i].norm();
		if (length > 0) vectors[i] /= length;
	}
}

PressureForce::PressureForce(TriangleMesh m, double inwards) : mesh(std::move(m)), offset(inwards) { requireNonNegative("offset", inwards, "m"); }

void PressureForce::compute(double pressure, const std::vector<Vec3>& x, std::vector<Vec3>& force)
{
	mesh.areaVectors(x, twiceArea);
	if (offset > 0) {
		normals.resize(x.size());
		inner.resize(x.size());
		mesh.forEachVertexSum(twiceArea, [&](long v, const Vec3& sum) {
			const double length = sum.norm();
			normals[v] = length > 0 ? Vec3(sum / length) : Vec3::Zero();
			inner[v] = x[v] - offset * normals[v];
		});
		mesh.areaVectors(inner, twiceArea);
	}
	const double factor = -pressure / 6;
	force.resize(x.size());
	mesh.forEachVertexSum(twiceArea, [&](long v, const Vec3& sum) { force[v] = factor * sum; });
}

void PressureForce::vertexAreas(std::vector<double>& out) const
{
	std::vector<double> third(twiceArea.size());
	for (size_t t = 0; t < third.size(); ++t) third[t] = twiceArea[t].norm() / 6;
	mesh.sumAtVertices(third, out);
}

void PressureForce::vertexNormals(std::vector<Vec3>& out) const
{
	if (offset > 0) {
		out = normals;
		return;
	}
	mesh.sumAtVertices(twiceArea, out);
	normaliseAll(out);
}

} // namespace hexmembrane
