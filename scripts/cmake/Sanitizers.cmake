# Sanitizers over the kernels and their tests (HEXMEMBRANE_SANITIZE), and the target kernel_threads: OpenMP for them.

# onlyThreadedTests(LIST): under the thread sanitizer, takes from a list of test files those that name no kernel with a parallel loop. They have nothing to
# say there, and take two minutes to build.
function(onlyThreadedTests list)
	if(NOT HEXMEMBRANE_SANITIZE STREQUAL thread)
		return()
	endif()
	file(GLOB kernels CONFIGURE_DEPENDS pkg/kernels/*/*.cpp pkg/kernels/*/*.hpp)
	set(threaded)
	foreach(kernel IN LISTS kernels)
		file(STRINGS "${kernel}" loops REGEX "omp parallel" LIMIT_COUNT 1)
		if(loops)
			get_filename_component(name "${kernel}" NAME_WE)
			list(APPEND threaded ${name})
		endif()
	endforeach()
	list(JOIN threaded "|" names)
	set(kept)
	foreach(test IN LISTS ${list})
		file(STRINGS "${test}" uses REGEX "${names}" LIMIT_COUNT 1)
		if(uses)
			list(APPEND kept "${test}")
		endif()
	endforeach()
	set(${list} ${kept} PARENT_SCOPE)
endfunction()

if(NOT HEXMEMBRANE_SANITIZE)
	add_library(kernel_threads INTERFACE)
	target_link_libraries(kernel_threads INTERFACE OpenMP::OpenMP_CXX)
	return()
endif()

if(HEXMEMBRANE_PLUGIN)
	message(FATAL_ERROR "HEXMEMBRANE_SANITIZE = ${HEXMEMBRANE_SANITIZE}: YADE, built without it, cannot load such a plugin; "
		"fix: -DHEXMEMBRANE_PLUGIN=OFF, or scripts/sanitize, which does it all")
endif()
add_library(kernel_threads INTERFACE)
# -O1: readable traces at a bearable speed. The standard library's own assertions see what lies within the capacity of a vector.
# Without the checks of every reference that Eigen passes on, which cost a factor of eight: what they find the address sanitizer finds
# at the access, but for the alignment, which x86-64 does not ask for.
add_compile_options(-fsanitize=${HEXMEMBRANE_SANITIZE} -fno-sanitize=null,alignment,object-size,vptr -fno-sanitize-recover=all
	-fno-omit-frame-pointer -O1 -g1)
add_compile_definitions(_GLIBCXX_ASSERTIONS)
add_link_options(-fsanitize=${HEXMEMBRANE_SANITIZE})

if(HEXMEMBRANE_SANITIZE STREQUAL thread)
	# libgomp waits in ways that the thread sanitizer cannot see: it would report every loop. Its entry points come from a file of ours
	# that waits by pthreads. libgomp is not linked, so that an entry point that the file lacks is an error.
	find_package(Threads REQUIRED)
	separate_arguments(openmpFlags UNIX_COMMAND "${OpenMP_CXX_FLAGS}")
	target_compile_options(kernel_threads INTERFACE ${openmpFlags})
	add_library(thread_team STATIC tests/kernels/ThreadTeam.cpp)
	target_compile_options(thread_team PRIVATE ${hexmembraneWarnings})
	target_link_libraries(kernel_threads INTERFACE thread_team Threads::Threads)
else()
	target_link_libraries(kernel_threads INTERFACE OpenMP::OpenMP_CXX)
endif()

# What must end with a report: the proof that a clean run of the tests means something.
add_executable(sanitizer_probe tests/kernels/SanitizerProbe.cpp)
target_link_libraries(sanitizer_probe PRIVATE kernel_threads)
target_compile_options(sanitizer_probe PRIVATE ${hexmembraneWarnings})
