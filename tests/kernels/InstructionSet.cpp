// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
/* Linked into each program of kernel tests: skips the tests of an instruction set that this processor lacks, where they could only crash. */
#include <gtest/gtest.h>

namespace {

#if defined(HEXMEMBRANE_SIMD_V4)
const char* const lacking = __builtin_cpu_supports("x86-64-v4") ? nullptr : "x86-64-v4";
#elif defined(HEXMEMBRANE_SIMD_V3)
const char* const lacking = __builtin_cpu_supports("x86-64-v3") ? nullptr : "x86-64-v3";
#else
const char* const lacking = nullptr; // the default set, or the processor's choice
#endif

class ProcessorHasTheSet : public testing::Environment {
	void SetUp() override
	{
		if (lacking) GTEST_SKIP() << "this processor lacks " << lacking;
	}
};

testing::Environment* const processorHasTheSet = testing::AddGlobalTestEnvironment(new ProcessorHasTheSet);

} // namespace
