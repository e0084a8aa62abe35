#pragma once
// Tables of an experiment: written as CSV, and compared with what is expected.

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "src/output/whole_file.h"

namespace exitance {

/// Rows of texts and numbers under a header. Numbers are written with six digits.
struct CsvTable {
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;

  void write(const std::filesystem::path& path) const {
    write_whole_file(path, [&](std::ostream& out) {
      fmt::print(out, "{}\n", fmt::join(header, ","));
      for (const auto& row : rows) fmt::print(out, "{}\n", fmt::join(row, ","));
    });
  }

  static CsvTable read(const std::filesystem::path& path) {
    std::ifstream in(path);
    if (!in) throw std::runtime_error(path.string() + " cannot be read");
    CsvTable table;
    for (std::string line; std::getline(in, line);) {
      std::vector<std::string> fields;
      std::istringstream parts(line);
      for (std::string field; std::getline(parts, field, ',');) fields.push_back(field);
      if (table.header.empty()) {
        table.header = fields;
      } else {
        table.rows.push_back(fields);
      }
    }
    return table;
  }
};

/// A number as it stands in tables.
inline std::string digits(double value) {
  return fmt::format("{:.6g}", value);
}

/// Where a row of `found` is not among those expected, by its first `keys` fields, or one of its other fields that are
/// not in `ignored` (their headers) differs by more than the share `tolerance`: one line each.
inline std::vector<std::string> differences(const CsvTable& found, const CsvTable& expected, std::size_t keys,
                                            double tolerance, const std::vector<std::string>& ignored) {
  std::vector<std::string> lines;
  if (found.header != expected.header) return {"other columns than expected"};
  for (const auto& row : found.rows) {
    const std::string name =
        fmt::format("{}", fmt::join(row.begin(), row.begin() + static_cast<std::ptrdiff_t>(keys), " "));
    const std::vector<std::string>* match = nullptr;
    for (const auto& other : expected.rows) {
      if (other.size() == row.size() &&
          std::equal(row.begin(), row.begin() + static_cast<std::ptrdiff_t>(keys), other.begin()))
        match = &other;
    }
    if (match == nullptr) {
      lines.push_back(name + ": not expected");
      continue;
    }
    for (std::size_t k = keys; k < row.size(); ++k) {
      bool skip = false;
      for (const std::string& column : ignored) skip = skip || column == found.header[k];
      if (skip) continue;
      const double a = std::strtod(row[k].c_str(), nullptr), b = std::strtod((*match)[k].c_str(), nullptr);
      if (!(std::fabs(a - b) <= tolerance * std::fabs(b)))
        lines.push_back(fmt::format("{}: {} is {}, expected {}", name, found.header[k], row[k], (*match)[k]));
    }
  }
  return lines;
}

/// Prints what is wrong, a line each; the exit code that says whether anything is.
inline int verdict(const std::vector<std::string>& wrong) {
  for (const std::string& line : wrong) fmt::print(stderr, "{}\n", line);
  return wrong.empty() ? 0 : 1;
}

}  // namespace exitance
