#pragma once
// result.json: what a solution was made of, how good it is, and what it took.

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "src/output/manifest.h"

namespace exitance {

/// Pairs of receiver and source by how they ended. The rest of them were integrated in part.
struct PairCounts {
  std::uint64_t facing_away = 0, open = 0, blocked = 0, partial = 0;
};

/// Wall-clock time [s].
struct Seconds {
  double load = 0, form_factors = 0, solve = 0, output = 0, total = 0;
};

struct Report {
  std::string scene;
  std::uint64_t surfaces = 0;
  std::uint64_t patches = 0;
  std::uint64_t elements = 0;
  std::uint32_t bands = 0;
  std::string unit;        ///< of B, E and H
  std::string method;      ///< "gather", "shoot"
  std::string receivers;   ///< "points" or "area"
  std::string visibility;  ///< "exact" or "rays"

  bool converged = false;
  std::uint64_t iterations = 0;
  double residual = 0;                       ///< relative to max B
  double error_bound = 0;                    ///< of B, ∞-norm relative to max B
  double energy_balance_defect = 0;          ///< relative to what is emitted, worst band
  std::optional<double> closure_max_defect;  ///< none where the scene is open
  std::uint64_t covered_points = 0;
  std::optional<double> reciprocity_max_defect;  ///< of pairs integrated anew; none where none was
  double B_min = 0, B_max = 0;                   ///< of the elements, over all bands

  PairCounts pairs;
  std::map<std::string, std::uint64_t> predicate_stages;  ///< how many signs each stage decided
  Seconds seconds;
  std::uint64_t peak_memory_bytes = 0;
  std::vector<std::string> warnings;

  Manifest manifest;
  unsigned threads = 0;
  std::uint64_t seed = 0;
  std::string scene_hash;
  std::map<std::string, std::string> options;  ///< as given or by default
};

/// As JSON, indented, with a final newline. Numbers that are not finite become null.
std::string to_json(const Report& report);

/// Throws InputError when the file cannot be written.
void write_report(const std::filesystem::path& path, const Report& report);

/// Most memory this process has held so far [bytes].
std::uint64_t peak_memory_bytes();

}  // namespace exitance
