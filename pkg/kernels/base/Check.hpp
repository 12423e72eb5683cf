// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>

namespace hexmembrane {

/// Shortest text that reads back well in a message: 6 significant digits.
std::string formatNumber(double value);

/// The one form of every complaint about input: "Class.parameter = value: what is wrong; fix: what to do".
/// \throws std::invalid_argument always
[[noreturn]] void reject(const std::string& parameter, const std::string& value, const std::string& wrong, const std::string& fix);
[[noreturn]] void reject(const std::string& parameter, double value, const std::string& wrong, const std::string& fix);
[[noreturn]] void reject(const std::string& parameter, int value, const std::string& wrong, const std::string& fix);

/// Accepts finite numbers > 0 only; a NaN is reported as not given. \throws std::invalid_argument
void requirePositive(const std::string& parameter, double value, const std::string& unit);

/// Accepts finite numbers >= 0 only; a NaN is reported as not given. \throws std::invalid_argument
void requireNonNegative(const std::string& parameter, double value, const std::string& unit);

/// Accepts any finite number; a NaN is reported as not given. \throws std::invalid_argument
void requireFinite(const std::string& parameter, double value, const std::string& unit);

} // namespace hexmembrane
