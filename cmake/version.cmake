# Writes exitance_version.h: the version, the compiler, and the commit this was configured at ("unknown" outside of a git checkout,
# with "-modified" where the checkout differs from it).
find_package(Git QUIET)
set(EXITANCE_COMMIT unknown)
if(GIT_FOUND)
  execute_process(COMMAND ${GIT_EXECUTABLE} describe --always --abbrev=40 --exclude=* --dirty=-modified
                  WORKING_DIRECTORY ${PROJECT_SOURCE_DIR} OUTPUT_VARIABLE described RESULT_VARIABLE failed
                  OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(NOT failed)
    set(EXITANCE_COMMIT ${described})
  endif()
endif()
configure_file(${CMAKE_CURRENT_LIST_DIR}/exitance_version.h.in ${PROJECT_BINARY_DIR}/generated/exitance_version.h @ONLY)
include_directories(${PROJECT_BINARY_DIR}/generated)
