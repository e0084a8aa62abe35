#pragma once
// What makes a rule over a cell converge slowly although nothing happens within: crossings of edges that are nearly
// parallel as seen from there.

#include <span>

#include "geometry/viewpoint.h"
#include "src/form_factor/area_cell.h"

namespace exitance {

struct PoleError {
  double error = 0;  ///< of a rule's integral [m²]
  double fall = 0;   ///< at most 1: of the error of the worst crossing, from one order to the next
};

/// Seen from x, edge e crosses edge g at the parameter N(x) / M(x) of e, both linear in x; M is 0 where e is parallel
/// to the plane through x and g. Where that line runs past a cell, the form factor has a pole there that hides below
/// the falling coefficients of a rule until it alone is left: a share N²/M of what the triangle between both edges
/// contributes. With δ the pole's distance from the cell, in halves of the cell's width across, a rule of order n errs
/// by the pole's size times (1 + δ + √(δ² + 2δ))^-2n. Edges in one plane cross at one point: no pole.
PoleError pole_error(std::span<const SeenEdge> edges, const AreaCell& cell, int order);

}  // namespace exitance
