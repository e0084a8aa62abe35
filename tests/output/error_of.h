#pragma once
// What is said of bad input.

#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "src/scene/input_error.h"

namespace exitance {

/// The message of the InputError that the work throws, a single line; empty where it throws none.
inline std::string error_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    return error.what();
  }
  return "";
}

}  // namespace exitance
