// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <algorithm>

namespace hexmembrane {

/// One correction of an integral controller that multiplies a load by a factor so that `measured` comes to `target`:
/// f -> f + gain (target - measured)/target, kept within low and high. A target of 0 leaves it.
/// \param gain time since the last correction over the time constant (-)
/// \param saturated whether the factor would have gone beyond its limits
inline double correctedFactor(double factor, double gain, double target, double measured, double low, double high, bool& saturated)
{
	if (target == 0) return factor;
	const double wanted = factor + gain * (target - measured) / target, kept = std::min(std::max(wanted, low), high);
	saturated = kept != wanted;
	return kept;
}

} // namespace hexmembrane
