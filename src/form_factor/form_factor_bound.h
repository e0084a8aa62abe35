#pragma once
// How large a form factor can be at most, whatever stands between.

#include <vector>

#include "geometry/viewpoint.h"
#include "src/form_factor/area_cell.h"

namespace exitance {

/// Bound of the form factor from any point of a cell to a source: its area seen from its least distance, cosines being
/// at most height over distance; never more than 1, which it is where they may touch.
class FormFactorBound {
 public:
  /// Receiver and source: pieces of two facets, convex.
  FormFactorBound(const PolygonSoup& soup, const Source& receiver, const Source& source);

  /// Proven but for rounding, for which 1 % is added. The cell lies in the receiver's plane.
  double from(const AreaCell& cell) const;

 private:
  double distance_from(const Vec3& x) const;

  CutPlane plane_;  ///< of the source, normal of unit length
  std::vector<Vec3> loop_;
  double area_ = 0, highest_ = 0;  ///< of the source; highest_: above the receiver's plane [m]
};

}  // namespace exitance
