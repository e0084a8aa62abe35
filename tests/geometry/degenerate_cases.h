#pragma once
// Questions "what does this point see of that polygon" in which everything touches, coincides or lies in line.

#include <string>
#include <vector>

#include "geometry/polygon.h"
#include "src/stress/visibility_oracle.h"

namespace exitance {

struct PointCase {
  std::string name;  ///< family/member/placement
  Vec3 point, normal;
  Polygon source;
  std::vector<Obstacle> occluders;
};

/// Every family in every placement: on the integer lattice, in a tilted lattice (as exact, but no plane is an axis'),
/// rotated with rounded coordinates, far from the origin, tiny and huge. Always the same list. A case whose rounding
/// left a polygon with a defect other than zero area is left out.
std::vector<PointCase> degenerate_cases();

}  // namespace exitance
