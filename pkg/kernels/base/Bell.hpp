// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/base/Lanes.hpp"

#include <array>

namespace hexmembrane {

/// exp(-t^2) and its integral erf(t) over lanes, both to 3e-16: from a table at multiples of 1/128 and the Taylor series about them.
class Bell {
public:
	Bell()
	{
		for (int k = 0; k <= last; ++k) {
			const double t = k * spacing;
			table[k] = {std::exp(-t * t), std::erf(t)};
		}
	}

	template <class V>
	HEXMEMBRANE_INLINE void at(V t, V& bell, V& integral) const
	{
		const V size = t < 0 ? -t : t, bounded = size < 6 ? size : lanes<V>(6);
		const V near = (bounded * (1 / spacing) + rounding) - rounding;
		V start, before;
		for (int k = 0; k < laneCount<V>; ++k) {
			const auto& entry = table[static_cast<int>(near[k])];
			start[k] = entry[0];
			before[k] = entry[1];
		}
		const V at = near * spacing, d = bounded - at, power = -d * (at + at + d);
		V series = lanes<V>(1);
#pragma GCC unroll 8
		for (int n = 7; n > 0; --n) series = 1 + power * (1. / n) * series;
		bell = start * series;
		// terms of exp(-2 at s - s^2): Hermite polynomials of `at`, by their recurrence; integrated from 0 to d
		V last2 = V{}, term = lanes<V>(1), sum = lanes<V>(1);
#pragma GCC unroll 8
		for (int n = 0; n < 7; ++n) {
			const V next = (-2. / (n + 1)) * d * (at * term + d * last2);
			last2 = term;
			term = next;
			sum += term * (1. / (n + 2));
		}
		const V whole = before + start * d * sum * (2 / std::sqrt(M_PI));
		integral = t < 0 ? -whole : whole;
	}

private:
	static constexpr double spacing = 1. / 128, rounding = 6755399441055744.; // 1.5 * 2^52: a sum with it has no fraction
	static constexpr int last = 6 * 128;
	std::array<std::array<double, 2>, last + 1> table;
};

} // namespace hexmembrane
