#include "src/form_factor/edge_event.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "src/form_factor/pole.h"
#include "src/stress/placement.h"
#include "tests/geometry/solids.h"

namespace exitance {
namespace {

SeenEdge edge(std::uint64_t id, const Vec3& a, const Vec3& b) {
  return {id, a, b, normalized(a), normalized(b)};
}

/// Three edges above the unit square at z = 0, each met by the line of sight from `x` along `d`.
std::array<SeenEdge, 3> edges_met(Random& random, const Vec3& x, const Vec3& d) {
  std::array<SeenEdge, 3> edges;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 on = x + (0.5 + 0.4 * static_cast<double>(k)) * d,
               along{random.real(-1, 1), random.real(-1, 1), random.real(-0.3, 0.3)};
    edges[k] = edge(k + 2, on - along, on + 0.7 * along);
  }
  return edges;
}

TEST(EdgeEvent, HoldsWhereOneLineOfSightMeetsAllThree) {
  Random random("edge event");
  for (int k = 0; k < 50; ++k) {
    const Vec3 x{random.real(0, 1), random.real(0, 1), 0}, d{random.real(-1, 1), random.real(-1, 1), 1};
    const EdgeEvent event(edges_met(random, x, d));
    const double slope = std::fabs(event.at(x + Vec3{0.5, 0, 0})) + std::fabs(event.at(x + Vec3{0, 0.5, 0}));
    EXPECT_LE(std::fabs(event.at(x)), 1e-13 * (1 + slope)) << k;
    EXPECT_FALSE(event.plane());
  }
}

TEST(EdgeEvent, IsStraightWhereTwoEdgesShareAVertex) {
  const Vec3 v{0.25, 0.5, 1};
  const EdgeEvent event(
      std::array{edge(2, v, {1, 1, 1.5}), edge(3, {0, 2, 1}, v), edge(4, {-1, 0.25, 0.5}, {2, 0.5, 0.5})});
  ASSERT_TRUE(event.plane());
  EXPECT_EQ(event.plane()->at(v), 0);
  EXPECT_EQ(event.plane()->at({-1, 0.25, 0.5}), 0);
  EXPECT_EQ(event.plane()->at({2, 0.5, 0.5}), 0);
}

/// A cell is cut in pieces that fill it, each on one side of the event, and so are the pieces along another event.
TEST(EdgeEvent, PiecesOfACellLieOnOneSide) {
  Random random("pieces");
  int cuts = 0, bent = 0;
  for (int k = 0; k < 200; ++k) {
    const bool turn = k % 2 == 1;
    const Vec3 x{random.real(0.2, 0.8), random.real(0.2, 0.8), 0};
    auto edges = edges_met(random, x, {random.real(-1, 1), random.real(-1, 1), 1});
    const auto place = [&](const Vec3& p) { return turn ? turned(p) : p; };
    for (SeenEdge& e : edges) e = edge(e.id, place(e.a), place(e.b));
    const EdgeEvent event(edges);
    AreaCell cell{{place({0, 0, 0}), place({1, 0, 0}), place({1, 1, 0}), place({0, 1, 0})}, k % 3 == 0 ? 3 : 4};
    const std::vector<AreaCell> parts = cut(cell, event);
    if (parts.empty()) continue;
    ++cuts;
    double area = 0;
    for (const AreaCell& part : parts) {
      std::vector<WeightedPoint> points;
      gauss_points(part, 12, points);
      double side = 0;
      for (const WeightedPoint& p : points) {
        area += p.weight;
        const double value = event.at(p.point);
        EXPECT_GE(value * side, 0) << k;
        side = value;
      }
      bent += !part.is_straight();
      const auto [one, other] = bisect(part);
      EXPECT_NEAR(one.area() + other.area(), part.area(), 1e-4 * cell.area()) << k;
    }
    EXPECT_NEAR(area, cell.area(), 1e-10) << k;
  }
  EXPECT_GE(cuts, 100);
  EXPECT_GE(bent, cuts);
}

TEST(CrossingPole, GrowsTowardsParallelEdgesAndIsNoneInOnePlane) {
  const AreaCell cell{{Vec3{0, 0, 0}, Vec3{0.1, 0, 0}, Vec3{0.1, 0.1, 0}, Vec3{0, 0.1, 0}}, 4};
  // Seen from y = (0.01 + turn) / 0.2, e is parallel to the plane through g.
  const auto error = [&](double turn) {
    const SeenEdge g = edge(3, {-1, 0.05 + turn, 0.4}, {1, 0.05 - turn, 0.6});
    SeenEdge e = edge(2, {-1, 0.05, 1}, {1, 0.05, 1});
    e.to = g.to;
    return crossing_poles(std::array{e, g}, cell, 5).error;
  };
  EXPECT_EQ(error(0), 0);
  EXPECT_GT(error(0.2), 0);
  EXPECT_GT(error(0.02), 100 * error(0.2));
}

/// ∫ of what an edge from the origin contributes over a cell that begins beside the origin: rules of low order see
/// nothing of what happens there. Truth by rules of high order over a graded cell.
TEST(CornerPole, BoundsWhatRulesMissBesideACorner) {
  const SeenEdge e = edge(1, {0, 0, 0}, {-0.3, 0.1, 1});
  const auto contribution = [&](const Vec3& x) {
    const Vec3 p = e.a - x, q = e.b - x, m = cross(p, q);
    return std::atan2(norm(m), dot(p, q)) * m.z / norm(m);
  };
  const auto integral = [&](const AreaCell& cell, int order) {
    std::vector<WeightedPoint> points;
    gauss_points(cell, order, points);
    double sum = 0;
    for (const WeightedPoint& p : points) sum += p.weight * contribution(p.point);
    return sum / 6.283185307179586;
  };
  for (const bool turn : {false, true}) {
    for (const double d : {1e-3, 1e-2}) {
      const auto cell = [&](double from, double to) {
        const auto at = [](double s, double t) { return Vec3{s, 0.3 * s + t * s, 0}; };
        AreaCell c{{at(from, 0), at(to, 0), at(to, 0.5), at(from, 0.5)}, 4};
        if (turn) std::ranges::rotate(c.corner, c.corner.begin() + 1);
        for (Vec3& v : c.corner) v = v + Vec3{0, 0.5 * d, 0};
        return c;
      };
      double truth = 0;
      for (double from = d; from < 1; from *= 2) truth += integral(cell(from, std::min(2 * from, 1.0)), 16);
      const Vec3 x{0.5, 0.3, 0};
      SeenEdge seen = e;
      seen.from = (1 / norm(e.a - x)) * (e.a - x);
      seen.to = (1 / norm(e.b - x)) * (e.b - x);
      for (const int order : {4, 6, 8, 10}) {
        const AreaCell whole = cell(d, 1);
        const double error = std::fabs(integral(whole, order) - truth),
                     bound = corner_poles(std::array{seen}, x, {}, whole, order).error;
        EXPECT_GE(bound, error) << d << ' ' << order;
        EXPECT_LE(bound, 1e4 * error) << d << ' ' << order;
      }
    }
  }
}

/// A triangle as a quadrilateral whose second corner is its third, too.
TEST(CornerPole, OfACellWithTwoCornersInOnePoint) {
  const SeenEdge e = edge(1, {-0.01, 0, 0}, {-0.3, 0.1, 1});
  const Vec3 x{0.5, 0.3, 0};
  SeenEdge seen = e;
  seen.from = (1 / norm(e.a - x)) * (e.a - x);
  seen.to = (1 / norm(e.b - x)) * (e.b - x);
  const auto error = [&](const AreaCell& cell) { return corner_poles(std::array{seen}, x, {}, cell, 4).error; };
  const Vec3 a{0, 0, 0}, b{1, 0, 0}, c{0, 1, 0};
  EXPECT_GT(error({{a, b, b, c}, 4}), 0);
  EXPECT_NEAR(error({{a, b, b, c}, 4}), error({{b, c, a, a}, 4}), 1e-12);
}

/// Two edges of the outline that cross above (u, v) and a third one past the crossing: seen from z = 0, from where
/// u + v = 1.8, it comes to the crossing. A rule over the unit square looks from one side of that line only, but the
/// square's corner lies on the other.
TEST(HiddenEvents, InACornerThatNoPointOfARuleLooksFrom) {
  const AreaCell cell{{Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{1, 1, 0}, Vec3{0, 1, 0}}, 4};
  const Vec3 x{0.5, 0.5, 0}, meeting{0.5, 0.5, 1};
  SeenEdge e = edge(1, meeting - Vec3{1, 0, 0}, meeting + Vec3{1, 0, 0}),
           g = edge(2, meeting - Vec3{0, 1, 0} + Vec3{0, 0, 1e-9}, meeting + Vec3{0, 1, 0} + Vec3{0, 0, 1e-9});
  const Vec3 d = (1 / norm(meeting - x)) * (meeting - x);
  e.to = g.from = d;
  // At half the height it is met where (x + meeting) / 2 lies on it.
  const Vec3 on{0.7, 0.7, 0.5}, along{1, -1, 0.1};
  const auto past = [&](const Vec3& shift) {
    return hidden_events(std::array{e, g}, std::array{edge(3, on + shift - along, on + shift + along)}, x, cell);
  };
  const std::vector<HiddenEvent> found = past({});
  ASSERT_FALSE(found.empty());
  for (const HiddenEvent& hidden : found) {
    EXPECT_LT(hidden.event.at(x) * hidden.event.at(hidden.beyond), 0);
    EXPECT_GT(hidden.beyond.x + hidden.beyond.y, 1.7);
  }
  // Edges of occluders may run against the outline.
  std::swap(g.from, g.to);
  EXPECT_EQ(past({}).size(), found.size());
  std::swap(g.from, g.to);
  EXPECT_TRUE(past({0.2, 0.2, 0}).empty()) << "it passes outside of the cell";
  EXPECT_TRUE(past({3, -3, 0.3}).empty()) << "it ends before";
}

}  // namespace
}  // namespace exitance
