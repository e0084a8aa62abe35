#include "geometry/view.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "tests/geometry/solids.h"

namespace exitance {
namespace {

/// A plane's point (u, v): the plane is across an axis or slanted, and which axis comes first is told by `turn`.
Vec3 placed(double u, double v, bool slanted, int turn) {
  const std::array<double, 3> at{u, v, slanted ? u + 2 * v : 0};
  const auto of = [&](int axis) { return at[static_cast<std::size_t>((axis + turn) % 3)]; };
  return {of(0), of(1), of(2)};
}

// A three-cornered tile on a floor: it covers the points of its interior, not those of its edges and corners.
TEST(View, IsCoveredInTheInteriorOfWhatLiesOnTheReceiver) {
  struct Place {
    double u, v;
    bool covered;
  };
  const std::vector<Place> places = {{1, 1, true},  {0x1p-40, 1, true}, {2 - 0x1p-40, 2, true}, {2, 2, false},
                                     {3, 3, false}, {4, 4, false},      {0, 1, false},          {1, 0, false},
                                     {0, 0, false}, {4, 0, false},      {-1, 1, false},         {1, -1, false},
                                     {5, 1, false}, {1, 5, false}};
  for (const bool slanted : {false, true}) {
    for (int turn = 0; turn < 3; ++turn) {
      for (const bool turned_over : {false, true}) {
        const auto loop = [&](std::vector<std::array<double, 2>> corners) {
          if (turned_over) std::ranges::reverse(corners);
          Polygon polygon;
          for (const auto& c : corners) polygon.outer.push_back(placed(c[0], c[1], slanted, turn));
          return polygon;
        };
        const PolygonSoup soup(
            std::vector<Polygon>{loop({{-8, -8}, {8, -8}, {8, 8}, {-8, 8}}), loop({{0, 0}, {4, 0}, {0, 4}})});
        ASSERT_EQ(soup.facets().size(), 2u);
        View view(soup);
        for (const Place& place : places) {
          view.look_from({placed(place.u, place.v, slanted, turn), soup.facets()[0].plane.normal, 0});
          EXPECT_EQ(view.covered(), place.covered)
              << place.u << ' ' << place.v << ' ' << slanted << ' ' << turn << ' ' << turned_over;
        }
      }
    }
  }
}

// All facets of a box at once, from a lattice of points, many of which lie in planes of its faces: turned by a matrix
// of whole numbers, each corner and so each side is exact.
TEST(View, LooksAtAllFacetsOfAShell) {
  constexpr std::array<std::array<int, 3>, 3> kTurn{{{2, 3, 6}, {-6, -2, 3}, {3, -6, 2}}};  // times 7
  for (const bool turn : {false, true}) {
    const auto along = [&](int axis) {
      const auto& row = kTurn[static_cast<std::size_t>(axis)];
      if (turn) return Vec3{double(row[0]), double(row[1]), double(row[2])};
      return Vec3{axis == 0 ? 1.0 : 0, axis == 1 ? 1.0 : 0, axis == 2 ? 1.0 : 0};
    };
    const auto placed = [&](const Vec3& p) { return p.x * along(0) + p.y * along(1) + p.z * along(2); };
    Faces faces = prism({{1, 0}, {3, 0}, {3, 2}, {1, 2}}, 0, 4);
    for (Polygon& face : faces) std::ranges::transform(face.outer, face.outer.begin(), placed);
    const PolygonSoup soup(faces);
    ASSERT_EQ(soup.shells().size(), 1u);
    ASSERT_EQ(soup.facets().size(), 6u);
    View view(soup);
    for (int k = 0; k < 216; ++k) {
      const Vec3 x = placed({double(k % 6), double(k / 6 % 6 - 2), double(k / 36)});
      view.look_from({x, {0, 0, 1}});
      const StageCounts before = view.counts();
      view.look_at(soup.shells()[0]);
      for (std::uint32_t f = 0; f < 6; ++f) {
        const Vec3 out = cross(faces[f].outer[1] - faces[f].outer[0], faces[f].outer[2] - faces[f].outer[1]);
        const double side = dot(out, x - faces[f].outer[0]);
        EXPECT_EQ(view.side(f), (side > 0) - (side < 0)) << "point " << k << ", facet " << f;
      }
      const StageCounts after = view.counts();
      const std::uint64_t decided =
          after.filter + after.interval + after.exact - before.filter - before.interval - before.exact;
      EXPECT_EQ(decided, 6u) << "each facet is decided once, seen from point " << k;
    }
  }
}

}  // namespace
}  // namespace exitance
