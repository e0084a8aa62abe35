#pragma once
// Single questions: what reaches a point from a polygon past some obstacles.

#include <string>
#include <vector>

#include "geometry/polygon.h"
#include "geometry/polygon_soup.h"
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
  void add(const std::vector<Obstacle>& obstacles, int exponent);
};

struct PointQuestion {
  Vec3 point, normal;  ///< the normal has any length but zero
  Polygon source;
  std::vector<Obstacle> occluders;
};

struct PointAnswer {
  double F = 0;
  double F_error = 0;  ///< proven bound of |F − true F|
};

/// Form factor from the point to the front of the source. Coordinates may have any size that doubles have. A source or
/// an occluder of zero area counts for nothing. `tolerance`: the F_error beyond which extended precision is asked; what
/// can be proven then is in F_error. Throws std::invalid_argument on a zero normal, a number that is not finite, and
/// polygons with defects (find_defect), naming the part: "source", "occluders[3]".
PointAnswer answer(const PointQuestion& question, double tolerance);

}  // namespace exitance
