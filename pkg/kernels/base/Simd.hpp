// hexmembrane: flexible-membrane triaxial tests for YADE. SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

/// Marks a leaf loop over plain arrays of doubles that is compiled for the instruction set of CMake's HEXMEMBRANE_SIMD. `auto` compiles it for all three
/// sets: the processor picks one at load time, so one build runs on every x86-64 machine. Marked are loops in .cpp files of kernels only, since CMake
/// compiles these files again for the tests of each set.
///
/// The sets differ in rounding: v3 and v4 contract a product and a sum into one operation (FMA), and the order of a vectorised sum follows the width of the
/// vectors. So what is the same "to the last bit" is so for one set only, with `auto` on one kind of processor.
///
/// HEXMEMBRANE_WIDEST_LANES(head, call) is the same for a function whose arithmetic is written over lanes (Lanes.hpp): `call` returns what the function does
/// and is compiled with `width`, how many doubles the set's registers hold: 8 by v4, 4 by v3, 2 by default.
#define HEXMEMBRANE_WITH_WIDTH(head, lanesOfSet, ...)                                                                                                          \
	head                                                                                                                                                   \
	{                                                                                                                                                      \
		constexpr int width = lanesOfSet;                                                                                                              \
		return __VA_ARGS__;                                                                                                                            \
	}

#if defined(HEXMEMBRANE_SIMD_AUTO)
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#error "HEXMEMBRANE_SIMD = auto: the processor's choice comes before a sanitizer's start-up; fix: -DHEXMEMBRANE_SIMD=default, v3 or v4"
#endif
#define HEXMEMBRANE_WIDEST __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#define HEXMEMBRANE_WIDEST_LANES(head, ...)                                                                                                                    \
	__attribute__((target("arch=x86-64-v4"))) HEXMEMBRANE_WITH_WIDTH(head, 8, __VA_ARGS__)                                                                 \
	        __attribute__((target("arch=x86-64-v3"))) HEXMEMBRANE_WITH_WIDTH(head, 4, __VA_ARGS__)                                                         \
	                __attribute__((target("default"))) HEXMEMBRANE_WITH_WIDTH(head, 2, __VA_ARGS__)
#elif defined(HEXMEMBRANE_SIMD_V4)
#define HEXMEMBRANE_WIDEST __attribute__((target("arch=x86-64-v4")))
#define HEXMEMBRANE_WIDEST_LANES(head, ...) HEXMEMBRANE_WIDEST HEXMEMBRANE_WITH_WIDTH(head, 8, __VA_ARGS__)
#elif defined(HEXMEMBRANE_SIMD_V3)
#define HEXMEMBRANE_WIDEST __attribute__((target("arch=x86-64-v3")))
#define HEXMEMBRANE_WIDEST_LANES(head, ...) HEXMEMBRANE_WIDEST HEXMEMBRANE_WITH_WIDTH(head, 4, __VA_ARGS__)
#elif defined(HEXMEMBRANE_SIMD_DEFAULT)
#define HEXMEMBRANE_WIDEST
#define HEXMEMBRANE_WIDEST_LANES(head, ...) HEXMEMBRANE_WITH_WIDTH(head, 2, __VA_ARGS__)
#else
#define HEXMEMBRANE_WIDEST static_assert(false, "HEXMEMBRANE_WIDEST in a file that CMake compiles for no set; fix: touch CMakeLists.txt (see Simd.hpp)");
#define HEXMEMBRANE_WIDEST_LANES(head, ...) HEXMEMBRANE_WIDEST
#endif
