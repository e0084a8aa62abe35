// Lines along which a receiver's view changes: what doubles say of them against rational arithmetic.

#include "src/form_factor/sight_plane.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "src/stress/placement.h"
#include "tests/geometry/rational_points.h"

namespace exitance {
namespace {

Q dot(const Point& a, const Point& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Where the line through two points meets the receiver, along the trace from the first one on.
Q foot(const CutPlane& receiver, const Vec3& along, const Vec3& pivot, const Vec3& end) {
  const Point n = exact(receiver.normal), way = exact(end) - exact(pivot);
  return -dot(n, exact(pivot) - exact(receiver.point)) / dot(n, way) * dot(exact(along), way);
}

/// EventReach lengthens what is left of a trace by 1e-9 of the receiver's size, so that rounding hides nothing: it may
/// be no worse where the scene is as much as 1,000 times as large and the foot lies on the receiver or beside it.
TEST(SightPlane, FeetOfLinesOfSightAreWithinWhatReachesAreWidenedBy) {
  constexpr double kSize = 1, kWidened = 1e-9;
  Random random("sight planes");
  for (const double reach : {1.0, 30.0, 1000.0}) {
    double worst = 0;
    int asked = 0;
    for (int k = 0; k < 3000; ++k) {
      const Placement turn = random_rotation("turn", {}, 1, random);
      // The pivot, and an edge above it or below it, from where lines of sight come down on the receiver.
      const auto on_receiver = [&] { return Vec3{random.real(-kSize, kSize), random.real(-kSize, kSize), 0}; };
      const Vec3 pivot = on_receiver() + random.real(0.1, reach) * Vec3{random.real(-1, 1), random.real(-1, 1), 1};
      const bool beyond = random.whole(0, 1) == 0;
      std::array<Vec3, 2> edge;
      for (Vec3& end : edge) {
        const Vec3 to_pivot = pivot - on_receiver();
        const double share = beyond ? random.real(1.01, 3) : random.real(0.1, 0.99);
        end = pivot + (share - 1) * to_pivot;
      }
      const CutPlane receiver{normalized(turn.w), turn(on_receiver())};
      const Vec3 v = turn(pivot), a = turn(edge[0]), b = turn(edge[1]), normal = cross(a - v, b - v);
      if (norm(normal) < 1e-3 * norm(a - v) * norm(b - v)) continue;
      const SightPlane sight(receiver, {normal, v}, 1e-12);
      const LineStretch found = sight.through(sight.place_of(v), sight.place_of(a), sight.place_of(b),
                                              beyond ? SightPlane::Order::beyond : SightPlane::Order::before);
      const Q one = foot(receiver, sight.along(), v, a), other = foot(receiver, sight.along(), v, b);
      const Q errors[] = {Q(found.from) - std::min(one, other), Q(found.to) - std::max(one, other)};
      for (const Q& error : errors) worst = std::max(worst, std::fabs(CGAL::to_double(error)));
      ++asked;
    }
    EXPECT_LT(worst, kWidened * kSize) << "in a scene of " << reach << " times the receiver's size";
    EXPECT_GT(asked, 1000) << reach;
  }
}

}  // namespace
}  // namespace exitance
