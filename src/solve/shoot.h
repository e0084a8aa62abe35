#pragma once
// Radiosity by shooting (Cohen, Chen, Wallace, Greenberg, "A progressive refinement approach to fast radiosity image
// generation", SIGGRAPH 1988): one column of form factors at a time, no matrix needed.

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "src/output/checkpoint.h"
#include "src/output/progress.h"
#include "src/solve/radiosity_system.h"

namespace exitance {

/// Fills F[e] and F_error[e], form factor from every element e to the patch and a bound of its error. Both come zeroed.
/// Asked again when a patch shoots again. False: it was stopped, and the column is not whole; then nothing is shot any
/// more.
using ShootColumn = std::function<bool(std::size_t patch, std::span<double> F, std::span<double> F_error)>;

/// Columns read from the transposed (patches × elements) rows of the elements; `transposed` must outlive the result.
ShootColumn column_of(const FormFactorMatrix& transposed);

struct ShootOptions {
  double tolerance = 1e-12;  ///< of ‖B − B*‖∞ relative to max |B|, each band; > 0
  std::uint64_t max_shots = UINT64_MAX;
  Progress progress = {};           ///< fraction by the logarithm of the unshot energy
  std::function<bool()> stop = {};  ///< asked between shots: true ends the work with what there is; may be empty
  /// Whether to ask for the columns of patches that never shot, too, once nothing is left to shoot.
  bool all_columns = false;
  /// Where the state is kept every so many seconds, and when `stop` ends the work, and from where it goes on with the
  /// same bits; may be null. It belongs to the same discretisation, form factors and options. A state that is damaged
  /// is forgotten.
  Checkpoint* checkpoint = nullptr;
  double save_seconds = 2;  ///< or more, where saving takes long (SavePace)
};

struct ShootSolution {
  Solution patches;                          ///< iterations: the shots
  std::vector<double> element_H, element_B;  ///< each element and band
  std::vector<double> element_row_sum;       ///< Σ F of each element, over the columns that were asked for
  bool all_columns_known = false;
  std::vector<double> unshot;  ///< what each patch (and band) still had to shoot: the residual of what was shot
  /// What the errors of the form factors add to error_bound, relative to max |B|, worst band (as in error_bound.h).
  double form_factor_error = 0;
};

/// Always shoots the patch with the most unshot energy: area times |unshot B|, of three bands the luminance
/// 0.2126 R + 0.7152 G + 0.0722 B, of any other number the sum; of equals the first. Elements receive, and a patch's B
/// is the area mean of theirs.
///
/// The exitance shot so far solves the system but for exactly the unshot one, so ‖B − B*‖∞ ≤ ‖unshot‖∞ / (1 − max ρ),
/// rounding added; it stops when that is within the tolerance, when only rounding is left, at max_shots or when `stop`
/// says so (`converged` is false then). That rows of F sum to at most 1 is part of the bound and cannot be checked
/// before all columns are known: throws InvalidSystem as soon as those seen sum to more than 1 plus their errors (and
/// row_sum_rounding) in
/// some element. Throws std::invalid_argument on a tolerance that is not positive. Any number of threads gives the same
/// bits.
ShootSolution shoot(const Discretisation& discretisation, const ShootColumn& column, const ShootOptions& options = {});

/// Ambient exitance estimate of each band (Cohen et al.): what the unshot energy becomes by all its
/// reflections when spread evenly, Σ A unshot / Σ A / (1 − Σ A ρ / Σ A). For display only: show B_p + ρ_p · ambient.
std::vector<double> ambient_estimate(const Discretisation& discretisation, std::span<const double> unshot);

}  // namespace exitance
