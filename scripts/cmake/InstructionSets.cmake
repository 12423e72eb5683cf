# Which instruction sets the marked loops of the kernels (Simd.hpp) are compiled for: checks HEXMEMBRANE_SIMD, the plugin's, and sets
# hexmembraneSets, the plugin's and those that have a kernel_tests_SET of their own.
include(CheckCXXSourceCompiles)

if(NOT HEXMEMBRANE_SIMD MATCHES "^(auto|default|v3|v4)$")
	message(FATAL_ERROR "HEXMEMBRANE_SIMD = ${HEXMEMBRANE_SIMD}: no such instruction set; fix: auto, default, v3 or v4")
endif()
check_cxx_source_compiles("
	__attribute__((target_clones(\"arch=x86-64-v4\", \"arch=x86-64-v3\", \"default\"))) int twice(int a) { return 2 * a; }
	__attribute__((target(\"arch=x86-64-v4\"))) int thrice(int a) { return 3 * a; }
	int main() { return twice(0) + thrice(0); }" HEXMEMBRANE_HAS_SETS)
if(NOT HEXMEMBRANE_HAS_SETS AND NOT HEXMEMBRANE_SIMD STREQUAL default)
	message(FATAL_ERROR "HEXMEMBRANE_SIMD = ${HEXMEMBRANE_SIMD}: ${CMAKE_CXX_COMPILER} cannot compile a function for x86-64-v3 and x86-64-v4; "
		"fix: GCC 12 or newer on x86-64, or -DHEXMEMBRANE_SIMD=default")
endif()

set(hexmembraneTestSets)
if(HEXMEMBRANE_SANITIZE)
	# the memory accesses and threads are the same in all sets
elseif(HEXMEMBRANE_HAS_SETS)
	set(hexmembraneTestSets default v3 v4)
else()
	message(STATUS "kernel_tests_v3, kernel_tests_v4: not built (${CMAKE_CXX_COMPILER} does not know these instruction sets)")
endif()
set(hexmembraneSets ${HEXMEMBRANE_SIMD} ${hexmembraneTestSets})
list(REMOVE_DUPLICATES hexmembraneSets)
