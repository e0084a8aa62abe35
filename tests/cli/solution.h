#pragma once
// Reads back what `exitance solve` wrote.

#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <vector>

#include "tests/output/scratch_folder.h"

namespace exitance {

/// The numbers of one array of a .vtp file.
inline std::vector<double> vtp_array(const std::filesystem::path& file, const std::string& name) {
  const std::string text = contents(file);
  const std::size_t at = text.find("Name=\"" + name + "\"");
  EXPECT_NE(at, std::string::npos) << name;
  std::istringstream numbers(text.substr(text.find('>', at) + 1));
  std::vector<double> values;
  for (double value; numbers >> value;) values.push_back(value);
  return values;
}

}  // namespace exitance
