# Where tests, experiments and bench find the program and the source tree: only this object depends on the folder.
add_library(places OBJECT EXCLUDE_FROM_ALL tests/places.cpp)
target_link_libraries(places PRIVATE exitance_compile_options)
target_include_directories(places PRIVATE ${PROJECT_SOURCE_DIR})
target_compile_definitions(places PRIVATE
  EXITANCE_PROGRAM="$<TARGET_FILE:exitance>" EXITANCE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
