#pragma once
// What exitance formfactor tells of a matrix: what it took, and whether it holds.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "src/form_factor/matrix_check.h"
#include "src/form_factor/pair_sample.h"
#include "src/form_factor/row_closing.h"

namespace exitance {

/// Wall-clock time [s].
struct FormFactorSeconds {
  double load = 0, form_factors = 0, checks = 0, output = 0, total = 0;
};

struct FormFactorReport {
  std::string scene, scene_hash;
  std::uint64_t surfaces = 0, patches = 0, rows = 0, entries = 0;
  double patch_size = 0, tolerance = 0, relative = 0;
  std::string file, closed_file;  ///< empty where none was written

  std::array<std::uint64_t, 4> pairs{};   ///< of each class
  std::array<double, 4> class_seconds{};  ///< of one thread's time, without rows that were resumed
  std::uint64_t points = 0;               ///< that were looked from, likewise
  std::uint64_t unreached = 0;            ///< pairs whose error is above the tolerance
  std::uint32_t resumed_rows = 0;

  bool closed = false;       ///< is_closed
  bool only_fronts = false;  ///< sees_only_fronts
  MatrixCheck matrix;
  std::vector<std::string> row_names;
  PairSample sample;
  struct RowsClosed {
    double largest_change = 0, largest_factor = 1;
    std::uint32_t row = 0, column = 0;
  };
  std::optional<RowsClosed> rows_closed;

  std::uint64_t estimated_bytes = 0, available_bytes = 0, peak_memory_bytes = 0;
  FormFactorSeconds seconds;
  std::vector<std::string> warnings;
  unsigned threads = 0;
  std::uint64_t seed = 0;
  std::map<std::string, std::string> options;
};

/// The worst of a sample: what uses up most of its errors. None of an empty one.
std::optional<PairDefect> worst_of(const std::vector<PairDefect>& defects);

/// A line for each check that failed, in words.
std::vector<std::string> failed_checks(const FormFactorReport& report);

std::string in_words(const FormFactorReport& report);

/// Indented, with a final newline.
std::string to_json(const FormFactorReport& report);

/// What made the matrix, without anything that may differ between runs of the same numbers: times, threads, paths.
std::string matrix_manifest(const FormFactorReport& report);

}  // namespace exitance
