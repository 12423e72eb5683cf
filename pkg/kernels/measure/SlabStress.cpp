// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/measure/SlabStress.hpp"

#include "kernels/base/Check.hpp"

#include <algorithm>

namespace hexmembrane {

SlabStress::SlabStress(std::vector<double> borders) : edges(std::move(borders))
{
	if (edges.size() < 2) reject("edges", int(edges.size()), "are no slab", "the heights of two borders at least");
	for (std::size_t k = 0; k < edges.size(); ++k) {
		requireFinite("edges[" + std::to_string(k) + "]", edges[k], "m");
		if (k > 0 && !(edges[k] > edges[k - 1]))
			reject("edges[" + std::to_string(k) + "]", edges[k], "is not above the one before", "give the borders of the slabs from below");
	}
	inSlab.assign(edges.size() - 1, Mat3::Zero());
}

void SlabStress::add(const Vec3& start, const Vec3& branch, const Vec3& force)
{
	const Mat3 whole = force * branch.transpose();
	const double from = std::min(start[2], start[2] + branch[2]), length = std::abs(branch[2]);
	const std::size_t slabs = inSlab.size();
	// the slab of the lower end; end slabs take what is beyond
	std::size_t s = std::upper_bound(edges.begin() + 1, edges.end() - 1, from) - (edges.begin() + 1);
	double done = 0;
	for (; s + 1 < slabs && from + length > edges[s + 1]; ++s) {
		const double share = (edges[s + 1] - from) / length;
		inSlab[s] += (share - done) * whole;
		done = share;
	}
	inSlab[s] += (1 - done) * whole;
}

Mat3 SlabStress::total() const
{
	Mat3 sum = Mat3::Zero();
	for (const Mat3& one : inSlab) sum += one;
	return sum;
}

} // namespace hexmembrane
