// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/base/Range.hpp"

#include <algorithm>

#include "kernels/base/Check.hpp"

namespace hexmembrane {

void requireIn(const Range& range, const std::string& field, double value, const std::string& unit)
{
	requireFinite(field, value, unit);
	if (!range.holds(value)) reject(field, value, "is out of range", std::string("give a number ") + range.words + " in " + unit);
}

void requireOneOf(const Choices& choices, const std::string& field, const std::string& value)
{
	if (std::find(choices.all.begin(), choices.all.end(), value) == choices.all.end()) reject(field, "'" + value + "'", "unknown", choices.words);
}

} // namespace hexmembrane
