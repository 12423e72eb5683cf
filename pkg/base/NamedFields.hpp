// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "kernels/base/Check.hpp"

#include <initializer_list>
#include <stdexcept>
#include <string>
#include <utility>

namespace yade {

//! Pairs of a kernel's field and the attribute of the class that the user sets it by. Fields that are not listed have the same name in both.
using FieldNames = std::initializer_list<std::pair<const char*, const char*>>;

//! The complaint as the user reads it, "Class.attribute = value: wrong; fix: ...". An index behind the field stays: radii[7].
inline std::string namedComplaint(const std::string& className, FieldNames names, const hexmembrane::Complaint& complaint)
{
	hexmembrane::Complaint named = complaint;
	const std::size_t bare = complaint.field.find('[');
	const std::string field = complaint.field.substr(0, bare), index = bare == std::string::npos ? "" : complaint.field.substr(bare);
	named.field = className + "." + field + index;
	for (const auto& name : names)
		if (field == name.first) named.field = className + "." + name.second + index;
	return named.text();
}

/*! Calls a kernel and gives the names of a YADE class to what it complains about:
 *
 *   named("MembranePressure", {{"offset", "surfaceOffset"}}, [&] { return TubePressure(stencil, first, last, offset); });
 *
 * Throws std::invalid_argument for a FieldError and std::runtime_error for a FieldFailure. A call within another one is named once, by the inner. */
template <typename Kernel>
auto named(const std::string& className, FieldNames names, Kernel&& kernel) -> decltype(kernel())
{
	try {
		return kernel();
	} catch (const hexmembrane::FieldError& error) {
		throw std::invalid_argument(namedComplaint(className, names, error.complaint()));
	} catch (const hexmembrane::FieldFailure& failure) {
		throw std::runtime_error(namedComplaint(className, names, failure.complaint()));
	}
}

} // namespace yade
