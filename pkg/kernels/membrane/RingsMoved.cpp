// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/membrane/RingsMoved.hpp"

#include "kernels/base/Simd.hpp"

#include <algorithm>

namespace hexmembrane {

namespace {

/// Largest of the squared distances of two rows of points; NaN when one is not finite.
HEXMEMBRANE_WIDEST double furthestSquared(int n, const double* ax, const double* ay, const double* az, const double* bx, const double* by, const double* bz)
{
	double most = 0, all = 0;
#pragma omp simd reduction(max : most) reduction(+ : all)
	for (int i = 0; i < n; ++i) {
		const double x = ax[i] - bx[i], y = ay[i] - by[i], z = az[i] - bz[i];
		const double square = x * x + y * y + z * z;
		all += square;
		most = std::max(most, square);
	}
	return all - all == 0 ? most : all - all;
}

} // namespace

bool nearerThan(double way, const HexStencil& stencil, const PaddedRings& now, const PaddedRings& then)
{
	const int n = stencil.perRing;
	if (!then.fits(n, stencil.rings)) return false;
	bool holds = true;
#pragma omp parallel for schedule(static) reduction(&& : holds)
	for (int k = 0; k < stencil.rings; ++k)
		holds = holds && furthestSquared(n, now.row(0, k), now.row(1, k), now.row(2, k), then.row(0, k), then.row(1, k), then.row(2, k)) < way * way;
	return holds;
}

} // namespace hexmembrane
