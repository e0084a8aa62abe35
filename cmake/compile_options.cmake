# What every file of ours is compiled with. Exact filters need IEEE arithmetic: no contraction of a*b+c (the error bounds
# count each rounding) and, because CGAL's intervals change it, no assumption about the rounding mode.
add_library(exitance_compile_options INTERFACE)
target_compile_features(exitance_compile_options INTERFACE cxx_std_20)
target_compile_options(exitance_compile_options INTERFACE
  -Wall -Wextra -Wshadow -Wconversion -Werror
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>  # GCC 12 warns of std::string + literal without cause (its bug 105651)
  -Wno-psabi  # vectors wider than the machine has registers for never cross a library's border
  -ffp-contract=off -frounding-math -fno-math-errno
  $<$<BOOL:${EXITANCE_ARCH}>:-march=${EXITANCE_ARCH}>)

set(CMAKE_CXX_FLAGS_DEV "-O2 -g -D_GLIBCXX_ASSERTIONS" CACHE STRING "Optimised, assertions on")
set(EXITANCE_SANITIZE "" CACHE STRING "Sanitizers to build with, as in 'address,undefined' or 'thread'")
if(EXITANCE_SANITIZE)
  # Without warnings: with sanitizers GCC 12 has some of CGAL, Eigen and its own intrinsics that have no cause, others on
  # other machines. CGAL's arrangements, which the oracles of the tests use, cast faces to a class that they are not of.
  add_compile_options(-w -fsanitize=${EXITANCE_SANITIZE} -fno-sanitize=vptr -fno-omit-frame-pointer
                      -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${EXITANCE_SANITIZE})
endif()
option(EXITANCE_COVERAGE "Count which lines of geometry/ and src/ are run; needs GCC" OFF)
if(EXITANCE_COVERAGE)
  # At -O1 GCC 12 warns of Boost and Eigen without cause.
  add_compile_options(--coverage -fprofile-update=atomic -fprofile-filter-files=^${PROJECT_SOURCE_DIR}/\(geometry|src\)/
                      -Wno-maybe-uninitialized -Wno-uninitialized)
  add_link_options(--coverage)
endif()
if(EXITANCE_SANITIZE MATCHES thread)
  include_directories(BEFORE ${PROJECT_SOURCE_DIR}/tests/tsan)  # its parallel_for says why
endif()

# GCC 12 with AVX-512 stores the literals {a, a, 0, 0} as {a, a, a, a}: it takes a constant of 256 bits whose upper words
# are zero for a broadcast of the lower ones, where it may move it from a general register (tests/scene/compiler_test.cpp).
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13
   AND CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  target_compile_options(exitance_compile_options INTERFACE -mtune-ctrl=^inter_unit_moves_to_vec)
endif()
