#pragma once
// The stage on which degenerate questions are set up: the point is the origin and looks up, the source is a square of
// side 16 at height 16 that faces down, most occluders stand about height 8, on small whole numbers.

#include <array>
#include <vector>

#include "geometry/facets.h"
#include "src/form_factor/point_question.h"
#include "src/stress/placement.h"

namespace exitance {

using Points2 = std::vector<std::array<double, 2>>;

Loop at_height(double z, const Points2& points);
/// Counter-clockwise seen from above.
Loop rectangle(double z, double x0, double y0, double x1, double y1);
Loop reversed(Loop loop);
/// Corner, corner + u, corner + u + v, corner + v.
Loop parallelogram(const Vec3& corner, const Vec3& u, const Vec3& v);

Obstacle sheet(Loop loop);
/// Faces look out. REQUIRES: a < b in every coordinate.
Obstacle box(const Vec3& a, const Vec3& b);
Obstacle octahedron(const Vec3& centre, double radius);
Obstacle tetrahedron(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);
/// Over a polygon that runs counter-clockwise seen from above.
Obstacle prism(const Points2& base, double bottom, double top);

/// One question while it is set up.
class Stage {
 public:
  static constexpr double kSourceHeight = 16, kMiddle = 8, kHalfSource = 8;

  /// size: how far things are to be from the degenerate position.
  Stage(Random& random, double size);

  Random& random;
  const double size;
  PointQuestion question;

  int whole(int low, int high) { return random.whole(low, high); }
  bool coin() { return random.whole(0, 1) == 0; }
  double sign() { return coin() ? 1 : -1; }
  /// Whole numbers, not all 0.
  Vec3 step(int most);
  /// A point of the lattice that may stand between point and source.
  Vec3 between();

  void add(Obstacle obstacle) { question.occluders.push_back(std::move(obstacle)); }
  /// Front up or down.
  void add_sheet(Loop loop) { add(sheet(coin() ? std::move(loop) : reversed(std::move(loop)))); }
  void add_middle(double x0, double y0, double x1, double y1) { add_sheet(rectangle(kMiddle, x0, y0, x1, y1)); }
  /// A box of the lattice whose lower corner is `at`, its sides at most `most` long.
  void add_box(const Vec3& at, int most);
  /// A sheet or a box somewhere between.
  void add_something();
};

}  // namespace exitance
