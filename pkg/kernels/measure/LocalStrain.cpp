// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/measure/LocalStrain.hpp"

#include <Eigen/LU>

#include <limits>

namespace hexmembrane {

StrainInvariants invariantsOf(const Mat3& gradient)
{
	const Mat3 strain = 0.5 * (gradient + gradient.transpose());
	const double volumetric = strain.trace();
	const Mat3 deviator = strain - volumetric / 3 * Mat3::Identity();
	return {volumetric, std::sqrt(2. / 3) * deviator.norm(),
	        0.5 * Vec3(gradient(2, 1) - gradient(1, 2), gradient(0, 2) - gradient(2, 0), gradient(1, 0) - gradient(0, 1))};
}

std::vector<double> nonAffine(const std::vector<Vec3>& x, const std::vector<Vec3>& u, const std::vector<int>& starts, const std::vector<int>& neighbours)
{
	std::vector<double> left(x.size(), std::numeric_limits<double>::quiet_NaN());
	for (std::size_t i = 0; i < x.size(); ++i) {
		Mat3 spread = Mat3::Zero(), with = Mat3::Zero();
		for (int k = starts[i]; k < starts[i + 1]; ++k) {
			const Vec3 dx = x[neighbours[k]] - x[i];
			spread += dx * dx.transpose();
			with += (u[neighbours[k]] - u[i]) * dx.transpose();
		}
		// the determinant of a sum of squares against that of as much spread evenly
		const double even = spread.trace() / 3;
		if (!(spread.determinant() > 1e-9 * even * even * even)) continue;
		const Mat3 fit = with * spread.inverse();
		double sum = 0;
		for (int k = starts[i]; k < starts[i + 1]; ++k) sum += (u[neighbours[k]] - u[i] - fit * (x[neighbours[k]] - x[i])).squaredNorm();
		left[i] = sum / (starts[i + 1] - starts[i]);
	}
	return left;
}

} // namespace hexmembrane
