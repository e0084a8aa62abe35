#pragma once
// What exitance compare tells: who is wrong, where, and what it took.

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "src/reference/matrix_comparison.h"
#include "src/reference/pair_fault.h"

namespace exitance {

struct CompareReport {
  /// Error of a solution by equation 7 (comparison.h).
  struct SolutionErrors {
    double all = 0, worst_1_percent = 0;
  };
  struct Entry {
    std::string name;
    MatrixComparison errors;
    std::vector<Fault> faults;                  ///< of errors.worst
    std::string why_no_solution;                ///< in words; empty where there is one
    std::optional<SolutionErrors> B;            ///< against the solution by the truth, on the same patches
    std::optional<SolutionErrors> B_reference;  ///< against the reference, meshing included
    std::optional<double> standard_error;       ///< that rays claim, in the mean
    std::uint64_t rays = 0, queries = 0, matrix_bytes = 0, peak_memory_bytes = 0;
    double seconds = 0, cpu_seconds = 0;
  };

  std::string scene, scene_hash, reference;  ///< reference: its path; empty without one
  std::uint64_t patches = 0;
  double patch_size = 0;
  std::array<std::uint64_t, 4> pairs{};  ///< ordered, of each class
  double truth_tolerance = 0, truth_largest_error = 0, truth_seconds = 0, truth_cpu_seconds = 0;
  std::uint64_t truth_queries = 0, truth_unreached = 0;
  std::uint64_t truth_resumed_rows = 0;  ///< that an earlier run had made; times and queries are without them
  std::optional<SolutionErrors> truth_B_reference;
  std::vector<Entry> entries;
  unsigned threads = 0;
  std::map<std::string, std::string> options;
  std::vector<std::string> warnings;
};

std::string in_words(const CompareReport& report);

/// Indented, with a final newline.
std::string to_json(const CompareReport& report);

}  // namespace exitance
