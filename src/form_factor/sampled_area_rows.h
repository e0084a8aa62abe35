#pragma once
// Rows of form factors averaged over elements, by rays.

#include <vector>

#include "src/form_factor/form_factor_matrix.h"
#include "src/form_factor/pair_form_factor.h"
#include "src/output/progress.h"
#include "src/scene/patch_mesh.h"
#include "src/visibility/ray_options.h"
#include "src/visibility/visibility.h"

namespace exitance {

/// Like area_rows: elements × patches; or patches × patches, each as a whole.
struct SampledAreaRows {
  FormFactorMatrix F;  ///< F_error is 1, the only bound that rays have
  /// One for each F: what SampledFormFactor and HemisphereHits say of it; infinite for Estimator::centre. Of patches as
  /// a whole only: rows of elements have none.
  std::vector<double> standard_error;
  /// covered_points: receivers that may be covered, as in AreaRows; the others count for closure.
  PointRowStatistics statistics;
};

/// Shadow rays go between points spread over both of a pair, each pair once, so that A_i F_ij = A_j F_ji; they are
/// weighed against the contour integral, without occluders, of the pair. Estimator::hemisphere starts its rays from
/// points spread over the receiver, row by row. In parallel; any number of threads gives the same bits. The mesh must
/// be of the soup's scene. Throws std::invalid_argument on options out of range, std::runtime_error when Embree fails.
SampledAreaRows sampled_area_rows(const PatchMesh& mesh, const PolygonSoup& soup, ExchangeScene::Unit receivers,
                                  const RayOptions& options, const Progress& progress = {});

}  // namespace exitance
