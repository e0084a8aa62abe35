#pragma once
// Form factors from the sample points of elements to all patches, by exact visibility.

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/viewpoint.h"
#include "src/form_factor/form_factor_matrix.h"
#include "src/output/progress.h"
#include "src/scene/patch_mesh.h"
#include "src/visibility/pair_counts.h"

namespace exitance {

struct PointRowStatistics {
  PairCounts pairs;
  StageCounts stages;
  std::uint64_t extended = 0;  ///< pairs that needed extended precision
  /// Points that see no front of anything: covered by, or buried in, a contact, which may hold up to rounding (2^-49 of
  /// the extent). They have no closure defect.
  std::uint64_t covered_points = 0;
  /// Largest |front + back − 1| of all points that see something, front and back sides of patches and of surfaces that
  /// only obstruct: the defect of a closed scene, without meaning in an open one.
  double closure_max_defect = 0;

  PointRowStatistics& operator+=(const PointRowStatistics& other);
};

struct PointRows {
  FormFactorMatrix F;  ///< elements × patches; only what exceeds its error
  PointRowStatistics statistics;
};

/// Proven error that double precision must reach, else extended precision is asked. True errors are about a thousandth
/// of it: a source behind hundreds of occluders has hundreds of arcs, each with its own worst case.
inline constexpr double kPointTolerance = 1e-11;

/// Rows of the elements `first` … `last` − 1. In parallel; any number of threads gives the same bits. The mesh must be
/// of the soup's scene (make_patch_mesh).
PointRows point_rows(const PatchMesh& mesh, const PolygonSoup& soup, std::size_t first, std::size_t last,
                     const Progress& progress = {});

/// The statistics of the rows of some elements, in any order; the rows are not kept. In parallel; any number of threads
/// gives the same. An element that is named twice counts twice.
PointRowStatistics point_row_statistics(const PatchMesh& mesh, const PolygonSoup& soup,
                                        std::span<const std::size_t> elements, const Progress& progress = {});

/// Form factor F[e] from every element to one patch, with error bounds: a column, for shooting without a matrix.
void point_column(const PatchMesh& mesh, const PolygonSoup& soup, std::size_t patch, std::span<double> F,
                  std::span<double> F_error);

/// Form factor from the elements of one patch, averaged by area, to another patch: the pair integrated anew.
PointFormFactor patch_form_factor(const PatchMesh& mesh, const PolygonSoup& soup, std::size_t receiver,
                                  std::size_t source);

/// Entries of a row expected per element, from a sample of at most 8 elements and 4,096 patches, spread evenly: for
/// estimates of memory. Between 0 and patches.
double expected_row_length(const PatchMesh& mesh, const PolygonSoup& soup);

}  // namespace exitance
