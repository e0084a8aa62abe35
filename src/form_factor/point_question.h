#pragma once
// Single questions: what reaches a point from a polygon past some obstacles.

#include <string>
#include <vector>

#include "geometry/polygon.h"
#include "geometry/polygon_soup.h"
#include "geometry/viewpoint.h"
#include "src/form_factor/exact_scale.h"

namespace exitance {

/// What only obstructs: a sheet of polygons, or the outward faces of a closed polyhedron.
struct Obstacle {
  std::vector<Polygon> faces;
  bool solid = false;
};

/// The polygons of one question and how they take part; what has no area counts for nothing.
struct QuestionScene {
  std::vector<Polygon> polygons;
  std::vector<Role> roles;

  /// Takes the polygon unless its area is zero. Throws std::invalid_argument ("name: what is wrong") on other defects.
  /// Returns whether it was taken.
  bool add(const Polygon& polygon, Role role, const std::string& name);
  /// Adds every face, divided by 2^exponent, under the name "occluders[k]".
  void add(const std::vector<Obstacle>& obstacles, int exponent = 0);
};

struct PointQuestion {
  Vec3 point, normal;  ///< the normal has any length but zero
  Polygon source;
  std::vector<Obstacle> occluders;
};

/// A question of the same F whose coordinates were divided by 2^exponent, and those of its normal by another power of
/// two, so that products of them neither overflow nor vanish.
struct ScaledQuestion {
  PointQuestion question;
  int exponent = 0;
};

/// Throws std::invalid_argument when the coordinates span too many orders of magnitude (ExactScale).
ScaledQuestion scaled_near_one(PointQuestion question);

struct PointAnswer {
  double F = 0;
  double F_error = 0;  ///< proven bound of |F − true F|
  /// Open or blocked where every facet of the source that faces the point is.
  Visibility visibility = Visibility::away;
  StageCounts stages;          ///< how the predicates were decided
  std::uint64_t extended = 0;  ///< facets that double precision could not answer to the tolerance
};

/// Form factor from the point to the front of the source. Coordinates may have any size that doubles have. A source or
/// an occluder of zero area counts for nothing. `tolerance`: the F_error beyond which extended precision is asked; what
/// can be proven then is in F_error. Throws std::invalid_argument on a zero normal, a number that is not finite, and
/// polygons with defects (find_defect), naming the part: "source", "occluders[3]".
PointAnswer answer(const PointQuestion& question, double tolerance);

}  // namespace exitance
