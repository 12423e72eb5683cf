// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/base/Check.hpp"

#include <cmath>
#include <cstdio>
#include <utility>

namespace hexmembrane {

std::string Complaint::text() const { return field + " = " + value + ": " + wrong + "; fix: " + fix; }

FieldError::FieldError(Complaint complaint) : std::invalid_argument(complaint.text()), said(std::move(complaint)) {}

FieldFailure::FieldFailure(Complaint complaint) : std::runtime_error(complaint.text()), said(std::move(complaint)) {}

std::string formatNumber(double value)
{
	char text[32];
	std::snprintf(text, sizeof text, "%.6g", value);
	return text;
}

void reject(const std::string& field, const std::string& value, const std::string& wrong, const std::string& fix)
{
	throw FieldError({field, value, wrong, fix});
}

void reject(const std::string& field, double value, const std::string& wrong, const std::string& fix) { reject(field, formatNumber(value), wrong, fix); }

void reject(const std::string& field, int value, const std::string& wrong, const std::string& fix) { reject(field, std::to_string(value), wrong, fix); }

void fail(const std::string& field, double value, const std::string& wrong, const std::string& fix)
{
	throw FieldFailure({field, formatNumber(value), wrong, fix});
}

void requireFinite(const std::string& field, double value, const std::string& unit)
{
	if (std::isnan(value)) reject(field, value, "not given or not a number", "give a number in " + unit);
	if (std::isinf(value)) reject(field, value, "not finite", "give a finite number in " + unit);
}

void requirePositive(const std::string& field, double value, const std::string& unit)
{
	requireFinite(field, value, unit);
	if (value <= 0) reject(field, value, "must be positive", "give a number > 0 in " + unit);
}

void requireNonNegative(const std::string& field, double value, const std::string& unit)
{
	requireFinite(field, value, unit);
	if (value < 0) reject(field, value, "must not be negative", "give a number >= 0 in " + unit);
}

} // namespace hexmembrane
