#pragma once
// Ways to get a form-factor matrix that are compared with each other.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "src/form_factor/form_factor_matrix.h"
#include "src/form_factor/pair_form_factor.h"
#include "src/output/progress.h"
#include "src/scene/patch_mesh.h"
#include "src/visibility/ray_options.h"

namespace exitance {

enum class Maker : std::uint8_t { exact, shadow_rays, hemisphere_rays, unknown };

/// One way, and its name in results.
struct Contender {
  std::string name;
  std::variant<PairOptions, RayOptions, std::filesystem::path> how;  ///< exact, by rays, or what another program made

  Maker maker() const;
};

/// What it made and what that took.
struct ContenderRun {
  FormFactorMatrix F;                    ///< patches × patches
  std::uint64_t rays = 0;                ///< that were cast
  std::uint64_t queries = 0;             ///< exact ones, from points
  std::optional<double> standard_error;  ///< of rays, as they claim it: mean over their form factors; none of one ray
  std::vector<double> standard_errors;   ///< the same of each F; empty where nothing is claimed
  double seconds = 0;                    ///< by the clock on the wall
  double cpu_seconds = 0;                ///< of all threads
};

/// Area-averaged form factors between the patches of a mesh, its own preparations included in the time. `exchange`
/// holds the mesh's patches. Throws what the way throws; InputError for a file whose rows are not the mesh's patches,
/// LimitError when `stop` (may be empty) says so.
ContenderRun run(const Contender& contender, const PatchMesh& mesh, const ExchangeScene& exchange,
                 const Progress& progress, const std::function<bool()>& stop);

}  // namespace exitance
