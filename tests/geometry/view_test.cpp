#include "geometry/view.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

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

}  // namespace
}  // namespace exitance
