#include "src/links/link_sight.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/links/cluttered_room.h"

namespace exitance {
namespace {

/// Whether the line passes through the inside of a box that is no room, by more than rounding: slabs of the box that
/// was turned, found again by turning back.
bool crosses_a_box(const Scene& turned_back, const Vec3& a, const Vec3& b) {
  for (std::size_t s = 6; s < turned_back.surfaces.size(); s += 6) {
    Box box;
    for (std::size_t f = s; f < s + 6; ++f) {
      for (const Vec3& v : turned_back.surfaces[f].polygon.outer) box.extend(v);
    }
    double from = 0, to = 1;
    for (int axis = 0; axis < 3; ++axis) {
      const double d = b[axis] - a[axis];
      const double low = (box.lower[axis] + 1e-9 - a[axis]) / d, high = (box.upper[axis] - 1e-9 - a[axis]) / d;
      from = std::max(from, std::min(low, high));
      to = std::min(to, std::max(low, high));
    }
    if (from < to && (from > 0 || to < 1)) return true;  // else nothing of its surface lies between
  }
  return false;
}

// What is inherited from the links above against lines drawn through the boxes, and the value against a search of the
// whole scene from each point.
TEST(LinkSight, IsNeverWronglyOpenOrBlocked) {
  std::mt19937_64 random(3);
  std::size_t open = 0, blocked = 0, partial = 0;
  for (int k = 0; k < 60; ++k) {
    const double degrees = k % 3 == 0 ? 0 : 37;
    std::mt19937_64 again = random;
    EditedScene scene(cluttered_room(random, k % 2 == 0, degrees));
    const Scene straight = cluttered_room(again, k % 2 == 0, 0);
    const Placement back{rotation({1, 2, 2}, -degrees), {}};
    const Obstacles obstacles(scene);
    const PatchTree tree(scene, obstacles.soup(), {{}, 0.02});
    LinkSight sight(tree, obstacles, 2);
    Viewpoint view(obstacles.soup());
    for (int pair = 0; pair < 60; ++pair) {
      std::uint32_t p = tree.root(static_cast<std::uint32_t>(random() % tree.roots().size())).node_first;
      std::uint32_t q = tree.root(static_cast<std::uint32_t>(random() % tree.roots().size())).node_first;
      if (!face_each_other(tree.node(p), tree.node(q), obstacles.soup())) continue;
      Sight s = sight.between_roots(p, q);
      for (int step = 0; step < 8; ++step) {
        const Node &to = tree.node(p), &from = tree.node(q);
        if (s.state == Sight::State::partial) {
          const Sight alone = step == 0 ? s : sight.between_roots(p, q);
          // What touches a shaft's boundary but for rounding is another matter (LinkSight).
          if (degrees == 0) {
            ASSERT_TRUE(std::ranges::equal(sight.items(s), sight.items(alone)));
          }
          if (step > 0) sight.forget(alone);
        }
        ++(s.state == Sight::State::open ? open : s.state == Sight::State::blocked ? blocked : partial);
        // On a lattice a later face in the same plane may cover all of an end, which no line tells.
        const bool told = s.state == Sight::State::open || (s.state == Sight::State::blocked && k % 2 == 1);
        for (int line = 0; line < 40 && told; ++line) {
          const Vec3 a = point_of(to, random), b = point_of(from, random);
          const Vec3 ab = b - a, n = obstacles.soup().facets()[to.facet].plane.normal,
                     m = obstacles.soup().facets()[from.facet].plane.normal;
          if (dot(n, ab) < 1e-6 * norm(n) || dot(m, ab) > -1e-6 * norm(m)) continue;
          // The ends lie on boxes and walls: what lies between them is asked.
          const bool hidden = crosses_a_box(straight, back(a + 1e-7 * ab), back(b - 1e-7 * ab));
          ASSERT_EQ(hidden, s.state == Sight::State::blocked) << k << ", " << pair << ", " << step;
        }
        const double value =
            s.state == Sight::State::open ? sight.form_factor(p, q) : sight.visible_form_factor(p, q, s);
        std::vector<NodePoint> points;
        node_points(to, 2, points);
        double searched = 0;
        for (const NodePoint& x : points) {
          view.look_from({x.at, obstacles.soup().facets()[to.facet].plane.normal, to.facet});
          const PointFormFactor f = view.form_factor(source_of(from), 1e-11);
          if (f.side == Side::front) searched += x.weight * f.F;
        }
        // Of faces in one plane but for rounding, either may lie on top.
        if (k % 2 == 1 || degrees == 0) {
          ASSERT_NEAR(value, searched, 1e-10) << k << ", " << pair << ", " << step;
        }
        const bool down = to.has_children() && (random() % 2 || !from.has_children());
        if (!down && !from.has_children()) break;
        (down ? p : q) = (down ? to : from).first_child + static_cast<std::uint32_t>(random() % 4);
        if (!face_each_other(tree.node(p), tree.node(q), obstacles.soup())) break;
        s = sight.between(p, q, s);
      }
    }
  }
  EXPECT_GT(open, 1000u);
  EXPECT_GT(blocked, 50u);
  EXPECT_GT(partial, 1000u);
}

}  // namespace
}  // namespace exitance
