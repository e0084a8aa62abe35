#pragma once
// The exact answer to "what does a point see of a polygon" by another route than the kernel's: the occluders' shadows
// are constructed as polygons with rational corners in the source's plane and taken away by CGAL's Boolean set
// operations.

#include "src/form_factor/point_question.h"

namespace exitance {

struct OracleAnswer {
  long double F = 0;             ///< form factor, right to all its digits
  long double visible_area = 0;  ///< of the part of the source above the horizon that is not hidden [m²]; exactly 0
                                 ///< where all is hidden
  long double F_open = 0;        ///< what F would be without occluders
  bool is_all_seen = false;      ///< exactly: no occluder hides an area of what is above the horizon
};

/// Form factor from the point to the visible part of the front of the source. Takes milliseconds. A source seen from
/// behind or edge-on gives 0. REQUIRES: what `answer` (point_question.h) does not refuse.
OracleAnswer oracle_form_factor(const PointQuestion& question);

}  // namespace exitance
