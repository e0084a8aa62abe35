#pragma once
// Forms of a question that what is known of its answer follows from, drawn at random.

#include <algorithm>
#include <vector>

#include "geometry/facets.h"
#include "src/stress/placement.h"
#include "src/stress/question.h"

namespace exitance {

/// Empty where a form does not apply.
using Forms = std::vector<Question>;

/// Occluders in another order.
Forms permuted(const Question& question, Random& random);
/// One sheet cut in two, from the middle of an edge where that is a point of doubles.
Forms split(const Question& question, Random& random);
/// One occluder twice.
Forms duplicated(const Question& question, Random& random);
/// All sheets turned over that are cut into the same facets then.
Forms reversed_sheets(const Question& question, Random& random);
/// All occluders as triangles.
Forms triangulated(const Question& question, Random& random);
/// The faces of solids by themselves, which differ from the solids only where one of them lies in the plane of the
/// source or the receiver: empty there.
Forms as_sheets(const Question& question, Random& random);
/// Scaled by a power of two, the normal by another one; without rounding.
Forms scaled(const Question& question, Random& random);
/// Moved without rounding.
Forms translated(const Question& question, Random& random);
/// Polygons that are cut into the same facets then from another vertex on.
Forms renumbered(const Question& question, Random& random);
/// One more triangle, with corners half way from the point to corners of the others, or at them.
Forms added(const Question& question, Random& random);
/// A question for each triangle of the source; of areas only where the source is planar, as facets of a bent one may
/// hide each other.
Forms pieces(const Question& question, Random& random);
/// Receiver and source exchanged.
Forms swapped(const Question& question, Random& random);

/// Changes each vertex, and the point.
template <class Change>
void change_points(Question& question, const Change& change) {
  const auto change_all = [&](Loop& loop) { std::ranges::for_each(loop, change); };
  const auto change_loops = [&](Polygon& polygon) {
    change_all(polygon.outer);
    std::ranges::for_each(polygon.holes, change_all);
  };
  change(question.point);
  change_loops(question.receiver);
  change_loops(question.source);
  for (Obstacle& obstacle : question.occluders) {
    for (Polygon& face : obstacle.faces) change_loops(face);
  }
}

}  // namespace exitance
