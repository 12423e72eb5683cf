// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/base/Vec3.hpp"

#include <array>
#include <vector>

namespace hexmembrane {
namespace reference {

/// Eqs. 3-5 of the source study to the letter: each triangle's area and unit normal, a third of sigma3 A n to each vertex, a particle sums its triangles. With
/// offset > 0 the same on the surface that lies that much inside along the vertex normals.
inline std::vector<Vec3> pressureForces(const std::vector<std::array<int, 3>>& triangles, double pressure, const std::vector<Vec3>& x, double offset)
{
	std::vector<Vec3> normal(x.size(), Vec3::Zero()), surface = x, force(x.size(), Vec3::Zero());
	for (const auto& t : triangles) {
		const Vec3 twiceArea = (x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]);
		for (int corner : t) normal[corner] += twiceArea;
	}
	for (size_t i = 0; i < x.size(); ++i)
		if (normal[i].norm() > 0) surface[i] -= offset * normal[i].normalized();
	for (const auto& t : triangles) {
		const Vec3 twiceArea = (surface[t[1]] - surface[t[0]]).cross(surface[t[2]] - surface[t[0]]);
		const double area = 0.5 * twiceArea.norm();
		if (area == 0) continue;
		const Vec3 inward = -twiceArea.normalized();
		for (int corner : t) force[corner] += pressure * area / 3 * inward;
	}
	return force;
}

} // namespace reference
} // namespace hexmembrane
