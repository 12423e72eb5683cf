// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/membrane/HexStencil.hpp"
#include "kernels/base/Vec3.hpp"

#include <vector>

namespace hexmembrane {

/// A vector at every particle (or bond) of a ring stencil, as three flat arrays of padded rows: the first element of a ring stands again behind its last
/// and the last before its first, so that `x[i - 1]` and `x[i + 1]` are neighbours everywhere and a loop over a row has neither index lists nor
/// branches. Call wrap() on a row after writing it.
class PaddedRings {
public:
	PaddedRings() = default;
	PaddedRings(int perRing, int rows) : n(perRing), stride(perRing + 2), data(3 * size_t(stride) * rows, 0.), plane(size_t(stride) * rows) {}

	int rows() const { return n > 0 ? int(plane / stride) : 0; }
	bool fits(int perRing, int rows) const { return n == perRing && data.size() == 3 * size_t(perRing + 2) * rows; }

	double* row(int axis, int k) { return data.data() + axis * plane + size_t(k) * stride + 1; }
	const double* row(int axis, int k) const { return data.data() + axis * plane + size_t(k) * stride + 1; }

	void set(int k, int i, const Vec3& v)
	{
		for (int a = 0; a < 3; ++a) row(a, k)[i] = v[a];
	}
	Vec3 get(int k, int i) const { return {row(0, k)[i], row(1, k)[i], row(2, k)[i]}; }
	/// All of them, row after row.
	std::vector<Vec3> vectors() const
	{
		std::vector<Vec3> all;
		all.reserve(size_t(n) * rows());
		for (int k = 0; k < rows(); ++k)
			for (int i = 0; i < n; ++i) all.push_back(get(k, i));
		return all;
	}

	/// Repeats the ends of row k beyond each other.
	void wrap(int k)
	{
		for (int a = 0; a < 3; ++a) {
			double* r = row(a, k);
			r[-1] = r[n - 1];
			r[n] = r[0];
		}
	}

private:
	int n = 0, stride = 0;
	std::vector<double> data;
	size_t plane = 0;
};

} // namespace hexmembrane
