#pragma once
// Convex loops in the plane that everything is projected to along one direction (exchange_truth.h), in long double.

#include <vector>

#include "src/stress/truth_body.h"

namespace exitance::truth {

struct Spot {
  Real x = 0, y = 0;
};
using Area = std::vector<Spot>;

/// Positive where the loop runs counter-clockwise; 0 of fewer than three spots.
Real area(const Area& loop);

/// Positive left of the line a b: twice the area of a b p.
inline Real left(const Spot& a, const Spot& b, const Spot& p) {
  return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
}

/// Counter-clockwise, without spots on its sides, by monotone chains. Leaves `spots` sorted. REQUIRES: at least two.
void hull(std::vector<Spot>& spots, Area& out);

/// Cuts a convex loop along the line a b into what lies left of it and what lies right; empty where that has no area.
void split(const Area& loop, const Spot& a, const Spot& b, Area& inside, Area& outside);

}  // namespace exitance::truth
