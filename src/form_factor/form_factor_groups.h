#pragma once
// Rows and columns of a form-factor matrix taken together: patches that are reported as one.

#include <cstdint>
#include <span>
#include <vector>

#include "src/form_factor/form_factor_matrix.h"

namespace exitance {

/// Which patches make up each row of a matrix of groups.
struct FormFactorGroups {
  std::vector<std::uint32_t> group_of;  ///< of each patch, in [0, count)
  std::uint32_t count = 0;
};

/// The groups in the order of their first patches. named: for each patch the group it says it belongs to, in any
/// numbers, or kNoGroup (scene.h) for one that stands for itself.
FormFactorGroups make_groups(std::span<const std::uint32_t> named);

/// F_GH = Σ_{g ∈ G} A_g Σ_{h ∈ H} F_gh / Σ_{g ∈ G} A_g: what leaves the patches of G together and reaches those of H.
/// Errors are added up likewise and enlarged by the rounding of these sums. matrix: square, a row and a column a patch;
/// area: of each, > 0 [m²]. Throws std::invalid_argument when the sizes do not fit.
FormFactorMatrix combine(const FormFactorMatrix& matrix, std::span<const double> area, const FormFactorGroups& groups);

}  // namespace exitance
