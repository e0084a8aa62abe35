#pragma once
// result.json: what a solution was made of, how good it is, and what it took.

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "src/output/manifest.h"
#include "src/visibility/pair_counts.h"

namespace exitance {

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
  std::string method;      ///< "gather", "shoot", "hierarchical"
  std::string receivers;   ///< "points" or "area"
  std::string visibility;  ///< "exact" or "rays"
  /// Of visibility "rays".
  struct Rays {
    std::string sampler, estimator;
    std::uint64_t rays = 0, replicates = 0;  ///< of each pair, or of each hemisphere
    double offset = 0;                       ///< of the scene's radius
    std::uint64_t seed = 0;
    std::uint64_t cast = 0;                     ///< in all
    std::optional<double> mean_standard_error;  ///< of the form factors; none where nothing is known of it
  };
  std::optional<Rays> rays;

  /// Of method "hierarchical": what was linked, and how.
  struct Links {
    std::uint64_t sub_patches = 0;
    std::uint64_t active = 0, shadow = 0, ghost = 0;
    std::uint64_t environment = 0, mixed = 0, dynamic = 0;  ///< active and shadow: E-E, E-O and O-O
    std::uint64_t patch_pairs = 0;                          ///< pairs of whole patches that have links
    std::uint64_t clusters = 0, cluster_links = 0;          ///< groups of patches, and links between these
    std::uint64_t rounds = 0, bytes = 0;
    double cpu_seconds = 0;  ///< for all links and exchange, of all threads
    double eps1 = 0, eps2 = 0, smallest_area = 0;
  };
  std::optional<Links> links;

  bool converged = false;
  std::uint64_t iterations = 0;
  double residual = 0;            ///< relative to max B
  double error_bound = 0;         ///< of B, ∞-norm relative to max B: the solver's and the form factors'
  double solver_error_bound = 0;  ///< its first part: B* solves the system with the form factors as they are
  double form_factor_error = 0;   ///< its second part: what the errors of the form factors add
  /// Relative to what is emitted, worst band. None where the form factors were not complete.
  std::optional<double> energy_balance_defect;
  std::optional<double> closure_max_defect;  ///< none where the scene is open or nothing was measured
  std::uint64_t measured_points = 0;         ///< sample points for which closure, covered points and pairs were counted
  std::uint64_t covered_points = 0;
  std::uint64_t resumed_rows = 0;                ///< of form factors: those that an earlier run had made
  std::optional<double> reciprocity_max_defect;  ///< of pairs integrated anew; none where none was
  /// By band, of unit B: solution.ply and image.png show B + ρ · ambient where shooting was ended early; else empty.
  std::vector<double> ambient;
  double B_min = 0, B_max = 0;  ///< over all bands, of the elements that see something

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

}  // namespace exitance
