// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <stdexcept>
#include <string>

namespace hexmembrane {

/// What is wrong with one field of a kernel's input. `field` is the kernel's own name for it ("porosity", "radii[7]"): a kernel does not know who calls it.
/// The class that the user sees puts its own name before it, see pkg/base/NamedFields.hpp.
struct Complaint {
	std::string field, value, wrong, fix;

	/// The one form of every complaint: "field = value: what is wrong; fix: what to do".
	std::string text() const;
};

/// Input out of range or not given.
class FieldError : public std::invalid_argument {
public:
	explicit FieldError(Complaint complaint);
	const Complaint& complaint() const { return said; }

private:
	Complaint said;
};

/// Input in range that leads to no result, found only by trying.
class FieldFailure : public std::runtime_error {
public:
	explicit FieldFailure(Complaint complaint);
	const Complaint& complaint() const { return said; }

private:
	Complaint said;
};

/// Shortest text that reads back well in a message: 6 significant digits.
std::string formatNumber(double value);

/// \throws FieldError always
[[noreturn]] void reject(const std::string& field, const std::string& value, const std::string& wrong, const std::string& fix);
[[noreturn]] void reject(const std::string& field, double value, const std::string& wrong, const std::string& fix);
[[noreturn]] void reject(const std::string& field, int value, const std::string& wrong, const std::string& fix);

/// \throws FieldFailure always
[[noreturn]] void fail(const std::string& field, double value, const std::string& wrong, const std::string& fix);

/// Accepts finite numbers > 0 only. A NaN is reported as not given. \throws FieldError
void requirePositive(const std::string& field, double value, const std::string& unit);

/// Accepts finite numbers >= 0 only. A NaN is reported as not given. \throws FieldError
void requireNonNegative(const std::string& field, double value, const std::string& unit);

/// Accepts any finite number. A NaN is reported as not given. \throws FieldError
void requireFinite(const std::string& field, double value, const std::string& unit);

} // namespace hexmembrane
