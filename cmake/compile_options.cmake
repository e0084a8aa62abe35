# What every file of ours is compiled with. Exact filters need IEEE arithmetic: no contraction of a*b+c (the error bounds
# count each rounding) and, because CGAL's intervals change it, no assumption about the rounding mode.
add_library(exitance_compile_options INTERFACE)
target_compile_features(exitance_compile_options INTERFACE cxx_std_20)
target_compile_options(exitance_compile_options INTERFACE
  -Wall -Wextra -Wshadow -Wconversion -Werror
  -Wno-restrict  # GCC 12 warns of std::string + literal without cause (its bug 105651)
  -Wno-psabi  # vectors wider than the machine has registers for never cross a library's border
  -ffp-contract=off -frounding-math -fno-math-errno
  $<$<BOOL:${EXITANCE_ARCH}>:-march=${EXITANCE_ARCH}>)

set(CMAKE_CXX_FLAGS_DEV "-O2 -g -D_GLIBCXX_ASSERTIONS" CACHE STRING "Optimised, assertions on")
set(EXITANCE_SANITIZE "" CACHE STRING "Sanitizers to build with, as in 'address,undefined' or 'thread'")
if(EXITANCE_SANITIZE)
  add_compile_options(-fsanitize=${EXITANCE_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${EXITANCE_SANITIZE})
endif()
