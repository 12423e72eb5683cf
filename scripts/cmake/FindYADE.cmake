# Finds the YADE that the plugin is built for, and the sources its headers come from.
#
# Input:   YADE_EXECUTABLE   the double-precision `yade` program (a Python script); searched in PATH when not given
#          YADE_SOURCE_DIR   source tree of exactly that version (folders core/, lib/, pkg/ and file RELEASE)
# Output:  YADE_VERSION, YADE_FEATURES, YADE_LIB_DIR (YADE's plugins), YADE_PYTHON_DIR (YADE's Python packages),
#          YADE_PYTHON (the interpreter), YADE_DEFINITIONS, YADE_LIBRARIES and the target YADE::YADE
#
# YADE installs no headers and no build description. Its version, feature list, precision and folders stand in the text of
# the program itself; the layout of its classes follows from them through the definitions listed here, which are those of
# YADE's own CMakeLists.txt. A plugin built with others would load and then corrupt memory, so every doubt is an error.

cmake_policy(VERSION 3.22)

set(YADE_EXECUTABLE "" CACHE FILEPATH "YADE's program, e.g. /usr/bin/yade-double")
set(YADE_SOURCE_DIR "" CACHE PATH "YADE's source tree, of the same version as YADE_EXECUTABLE")

if(NOT YADE_EXECUTABLE)
	find_program(_yadeFound NAMES yade-double yade NO_CACHE)
	if(NOT _yadeFound)
		message(FATAL_ERROR "YADE was not found: neither yade-double nor yade is in PATH. "
			"Install YADE (Debian: apt install yade) or give its program: cmake -DYADE_EXECUTABLE=/path/to/yade ...")
	endif()
	set(YADE_EXECUTABLE "${_yadeFound}" CACHE FILEPATH "YADE's program, e.g. /usr/bin/yade-double" FORCE)
endif()
if(NOT EXISTS "${YADE_EXECUTABLE}" OR IS_DIRECTORY "${YADE_EXECUTABLE}")
	message(FATAL_ERROR "YADE_EXECUTABLE = ${YADE_EXECUTABLE}: there is no such file. Give the path of YADE's program.")
endif()
file(SIZE "${YADE_EXECUTABLE}" _yadeSize)
if(_yadeSize GREATER 1000000)
	message(FATAL_ERROR "YADE_EXECUTABLE = ${YADE_EXECUTABLE}: this is not YADE's start program, which is a Python script of a few kB.")
endif()
file(READ "${YADE_EXECUTABLE}" _yadeText)

# What a regular expression finds in the program's text, or an error that names what is missing.
function(_yade_extract variable what regex)
	if(NOT _yadeText MATCHES "${regex}")
		message(FATAL_ERROR "YADE_EXECUTABLE = ${YADE_EXECUTABLE}: its text does not state ${what}. "
			"Is this really YADE's start program (a Python script with a line 'features,version,debugbuild=...')?")
	endif()
	set(${variable} "${CMAKE_MATCH_1}" PARENT_SCOPE)
endfunction()

_yade_extract(_yadeFeatureText "its features" "features,version,debugbuild='([^']*)'\\.split")
_yade_extract(YADE_VERSION "its version" "features,version,debugbuild='[^']*'\\.split\\(' '\\),'([^']*)'")
_yade_extract(_yadeDebug "whether it is a debug build" "features,version,debugbuild='[^']*'\\.split\\(' '\\),'[^']*','([^']*)'")
_yade_extract(_yadeDigits "its number of decimal digits" "mpmath\\.mp\\.dps=\\(int\\(([0-9]+)\\)")
_yade_extract(_yadePrefix "its prefix" "prefix,suffix='([^']*)' if")
_yade_extract(_yadeSuffix "its suffix" "os\\.environ\\['YADE_PREFIX'\\],'([^']*)'")
_yade_extract(_yadeLibPath "its library folder" "libPATH='([^']*)'")
_yade_extract(YADE_PYTHON "its Python interpreter" "^#![ \t]*([^ \t\r\n]+)")

if(NOT _yadeDigits EQUAL 15)
	message(FATAL_ERROR "YADE_EXECUTABLE = ${YADE_EXECUTABLE}: this build of YADE computes with ${_yadeDigits} decimal digits; "
		"hexmembrane needs the double-precision build (15 digits). Give that one, e.g. -DYADE_EXECUTABLE=/usr/bin/yade-double.")
endif()
if(DEFINED ENV{YADE_PREFIX})
	set(_yadePrefix "$ENV{YADE_PREFIX}")
endif()
if(_yadeLibPath STREQUAL "\${LIBRARY_OUTPUT_PATH}")
	set(_yadeLibPath lib)
endif()
set(YADE_LIB_DIR "${_yadePrefix}/${_yadeLibPath}/yade${_yadeSuffix}")
set(YADE_PYTHON_DIR "${YADE_LIB_DIR}/py")
if(NOT EXISTS "${YADE_LIB_DIR}/libyade.so")
	message(FATAL_ERROR "YADE_EXECUTABLE = ${YADE_EXECUTABLE}: there is no ${YADE_LIB_DIR}/libyade.so, where this program loads its "
		"libraries from. Is YADE completely installed? A moved YADE needs the environment variable YADE_PREFIX.")
endif()
if(YADE_PYTHON STREQUAL "/usr/bin/env")
	_yade_extract(YADE_PYTHON "its Python interpreter" "^#![ \t]*[^ \t\r\n]+[ \t]+([^ \t\r\n]+)")
	find_program(_yadePython "${YADE_PYTHON}" NO_CACHE REQUIRED)
	set(YADE_PYTHON "${_yadePython}")
endif()

if(NOT YADE_SOURCE_DIR)
	message(FATAL_ERROR "YADE_SOURCE_DIR is not given: the plugin is compiled against YADE's own source tree, version ${YADE_VERSION}. "
		"Debian: apt-get source --download-only yade, unpack the .orig tarball; or tag ${YADE_VERSION} of YADE's "
		"git repository. Then cmake -DYADE_SOURCE_DIR=/path/to/it ...")
endif()
foreach(_file RELEASE core/Scene.hpp lib/serialization/Serializable.hpp pkg/dem/ScGeom.hpp)
	if(NOT EXISTS "${YADE_SOURCE_DIR}/${_file}")
		message(FATAL_ERROR "YADE_SOURCE_DIR = ${YADE_SOURCE_DIR}: there is no ${_file} in it. Give the top folder of YADE's source tree.")
	endif()
endforeach()
file(READ "${YADE_SOURCE_DIR}/RELEASE" _yadeSourceVersion)
string(STRIP "${_yadeSourceVersion}" _yadeSourceVersion)
if(NOT _yadeSourceVersion STREQUAL YADE_VERSION)
	message(FATAL_ERROR "YADE_SOURCE_DIR = ${YADE_SOURCE_DIR} is version ${_yadeSourceVersion}, but ${YADE_EXECUTABLE} is version "
		"${YADE_VERSION}. A plugin needs the headers of exactly the version that loads it: give the sources of ${YADE_VERSION}.")
endif()

# The definitions. Features that bring none (or none that a header looks at) are listed with an empty right side, so that a
# feature that nobody has looked at is noticed instead of guessed.
string(STRIP "${_yadeFeatureText}" YADE_FEATURES)
string(REGEX REPLACE " +" ";" YADE_FEATURES "${YADE_FEATURES}")
set(_defs_LOGGER YADE_BOOST_LOG BOOST_LOG_DYN_LINK)
set(_defs_USEFUL_ERRORS)
set(_defs_COMPLEX_MP YADE_COMPLEX_MP)
set(_defs_MPFR)
set(_defs_MPC)
set(_defs_VTK YADE_VTK)
set(_defs_OPENMP YADE_OPENMP)
set(_defs_GTS YADE_GTS)
set(_defs_QT5 YADE_OPENGL YADE_QT5 QT_NO_KEYWORDS)
set(_defs_CGAL YADE_CGAL CGAL_DISABLE_ROUNDING_MATH_CHECK)
set(_defs_PFVFLOW FLOW_ENGINE)
set(_defs_LINSOLV LINSOLV)
set(_defs_MPI YADE_MPI)
set(_defs_TWOPHASEFLOW TWOPHASEFLOW)
set(_defs_SPH YADE_SPH)
set(_defs_LS_DEM YADE_LS_DEM)
set(_defs_DEFORM YADE_DEFORM)
set(_defs_FEMLIKE YADE_FEM)
set(_defs_LIQMIGRATION YADE_LIQMIGRATION)
set(_defs_GL2PS YADE_GL2PS)
set(_defs_LBMFLOW LBM_ENGINE)
set(_defs_THERMAL THERMAL)
set(_defs_PARTIALSAT PARTIALSAT)
set(_defs_PROFILING USE_TIMING_DELTAS ISC_TIMING)
set(_defs_POTENTIAL_PARTICLES YADE_POTENTIAL_PARTICLES)
set(_defs_POTENTIAL_BLOCKS YADE_POTENTIAL_BLOCKS)
set(_defs_FAST_NATIVE)
set(_defs_ODEINT YADE_ODEINT)
set(_yadeKnown LOGGER USEFUL_ERRORS COMPLEX_MP MPFR MPC VTK OPENMP GTS QT5 CGAL PFVFLOW LINSOLV MPI TWOPHASEFLOW SPH LS_DEM DEFORM
	FEMLIKE LIQMIGRATION GL2PS LBMFLOW THERMAL PARTIALSAT PROFILING POTENTIAL_PARTICLES POTENTIAL_BLOCKS FAST_NATIVE ODEINT)

set(YADE_DEFINITIONS YADE_REAL_BIT=64 YADE_REAL_DEC=15 MAX_LOG_LEVEL=5 EIGEN_DONT_VECTORIZE EIGEN_DONT_ALIGN
	EIGEN_DISABLE_UNALIGNED_ARRAY_ASSERT BOOST_BIND_GLOBAL_PLACEHOLDERS)
foreach(_feature IN LISTS YADE_FEATURES)
	if(_feature STREQUAL "MASK_ARBITRARY")
		message(FATAL_ERROR "YADE_EXECUTABLE = ${YADE_EXECUTABLE}: built with MASK_ARBITRARY, whose mask size its text does not state. "
			"hexmembrane supports YADE with ENABLE_MASK_ARBITRARY=OFF (YADE's default).")
	elseif(_feature STREQUAL "VECTORIZE")
		message(FATAL_ERROR "YADE_EXECUTABLE = ${YADE_EXECUTABLE}: built with VECTORIZE, an experimental option that changes the layout of "
			"every class; hexmembrane has not been tried with it. Use a YADE with VECTORIZE=OFF (YADE's default).")
	elseif(_feature STREQUAL "ASAN")
		message(FATAL_ERROR "YADE_EXECUTABLE = ${YADE_EXECUTABLE}: built with the address sanitizer, into which a plugin built without "
			"it cannot be loaded. Use a YADE with ENABLE_ASAN=OFF (YADE's default).")
	elseif(NOT _feature IN_LIST _yadeKnown)
		message(FATAL_ERROR "YADE_EXECUTABLE = ${YADE_EXECUTABLE}: unknown feature ${_feature}. Look up in YADE's CMakeLists.txt which "
			"definitions it sets, and add them to scripts/cmake/FindYADE.cmake.")
	endif()
	list(APPEND YADE_DEFINITIONS ${_defs_${_feature}})
endforeach()
if(_yadeDebug MATCHES "debug")
	list(APPEND YADE_DEFINITIONS YADE_DEBUG)
endif()
if(NOT "OPENMP" IN_LIST YADE_FEATURES)
	message(FATAL_ERROR "YADE_EXECUTABLE = ${YADE_EXECUTABLE}: built without OPENMP, which hexmembrane's engines need.")
endif()

# What YADE's headers include themselves.
set(Python3_EXECUTABLE "${YADE_PYTHON}")
find_package(Python3 REQUIRED COMPONENTS Interpreter Development.Module)
find_package(OpenMP REQUIRED COMPONENTS CXX)
find_package(Eigen3 REQUIRED CONFIG)
find_package(Boost REQUIRED CONFIG COMPONENTS python${Python3_VERSION_MAJOR}${Python3_VERSION_MINOR} serialization log thread system
	iostreams filesystem)
set(_yadeDependencies Boost::python${Python3_VERSION_MAJOR}${Python3_VERSION_MINOR} Boost::serialization Boost::log Boost::thread
	Boost::system Boost::iostreams Boost::filesystem Eigen3::Eigen OpenMP::OpenMP_CXX Python3::Module)
if("MPI" IN_LIST YADE_FEATURES)
	# Debian's mpicxx is an alternative that an installation without maintainer scripts (the private root) does not have.
	find_program(_yadeMpiCompiler NAMES mpicxx mpicxx.openmpi mpicxx.mpich NO_CACHE)
	if(_yadeMpiCompiler AND NOT MPI_CXX_COMPILER)
		set(MPI_CXX_COMPILER "${_yadeMpiCompiler}")
	endif()
	find_package(MPI REQUIRED COMPONENTS CXX)
	list(APPEND _yadeDependencies MPI::MPI_CXX)
endif()

# libyade.so and the pkg_ libraries are themselves plugins without dependencies on each other; whatever we use of them must be named.
file(GLOB YADE_LIBRARIES "${YADE_LIB_DIR}/libyade.so" "${YADE_LIB_DIR}/libpkg_common*.so" "${YADE_LIB_DIR}/libpkg_dem*.so")

if(NOT TARGET YADE::YADE)
	add_library(YADE::YADE INTERFACE IMPORTED)
	target_compile_definitions(YADE::YADE INTERFACE ${YADE_DEFINITIONS})
	# Imported targets' include folders are system ones: no warnings from YADE's headers.
	target_include_directories(YADE::YADE INTERFACE "${YADE_SOURCE_DIR}")
	target_compile_options(YADE::YADE INTERFACE -frounding-math)
	target_link_libraries(YADE::YADE INTERFACE ${YADE_LIBRARIES} ${_yadeDependencies})
endif()
message(STATUS "YADE ${YADE_VERSION}: ${YADE_EXECUTABLE}, libraries in ${YADE_LIB_DIR}, headers in ${YADE_SOURCE_DIR}")
message(STATUS "YADE features: ${YADE_FEATURES}")
