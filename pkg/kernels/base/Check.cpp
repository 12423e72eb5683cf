// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/base/Check.hpp"

#include <cmath>
#include <cstdio>
#include <stdexcept>

namespace hexmembrane {

std::string formatNumber(double value)
{
	char text[32];
	std::snprintf(text, sizeof text, "%.6g", value);
	return text;
}

void reject(const std::string& parameter, const std::string& value, const std::string& wrong, const std::string& fix)
{
	throw std::invalid_argument(parameter + " = " + value + ": " + wrong + "; fix: " + fix);
}

void reject(const std::string& parameter, double value, const std::string& wrong, const std::string& fix)
{
	reject(parameter, formatNumber(value), wrong, fix);
}

void reject(const std::string& parameter, int value, const std::string& wrong, const std::string& fix) { reject(parameter, std::to_string(value), wrong, fix); }

void requireFinite(const std::string& parameter, double value, const std::string& unit)
{
	if (std::isnan(value)) reject(parameter, value, "not given or not a number", "give a number in " + unit);
	if (std::isinf(value)) reject(parameter, value, "not finite", "give a finite number in " + unit);
}

void requirePositive(const std::string& parameter, double value, const std::string& unit)
{
	requireFinite(parameter, value, unit);
	if (value <= 0) reject(parameter, value, "must be positive", "give a number > 0 in " + unit);
}

void requireNonNegative(const std::string& parameter, double value, const std::string& unit)
{
	requireFinite(parameter, value, unit);
	if (value < 0) reject(parameter, value, "must not be negative", "give a number >= 0 in " + unit);
}

} // namespace hexmembrane
