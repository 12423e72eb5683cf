// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

namespace hexmembrane {

/// Smallest value that, with those below it, has half of the weight. What has more than half of the weight decides alone, whatever the rest is like.
/// \param valued pairs of value and weight, weights >= 0 \return NaN without any weight
inline double weightedMedian(std::vector<std::pair<double, double>> valued)
{
	std::sort(valued.begin(), valued.end());
	double total = 0, sum = 0;
	for (const auto& [value, weight] : valued) total += weight;
	for (const auto& [value, weight] : valued)
		if ((sum += weight) > 0 && 2 * sum >= total) return value;
	return std::numeric_limits<double>::quiet_NaN();
}

} // namespace hexmembrane
