#pragma once
// From a scene to its radiosity: mesh, form factors, solution, and the numbers that tell how good it is.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "geometry/polygon_soup.h"
#include "src/form_factor/point_rows.h"
#include "src/output/checkpoint.h"
#include "src/output/progress.h"
#include "src/scene/patch_mesh.h"
#include "src/scene/scene.h"
#include "src/solve/gather.h"
#include "src/solve/radiosity_system.h"
#include "src/visibility/ray_options.h"

namespace exitance {

enum class Method : std::uint8_t {
  gather,  ///< the whole matrix, then its system (gather.h)
  shoot    ///< progressive refinement (shoot.h)
};

enum class Receivers : std::uint8_t {
  points,  ///< one sample point an element, as in George et al. 1990 (point_rows.h)
  area     ///< the mean over each element, integrated (area_rows.h); needs the whole matrix
};

struct SolveOptions {
  Method method = Method::gather;
  Receivers receivers = Receivers::points;
  double form_factor_tolerance = 1e-9;  ///< of the rows of receivers `area`: absolute; exact visibility only
  std::optional<RayOptions> rays;       ///< visibility by these; exact where there are none
  GatherMethod gather_method = GatherMethod::gauss_seidel;
  MeshOptions mesh;
  double tolerance = 1e-12;  ///< of the solver: bound of B's error relative to max B; > 0
  /// Most memory that form factors may take [bytes]. Gathering needs all of them. Shooting keeps them where they fit
  /// and no limit of its work was asked for, and computes each column when it is shot otherwise.
  std::uint64_t memory_limit = std::numeric_limits<std::uint64_t>::max();
  std::optional<std::uint64_t> max_shots;
  /// Asked often, from any thread: true, once and from then on, ends the work. May be empty.
  std::function<bool()> stop;
  bool stop_is_a_limit =
      false;               ///< whether `stop` is meant to end the work in time, so that shooting should begin at once
  std::uint64_t seed = 1;  ///< of the pairs whose reciprocity is measured
  Progress progress;

  /// Folder in which finished rows of form factors, or the state of shooting without a matrix, are kept, and found when
  /// the same work is begun again; empty: none. Rows of receivers `area` by rays are not.
  std::filesystem::path checkpoint = {};
  std::string key = {};    ///< what it all depends on, as a Checkpoint's; with another one the work begins anew
  double save_every = 30;  ///< seconds after which it is saved, or more where saving takes long (SavePace)
  std::function<void(const std::string&)> warn = {};  ///< told of what was kept and is of no use; may be empty
};

struct SceneSolution {
  explicit SceneSolution(PolygonSoup of_scene) : soup(std::move(of_scene)) {}

  PolygonSoup soup;
  PatchMesh mesh;
  Discretisation discretisation;
  bool closed = false;  ///< whether the scene's surfaces bound a volume (is_closed)

  Solution patches;
  std::vector<double> element_H, element_B;  ///< each element and band
  std::vector<double> element_row_sum;       ///< Σ_q F of each element; of the patches that shot, where `stopped`
  double form_factor_error = 0;              ///< what errors of form factors add to patches.error_bound
  /// Of each band, what shooting that was ended early had still to spread (ambient_estimate): for display only, where
  /// B + ρ · ambient is shown. Empty otherwise.
  std::vector<double> ambient;
  /// max_shots or `stop` ended the work before the tolerance was reached and all rows were known.
  bool stopped = false;

  Receivers receivers = Receivers::points;
  std::optional<RayOptions> rays;  ///< as asked
  /// Of `measured_points` elements: all of them, or a sample spread evenly where there is no matrix. Of receivers
  /// `area` the covered ones of a closed scene are those whose closure is not judged (AreaClosure).
  PointRowStatistics statistics;
  std::uint64_t measured_points = 0;
  double closure_error = 0;  ///< what errors of form factors allow of the closure defect; negligible for sample points
  /// Relative, worst band (error_bound.h). None where stopped before all columns were known.
  std::optional<double> energy_balance_defect;
  /// max |A_i F_ij − A_j F_ji| / min(A_i, A_j) of up to 64 random pairs that see each other, each F integrated anew
  /// over its own receiver. With sample points as receivers this shows the error of that quadrature, not of visibility.
  /// With receivers `area`: of up to 64 partial pairs of patches, integrated anew over both; not measured with rays.
  /// None where no such pair was found, or time was up.
  std::optional<double> reciprocity_max_defect;

  std::uint64_t resumed_rows = 0;  ///< of elements: those that the checkpoint held
  /// To be removed when the solution is saved, unless the work `may_go_on`. Null without SolveOptions::checkpoint.
  std::shared_ptr<Checkpoint> checkpoint;
  bool may_go_on = false;  ///< whether `stop` ended it

  double seconds_form_factors = 0, seconds_solve = 0;  ///< wall clock; shooting without a matrix is all `solve`
};

/// The materials and areas of a mesh of the scene.
Discretisation discretise(const Scene& scene, const PatchMesh& mesh);

/// Solves the scene. The same bits for any number of threads, and however often it was ended and begun
/// again with a checkpoint. REQUIRES: a scene as read_scene returns it.
/// Throws InputError for a scene in which no surface has an area, LimitError when the form factors of gathering would
/// not fit in memory_limit (the message tells how much they need) and when `stop` ends the work before there is any
/// solution (the message tells what is kept), InvalidSystem when form factors or materials are out of range,
/// std::invalid_argument for options that are.
SceneSolution solve_scene(const Scene& scene, const SolveOptions& options = {});

}  // namespace exitance
