// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <limits>
#include <string>
#include <vector>

namespace hexmembrane {

/// Numbers that are allowed: an end that is open is not among them.
struct Range {
	static constexpr double unlimited = std::numeric_limits<double>::infinity();

	double low;
	bool lowOpen;
	double high;
	bool highOpen;
	const char* words;

	bool holds(double value) const { return (lowOpen ? value > low : value >= low) && (highOpen ? value < high : value <= high); }
};

/// Words that are allowed.
struct Choices {
	std::vector<std::string> all;
	const char* words;
};

/// Accepts finite numbers of the range only. A NaN is reported as not given. \throws FieldError
void requireIn(const Range& range, const std::string& field, double value, const std::string& unit);

/// Accepts the choices only. \throws FieldError
void requireOneOf(const Choices& choices, const std::string& field, const std::string& value);

} // namespace hexmembrane
