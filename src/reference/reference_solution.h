#pragma once
// Reference solutions: a scene's radiosity, refined until it is known to a stated error.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "geometry/polygon_soup.h"
#include "src/form_factor/pair_form_factor.h"
#include "src/output/progress.h"
#include "src/reference/solution_record.h"
#include "src/scene/scene.h"

namespace exitance {

struct ReferenceOptions {
  double error = 1e-3;    ///< wanted of SolutionError::total; > 0
  double patch_size = 0;  ///< of the first mesh: longest edge of a patch [m]; 0: surfaces as they are
  std::uint64_t memory_limit = std::numeric_limits<std::uint64_t>::max();  ///< for mesh and form factors [bytes]
  /// Folder in which each level's rows of form factors are kept as they are finished, and found when the same work is
  /// begun again; empty: none. It is made, and removed when the error is reached and the solution was given to `saved`.
  std::filesystem::path checkpoint = {};
  std::string key = {};      ///< what else the rows depend on: version, compiler
  double block_seconds = 2;  ///< about how much work is put into a block of rows, after which it is saved
  std::function<bool()>
      stop;  ///< asked often, from any thread: true, once and from then on, ends the work; may be empty
  Progress progress;
};

/// One mesh on the way.
struct ReferenceLevel {
  std::uint32_t patches = 0, elements = 0;
  std::uint32_t new_elements = 0;  ///< that the level before did not have
  std::uint32_t resumed_rows = 0;  ///< of theirs, those that the checkpoint held
  std::uint64_t partial_pairs = 0;
  SolutionError error;
  /// Of equation 7, between the means of elements with polynomials of this degree and one less: how much of the mesh's
  /// error is in values, and not in what polynomials cannot follow.
  double means_error = 0;
  /// Largest |Σ F − 1| − Σ F_error, as a share of Σ F_error, over the rows that sum to more than 1: where it is above
  /// 0, errors of that row's form factors did not hold and were enlarged by it.
  double largest_excess = 0;
  double seconds_form_factors = 0, seconds_solve = 0;
};

enum class ReferenceEnd : std::uint8_t { reached, stopped, memory };

struct ReferenceSolution {
  SolutionRecord record;  ///< of the last level that was finished; manifest is the caller's
  std::vector<ReferenceLevel> levels;
  ReferenceEnd end = ReferenceEnd::reached;
  std::uint64_t bytes_needed = 0;  ///< by the level that did not fit, of memory_limit
};

/// Tolerances of form factors that fit an error wanted of the solution: the same for all errors of one decade, so that
/// work begun for one of them is of use for another.
PairOptions pair_options_for(double error);

/// Removes a checkpoint whose run has reached its error and was ended while it removed it itself; of others nothing.
void clear_finished_checkpoint(const std::filesystem::path& checkpoint);

/// Elements receive and shoot: form factors are those of all pairs of elements, averaged over both by integration
/// (pair_form_factor.h), and gathering solves for the means of B. B itself is a cubic polynomial on every patch of 16
/// elements, with which elements shoot better than constants do (PatchPolynomials::shooting_values): of a smooth B the
/// error falls with the fourth power of the patches' size, and its estimate with the third.
///
/// Its error in the norm of equation 7 (comparison.h), as a function of the point, is estimated patch by patch, in
/// squares: its distance to the same with quadratic polynomials, and one and a half of what gathering at points misses
/// (sampled_residual.h), which sees what the means of elements do not show, such as shadows that are small against
/// them. Patches that are not divided keep the latter. To this comes what errors of form factors can do, element by
/// element: the solution of the same system that their errors emit.
///
/// Patches with the largest share of the error are divided (RefinedMesh), along shadow boundaries first, until the
/// error is what is wanted; the other patches keep their form factors. All of it depends on scene and options only:
/// the same bits for any number of threads and however often the work was ended and begun again.
///
/// saved: given each level's solution before the next one is begun; may be empty. Ends early, with what there is, when
/// `stop` says so or the next level's form factors would not fit in memory_limit. Throws LimitError where that is the
/// first level, InputError for a scene in which no surface has an area or a checkpoint of other work,
/// std::invalid_argument for an error that is not positive. A scene without light has the solution 0, without error.
ReferenceSolution solve_reference(const Scene& scene, const PolygonSoup& soup, const ReferenceOptions& options,
                                  const std::function<void(const ReferenceSolution&)>& saved = {});

}  // namespace exitance
