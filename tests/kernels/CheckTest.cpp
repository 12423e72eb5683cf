// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#include "Support.hpp"

#include "base/NamedFields.hpp"
#include "kernels/base/Check.hpp"
#include "kernels/base/Range.hpp"

#include <limits>

using namespace hexmembrane;

namespace {

constexpr double inf = std::numeric_limits<double>::infinity(), missing = std::numeric_limits<double>::quiet_NaN();

/// Type and message of what `call` throws.
template <typename Call>
std::string thrown(const Call& call)
{
	try {
		call();
	} catch (const FieldError& e) {
		return std::string("FieldError ") + e.what();
	} catch (const FieldFailure& e) {
		return std::string("FieldFailure ") + e.what();
	} catch (const std::invalid_argument& e) {
		return std::string("invalid_argument ") + e.what();
	} catch (const std::runtime_error& e) {
		return std::string("runtime_error ") + e.what();
	}
	return "nothing";
}

} // namespace

TEST(Check, aRangeHoldsItsClosedEndsOnly)
{
	const Range range{0, false, 1, true, ">= 0, < 1"};
	EXPECT_EQ(thrown([&] { requireIn(range, "damping", 0, "1"); }), "nothing");
	EXPECT_EQ(thrown([&] { requireIn(range, "damping", 0.999, "1"); }), "nothing");
	EXPECT_EQ(thrown([&] { requireIn(range, "damping", 1, "1"); }), "FieldError damping = 1: is out of range; fix: give a number >= 0, < 1 in 1");
	EXPECT_EQ(thrown([&] { requireIn(range, "damping", -1e-9, "1"); }), "FieldError damping = -1e-09: is out of range; fix: give a number >= 0, < 1 in 1");
	EXPECT_EQ(thrown([&] { requireIn(range, "damping", missing, "1"); }), "FieldError damping = nan: not given or not a number; fix: give a number in 1");
	EXPECT_EQ(thrown([&] { requireIn({0, true, Range::unlimited, false, "> 0"}, "skin", inf, "m"); }),
	          "FieldError skin = inf: not finite; fix: give a finite number in m");
}

TEST(Check, choices)
{
	const Choices choices{{"inner", "centre"}, "'inner' or 'centre'"};
	EXPECT_EQ(thrown([&] { requireOneOf(choices, "surface", "centre"); }), "nothing");
	EXPECT_EQ(thrown([&] { requireOneOf(choices, "surface", ""); }), "FieldError surface = '': unknown; fix: 'inner' or 'centre'");
}

TEST(Check, aComplaintHasOneForm)
{
	EXPECT_EQ(thrown([] { reject("radius", -1.5, "must be positive", "give one"); }), "FieldError radius = -1.5: must be positive; fix: give one");
	EXPECT_EQ(thrown([] { reject("rows", -2, "too few", "more"); }), "FieldError rows = -2: too few; fix: more");
	EXPECT_EQ(thrown([] { reject("name", "'x'", "unknown", "'y'"); }), "FieldError name = 'x': unknown; fix: 'y'");
	EXPECT_EQ(thrown([] { fail("porosity", 0.2, "too dense", "0.4"); }), "FieldFailure porosity = 0.2: too dense; fix: 0.4");
}

TEST(Check, aComplaintIsReadInParts)
{
	try {
		reject("radii[7]", 0.25, "wrong", "fix it");
		FAIL();
	} catch (const FieldError& e) {
		EXPECT_EQ(e.complaint().field, "radii[7]");
		EXPECT_EQ(e.complaint().value, "0.25");
		EXPECT_EQ(e.complaint().wrong, "wrong");
		EXPECT_EQ(e.complaint().fix, "fix it");
	}
}

TEST(Check, rangesAndTheirEnds)
{
	const double smallest = std::numeric_limits<double>::denorm_min();
	for (double good : {smallest, 1e300}) {
		EXPECT_NO_THROW(requirePositive("a", good, "m"));
		EXPECT_NO_THROW(requireNonNegative("a", good, "m"));
		EXPECT_NO_THROW(requireFinite("a", -good, "m"));
	}
	EXPECT_NO_THROW(requireNonNegative("a", 0, "m"));
	EXPECT_THROW(requirePositive("a", 0, "m"), FieldError);
	EXPECT_THROW(requirePositive("a", -smallest, "m"), FieldError);
	EXPECT_THROW(requireNonNegative("a", -smallest, "m"), FieldError);
	for (double bad : {inf, -inf, missing}) {
		EXPECT_THROW(requirePositive("a", bad, "m"), FieldError);
		EXPECT_THROW(requireNonNegative("a", bad, "m"), FieldError);
		EXPECT_THROW(requireFinite("a", bad, "m"), FieldError);
	}
	EXPECT_COMPLAINT(requireFinite("a", missing, "m"), "a = nan: not given");
}

TEST(NamedFields, theClassPutsItsNameBefore)
{
	EXPECT_EQ(thrown([] { yade::named("Tube", {}, [] { reject("radius", -1.0, "wrong", "right"); }); }),
	          "invalid_argument Tube.radius = -1: wrong; fix: right");
	EXPECT_EQ(thrown([] { yade::named("Tube", {}, [] { fail("porosity", 0.2, "wrong", "right"); }); }),
	          "runtime_error Tube.porosity = 0.2: wrong; fix: right");
}

TEST(NamedFields, fieldsTakeTheNamesOfTheirAttributes)
{
	const auto nameOf = [](const char* field) {
		return thrown([&] { yade::named("Tube", {{"offset", "surfaceOffset"}, {"list", "ids"}}, [&] { reject(field, 1, "wrong", "right"); }); });
	};
	EXPECT_EQ(nameOf("offset"), "invalid_argument Tube.surfaceOffset = 1: wrong; fix: right");
	EXPECT_EQ(nameOf("list[3]"), "invalid_argument Tube.ids[3] = 1: wrong; fix: right");
	EXPECT_EQ(nameOf("offsets"), "invalid_argument Tube.offsets = 1: wrong; fix: right");
}

TEST(NamedFields, theInnerNameStaysAndOtherErrorsPass)
{
	EXPECT_EQ(thrown([] { yade::named("Outer", {}, [] { yade::named("Inner", {}, [] { reject("a", 1, "wrong", "right"); }); }); }),
	          "invalid_argument Inner.a = 1: wrong; fix: right");
	EXPECT_EQ(thrown([] { yade::named("Outer", {}, [] { throw std::runtime_error("as it is"); }); }), "runtime_error as it is");
}

TEST(NamedFields, theKernelsResultComesBack)
{
	EXPECT_EQ(yade::named("Tube", {}, [] { return 42; }), 42);
}
