#include "geometry/polygon.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

namespace exitance {
namespace {

const std::vector<Vec3> kSquare{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}};

PolygonDefect defect(std::vector<Vec3> outer, std::vector<std::vector<Vec3>> holes = {}) {
  return find_defect({std::move(outer), std::move(holes)});
}

/// The flat loop in a tilted lattice plane: its points are exact there, so they stay exactly collinear.
std::vector<Vec3> tilted(std::vector<Vec3> loop) {
  for (Vec3& p : loop) p = p.x * Vec3{3, -1, 2} + p.y * Vec3{1, 4, -2} + Vec3{1e6, -7, 5};
  return loop;
}

TEST(FindDefect, AcceptsSimplePolygons) {
  EXPECT_EQ(defect(kSquare), PolygonDefect::none);
  EXPECT_EQ(defect({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}), PolygonDefect::none);
  EXPECT_EQ(defect({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {1, 1, 0}}), PolygonDefect::none) << "non-convex";
  EXPECT_EQ(defect({{0, 0, 0}, {4, 0, 0}, {4, 4, 1}, {0, 4, 0}}), PolygonDefect::none) << "not planar";
  EXPECT_EQ(defect(kSquare, {{{1, 1, 0}, {2, 1, 0}, {1, 2, 0}}, {{3, 3, 0}, {3, 2, 0}, {2, 3, 0}}}),
            PolygonDefect::none);
}

TEST(FindDefect, RepeatedAndCollinearVerticesAreNone) {
  EXPECT_EQ(defect({{0, 0, 0}, {0, 0, 0}, {2, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {0, 2, 0}, {0, 0, 0}}),
            PolygonDefect::none);
  EXPECT_EQ(defect({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}}), PolygonDefect::none);
}

TEST(FindDefect, NamesWhatIsNotFinite) {
  EXPECT_EQ(defect({{0, 0, 0}, {1, 0, 0}, {0, std::numeric_limits<double>::quiet_NaN(), 0}}),
            PolygonDefect::non_finite);
  EXPECT_EQ(defect({{0, 0, std::numeric_limits<double>::infinity()}}), PolygonDefect::non_finite) << "goes first";
  EXPECT_EQ(defect(kSquare, {{{1, 1, 0}, {2, 1, -std::numeric_limits<double>::infinity()}, {1, 2, 0}}}),
            PolygonDefect::non_finite);
}

TEST(FindDefect, CountsVertices) {
  EXPECT_EQ(defect({}), PolygonDefect::too_few_vertices);
  EXPECT_EQ(defect({{0, 0, 0}, {1, 0, 0}}), PolygonDefect::too_few_vertices);
  EXPECT_EQ(defect(kSquare, {{{1, 1, 0}, {2, 1, 0}}}), PolygonDefect::too_few_vertices);
}

TEST(FindDefect, ZeroAreaIsExact) {
  EXPECT_EQ(defect({{0, 0, 0}, {1, 1, 1}, {3, 3, 3}}), PolygonDefect::zero_area);
  EXPECT_EQ(defect({{1, 2, 3}, {1, 2, 3}, {1, 2, 3}}), PolygonDefect::zero_area);
  EXPECT_EQ(defect({{0, 0, 0}, {0, 0, 2}, {0, 0, 1}, {0, 0, 5}}), PolygonDefect::zero_area);
  // One bit off the line is an area, though its area vector vanishes in rounding.
  const double tenth_up = std::nextafter(0.1, 1);
  EXPECT_EQ(defect({{0, 0, 0}, {0.1, 0.1, 0}, {0.7, 0.7, 0}}), PolygonDefect::zero_area);
  EXPECT_EQ(defect({{0, 0, 0}, {0.1, tenth_up, 0}, {0.7, 0.7, 0}}), PolygonDefect::none);
  EXPECT_EQ(defect({{1e6, 1e6, 0}, {1e6 + 0.1, 1e6 + 0.1, 0}, {1e6 + 1, 1e6 + 1, 1e-300}}), PolygonDefect::none);
  EXPECT_EQ(defect({{0, 0, 0}, {1e-200, 0, 0}, {0, 1e-200, 0}}), PolygonDefect::none) << "underflow";
  EXPECT_EQ(defect({{0, 0, 0}, {1e200, 0, 0}, {0, 1e200, 0}}), PolygonDefect::none) << "overflow";
}

TEST(FindDefect, FindsSelfIntersections) {
  const std::vector<std::pair<const char*, std::vector<Vec3>>> cases{
      {"bow tie", {{0, 0, 0}, {4, 4, 0}, {4, 0, 0}, {0, 4, 0}}},
      {"pentagram", {{0, 3, 0}, {2, -3, 0}, {-3, 1, 0}, {3, 1, 0}, {-2, -3, 0}}},
      {"spike of four", {{0, 0, 0}, {4, 0, 0}, {2, 0, 0}, {2, 2, 0}}},
      {"spike outwards", {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {4, 6, 0}, {4, 4, 0}, {0, 4, 0}}},
      {"spike inwards", {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {2, 2, 0}, {4, 4, 0}, {0, 4, 0}}},
      {"spike longer than its edge", {{0, 0, 0}, {4, 0, 0}, {-1, 0, 0}, {2, 2, 0}}},
      {"touches itself in a vertex", {{0, 0, 0}, {4, 0, 0}, {2, 2, 0}, {4, 4, 0}, {0, 4, 0}, {2, 2, 0}}},
      {"touches an edge", {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {2, 0, 0}, {0, 4, 0}}},
      {"round twice", {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, 0}, {4, 0, 0}, {0, 4, 0}}},
      {"keyhole",
       {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {0, 0, 0}, {1, 1, 0}, {1, 2, 0}, {2, 2, 0}, {2, 1, 0}, {1, 1, 0}}},
  };
  for (const auto& [name, loop] : cases) {
    EXPECT_EQ(defect(loop), PolygonDefect::self_intersecting) << name;
    EXPECT_EQ(defect(tilted(loop)), PolygonDefect::self_intersecting) << name << " tilted";
    auto turned = loop;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      std::rotate(turned.begin(), turned.begin() + 1, turned.end());
      EXPECT_EQ(defect(turned), PolygonDefect::self_intersecting) << name << " from vertex " << i + 1;
    }
  }
}

int side(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double turn = cross(b - a, c - a).z;  // exact on small integers
  return turn > 0 ? 1 : turn < 0 ? -1 : 0;
}

bool holds(const Vec3& a, const Vec3& b, const Vec3& p) {
  return side(a, b, p) == 0 && std::min(a.x, b.x) <= p.x && p.x <= std::max(a.x, b.x) && std::min(a.y, b.y) <= p.y &&
         p.y <= std::max(a.y, b.y);
}

bool meet(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return holds(a, b, c) || holds(a, b, d) || holds(c, d, a) || holds(c, d, b) ||
         (side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0);
}

/// Every edge against every other.
bool is_simple(const std::vector<Vec3>& loop) {
  const std::size_t n = loop.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 &a = loop[i], &b = loop[(i + 1) % n], &after = loop[(i + 2) % n];
    if (holds(a, b, after) || holds(b, after, a)) return false;
    for (std::size_t j = i + 2; j < n && (j + 1) % n != i; ++j) {
      if (meet(a, b, loop[j], loop[(j + 1) % n])) return false;
    }
  }
  return true;
}

TEST(FindDefect, AgreesWithEveryEdgeAgainstEveryOther) {
  std::mt19937_64 random(5);
  int simple = 0;
  for (int round = 0; round < 50000; ++round) {
    std::vector<Vec3> loop(4 + random() % 6);
    for (Vec3& p : loop) p = {static_cast<double>(random() % 5), static_cast<double>(random() % 5), 0};
    bool repeats = false, straight = true;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      repeats = repeats || loop[i] == loop[(i + 1) % loop.size()];
      straight = straight && side(loop[0], loop[1], loop[i]) == 0;
    }
    if (repeats) continue;
    const PolygonDefect expected = straight          ? PolygonDefect::zero_area
                                   : is_simple(loop) ? PolygonDefect::none
                                                     : PolygonDefect::self_intersecting;
    ASSERT_EQ(defect(loop), expected) << testing::PrintToString(loop.size()) << " vertices, round " << round;
    if (expected == PolygonDefect::none) ++simple;
  }
  EXPECT_GT(simple, 1000);
}

TEST(FindDefect, FindsMisplacedHoles) {
  const std::vector<Vec3> hole{{1, 1, 0}, {2, 1, 0}, {1, 2, 0}};
  const auto moved = [&](double x, double y) {
    auto loop = hole;
    for (Vec3& p : loop) p = p + Vec3{x, y, 0};
    return loop;
  };
  EXPECT_EQ(defect(kSquare, {moved(10, 0)}), PolygonDefect::self_intersecting) << "outside";
  EXPECT_EQ(defect(kSquare, {moved(2.5, 0)}), PolygonDefect::self_intersecting) << "across the edge";
  EXPECT_EQ(defect(kSquare, {moved(2, 0)}), PolygonDefect::self_intersecting) << "touches the edge";
  EXPECT_EQ(defect(kSquare, {hole, hole}), PolygonDefect::self_intersecting) << "twice";
  EXPECT_EQ(defect(kSquare, {hole, moved(1, 0)}), PolygonDefect::self_intersecting) << "holes touch";
  EXPECT_EQ(defect(kSquare, {{{0.5, 0.5, 0}, {3.5, 0.5, 0}, {0.5, 3.5, 0}}, hole}), PolygonDefect::self_intersecting)
      << "hole in a hole";
  EXPECT_EQ(defect(kSquare, {hole, {{0.5, 0.5, 0}, {3.5, 0.5, 0}, {0.5, 3.5, 0}}}), PolygonDefect::self_intersecting)
      << "hole around a hole";
  EXPECT_EQ(defect(hole, {kSquare}), PolygonDefect::self_intersecting) << "hole around all";
  EXPECT_EQ(defect(kSquare, {{{1, 1, 0}, {3, 3, 0}, {2, 2, 0}}}), PolygonDefect::self_intersecting) << "no area";
}

TEST(FindDefect, DescribesEachDifferently) {
  EXPECT_NE(describe(PolygonDefect::zero_area), describe(PolygonDefect::self_intersecting));
  EXPECT_NE(describe(PolygonDefect::non_finite).find("finite"), std::string_view::npos);
  EXPECT_NE(describe(PolygonDefect::too_few_vertices).find("three"), std::string_view::npos);
}

TEST(AreaVector, PointsToTheFront) {
  EXPECT_EQ(area_vector(kSquare), (Vec3{0, 0, 16}));
  EXPECT_EQ(area_vector(std::vector<Vec3>(kSquare.rbegin(), kSquare.rend())), (Vec3{0, 0, -16}));
  EXPECT_EQ(area_vector(std::vector<Vec3>{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {1, 1, 0}, {0, 4, 0}}), (Vec3{0, 0, 10}));
  EXPECT_EQ(area_vector(std::vector<Vec3>{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}), (Vec3{}));
}

TEST(AreaVector, HolesCountWhicheverWayTheyRun) {
  const std::vector<Vec3> hole{{1, 1, 0}, {2, 1, 0}, {2, 2, 0}, {1, 2, 0}};
  const std::vector<Vec3> other{{2, 3, 0}, {3, 3, 0}, {3, 2, 0}};
  EXPECT_EQ(area_vector(Polygon{kSquare, {hole, other}}), (Vec3{0, 0, 14.5}));
  EXPECT_EQ(area_vector(Polygon{kSquare, {{hole.rbegin(), hole.rend()}, {other.rbegin(), other.rend()}}}),
            (Vec3{0, 0, 14.5}));
}

}  // namespace
}  // namespace exitance
