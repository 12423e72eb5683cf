// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/base/Vec3.hpp"

namespace hexmembrane {

/// Where a sphere is (m): half a cache line, read as four numbers at once.
struct alignas(32) Place {
	Vec3 centre;
	double radius;
};

/// Spheres where the caller has them. Their order may change from call to call; their ids name them.
struct SphereRows {
	const Place* places = nullptr;
	const int* ids = nullptr;
	int count = 0;
};

/// How far spheres have gone at most: none by more than the difference of two values of `way` (m), while `order` is the same and not negative, and with it
/// the order of their rows.
struct Travel {
	long order = -1; ///< -1: not known
	double way = 0;
};

} // namespace hexmembrane
