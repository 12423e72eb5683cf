// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/measure/BandMoments.hpp"

namespace hexmembrane {

/// Rows of numbers, one a grain of BandColumns, and their sums with the powers and with waves: cos of whole half turns over the box round the grains, a tenth
/// wider, in x, y and z. The waves are those of least wave number, without the constant.
class BandWaves {
public:
	static constexpr int count = 160;
	/// \param columns referred to, must outlive this
	explicit BandWaves(const BandColumns& columns);
	BandWaves(const BandWaves&) = delete;

	using Row = std::vector<double>;
	/// The sums of a row with the powers, then with the waves.
	Eigen::VectorXd sums(const Row& row) const;
	/// A power, or after them a wave, of all grains.
	Row function(int number) const;
	/// Variances of the waves' factors, 1 together, for motion that is correlated as exp(-r^2/(2 length^2)).
	Eigen::VectorXd variances(double length) const;

private:
	/// Functions with a common factor.
	struct Group {
		Row factor;
		std::vector<const double*> others;
		std::vector<int> numbers; // of the functions
	};
	std::vector<Row> heights; // cosines over the height
	std::vector<Group> groups;
	std::vector<double> squares, sizes; // of the waves: wave number squared (1/m2), 1 over the mean square
	std::size_t filled;
};

/// Profiles of a plane, not weighted. With a = sqrt(6) s/t: erf(a)/2, and a exp(-a^2), by which the step changes when its thickness does.
struct BandSteps {
	BandWaves::Row step, shape;
};
BandSteps bandSteps(const BandColumns& columns, const BandPlane& plane);

/// Sum of the products of two rows.
double bandProduct(const BandWaves::Row& a, const BandWaves::Row& b);
/// Products of two rows, grain by grain.
BandWaves::Row bandTimes(const BandWaves::Row& a, const BandWaves::Row& b);

} // namespace hexmembrane
