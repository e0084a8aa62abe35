#pragma once
// Whether elements of a closed scene see 1 in all, of those that need to.

#include <cstdint>

#include "src/form_factor/form_factor_matrix.h"
#include "src/scene/patch_mesh.h"

namespace exitance {

struct AreaClosure {
  double max_defect = 0;         ///< largest |Σ_q F_eq − 1| of the elements that are judged; 0 in an open scene
  double largest_row_error = 0;  ///< Σ_q F_error of the worst row: what closure may miss
  /// Elements that are not judged: what lies in their own plane covers them, wholly or in part, or might; or they lack
  /// more of 1 than their errors, and some point of theirs sees the back of a surface, or what only obstructs, of which
  /// rows tell nothing.
  std::uint64_t not_judged = 0;
};

/// Of rows of all elements of the mesh, which is of the soup's scene. Of an open scene only what may be covered counts.
/// Points are 9 a cell of an element: where all of them miss a back, what an element sees of it counts as a defect.
AreaClosure area_closure(const PatchMesh& mesh, const PolygonSoup& soup, const FormFactorMatrix& rows, bool closed);

}  // namespace exitance
