// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/base/Vec3.hpp"

#include <array>
#include <vector>

namespace hexmembrane {

/// Which points between the ends of a triangulated tube of rings are inside it. Three looks, each for what the one before leaves open: is no triangle
/// between the axis and the point; is it half a longest edge and more below the surface's tangent plane at the particle nearest to it; do the triangles'
/// solid angles add up to a full sphere. A grain in its place is seen by the first two.
class TubeInside {
public:
	/// \param triangles outward oriented \param x particles from the lower ring to the upper one (m); both are referred to, not copied
	TubeInside(int perRing, const std::vector<std::array<int, 3>>& triangles, const std::vector<Vec3>& x);

	bool inside(const Vec3& point) const;

	/// Surely inside, since the point is so near to the axis. A horizontal line from the axis meets the triangles of a band of two rings at heights that the
	/// band reaches; points of a triangle of longest edge L and nearest corner rho from the axis are at least sqrt(rho^2 - L^2/2) from it.
	bool nearAxis(const Vec3& point) const;

	/// By solid angles, 2 atan2(a.(b x c), abc + (a.b)c + (b.c)a + (c.a)b), the ends closed by fans: 4 pi inside, 0 outside, whatever the folds.
	/// A. Van Oosterom, J. Strackee, The solid angle of a plane triangle, IEEE Trans. Biomed. Eng. 30, 1983.
	bool bySolidAngle(const Vec3& point) const;

private:
	/// Two neighbouring rings: heights that they reach (m), squared distance from the axis that is free of triangles (m2).
	struct Band {
		double low, high, free;
	};
	struct Ring {
		double low, high;
	};
	int nearest(const Vec3& point) const;

	int perRing;
	const std::vector<std::array<int, 3>>& triangles;
	const std::vector<Vec3>& x;
	double axis[2] = {0, 0};
	double longest = 0; ///< squared length of the longest edge (m2)
	std::vector<Ring> rings;
	std::vector<Band> bands;
	std::vector<Vec3> normals; ///< unit normals at the particles, weighted by area
};

} // namespace hexmembrane
