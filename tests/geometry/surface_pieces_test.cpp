#include "geometry/surface_pieces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "geometry/edge_contact.h"

namespace exitance {
namespace {

/// About two axes, so that coordinates are rounded.
std::vector<Polygon> turned(std::vector<Polygon> faces, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  for (Polygon& face : faces) {
    for (Vec3& p : face.outer) {
      const Vec3 q{c * p.x - s * p.y, s * p.x + c * p.y, p.z};
      p = {q.x, c * q.y - s * q.z, s * q.y + c * q.z};
    }
  }
  return faces;
}

Polygon reversed(Polygon p) {
  std::reverse(p.outer.begin(), p.outer.end());
  return p;
}

// Faces look out, in the order below, above, y = min, y = max, x = min, x = max.
std::vector<Polygon> box(Vec3 a, Vec3 b) {
  return {{{{a.x, a.y, a.z}, {a.x, b.y, a.z}, {b.x, b.y, a.z}, {b.x, a.y, a.z}}, {}},
          {{{a.x, a.y, b.z}, {b.x, a.y, b.z}, {b.x, b.y, b.z}, {a.x, b.y, b.z}}, {}},
          {{{a.x, a.y, a.z}, {b.x, a.y, a.z}, {b.x, a.y, b.z}, {a.x, a.y, b.z}}, {}},
          {{{a.x, b.y, a.z}, {a.x, b.y, b.z}, {b.x, b.y, b.z}, {b.x, b.y, a.z}}, {}},
          {{{a.x, a.y, a.z}, {a.x, a.y, b.z}, {a.x, b.y, b.z}, {a.x, b.y, a.z}}, {}},
          {{{b.x, a.y, a.z}, {b.x, b.y, a.z}, {b.x, b.y, b.z}, {b.x, a.y, b.z}}, {}}};
}

std::vector<Polygon> room(Vec3 a, Vec3 b) {
  std::vector<Polygon> faces = box(a, b);
  std::transform(faces.begin(), faces.end(), faces.begin(), reversed);
  return faces;
}

std::vector<Polygon> without(std::vector<Polygon> faces, std::ptrdiff_t face) {
  faces.erase(faces.begin() + face);
  return faces;
}

std::vector<Polygon> operator+(std::vector<Polygon> a, const std::vector<Polygon>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

std::vector<Polygon> turned(std::vector<Polygon> faces) {
  const double c = std::cos(0.7), s = std::sin(0.7);
  for (Polygon& face : faces) {
    for (Vec3& p : face.outer) p = {c * p.x - s * p.y, s * p.x + c * p.y, 0.3 * p.x + p.z};
  }
  return faces;
}

/// Closedness knows no tolerance unless it is told one: however thin, a box encloses something, and the two sides of a
/// sheet nothing.
TEST(SurfacePieces, ThinRoomsAndTheTwoSidesOfASheet) {
  for (const double thickness : {1e-3, 1e-12, 1e-15}) {
    for (const auto& faces : {box({0, 0, 0}, {3, 2, thickness}), turned(box({-1.5, -1, 0}, {1.5, 1, thickness}))}) {
      EXPECT_NEAR(find_surface_pieces(faces).pieces[0].volume / (6 * thickness), 1, 0.5) << thickness;
      std::vector<Polygon> in = faces;
      std::ranges::transform(in, in.begin(), reversed);
      EXPECT_NEAR(find_surface_pieces(in).pieces[0].volume / (6 * thickness), -1, 0.5) << thickness;
    }
  }
  const std::vector<Polygon> one_side = turned({box({0, 0, 0}, {3, 2, 1})[1]});
  const auto sheet = find_surface_pieces(one_side + std::vector<Polygon>{reversed(one_side[0])});
  EXPECT_TRUE(sheet.pieces[0].closed);
  EXPECT_EQ(sheet.pieces[0].volume, 0);
}

TEST(SurfacePieces, WhatIsNoThickerThanNearBoundsNothing) {
  constexpr double kNear = 1e-13;
  for (const double thickness : {0.5 * kNear, 0.9 * kNear, 1.5 * kNear, 1e-9}) {
    const auto slab = find_surface_pieces(turned(box({-1.5, -1, 0}, {1.5, 1, thickness})), kNear);
    ASSERT_EQ(slab.pieces.size(), 1u);
    EXPECT_TRUE(slab.pieces[0].closed);
    EXPECT_EQ(slab.pieces[0].volume > 0, thickness > kNear) << thickness;
  }
}

TEST(SurfacePieces, ARoomAndABoxInIt) {
  const auto found = find_surface_pieces(room({0, 0, 0}, {3, 3, 3}) + box({1, 1, 1}, {2, 2, 2}));
  ASSERT_EQ(found.pieces.size(), 2u);
  EXPECT_TRUE(found.open_edges.empty());
  EXPECT_NEAR(found.pieces[0].volume, -27, 1e-12);
  EXPECT_NEAR(found.pieces[1].volume, 1, 1e-12);
  EXPECT_NEAR(found.pieces[0].area, 54, 1e-12);
  EXPECT_FALSE(found.pieces[0].enclosed);
  EXPECT_TRUE(found.pieces[0].encloses);
  EXPECT_TRUE(found.pieces[1].enclosed);
}

TEST(SurfacePieces, AMissingWallLeavesFourEdgesOpen) {
  const auto found = find_surface_pieces(without(room({0, 0, 0}, {3, 3, 3}), 2));
  ASSERT_EQ(found.pieces.size(), 1u);
  EXPECT_FALSE(found.pieces[0].closed);
  EXPECT_EQ(found.pieces[0].volume, 0);
  EXPECT_EQ(found.open_edges.size(), 4u);
}

TEST(SurfacePieces, TJunctionsCloseWhenTheyAreExact) {
  // The floor is one polygon, the wall y = min three, of which two meet in the middle of the floor's edge.
  auto faces = without(room({0, 0, 0}, {3, 3, 3}), 2);
  faces.push_back({{{0, 0, 0}, {0, 0, 3}, {1.1, 0, 3}, {1.1, 0, 0}}, {}});
  faces.push_back({{{1.1, 0, 0}, {1.1, 0, 1.7}, {3, 0, 1.7}, {3, 0, 0}}, {}});
  faces.push_back({{{1.1, 0, 1.7}, {1.1, 0, 3}, {3, 0, 3}, {3, 0, 1.7}}, {}});
  const auto found = find_surface_pieces(faces);
  ASSERT_EQ(found.pieces.size(), 1u);
  EXPECT_TRUE(found.pieces[0].closed);
  EXPECT_NEAR(found.pieces[0].volume, -27, 1e-12);
  faces.back().outer[2].x = std::nextafter(3, 4);
  EXPECT_FALSE(find_surface_pieces(faces).pieces[0].closed);
}

TEST(SurfacePieces, TJunctionOnASlantedEdge) {
  // A prism over the triangle (0,0), (4,0), (0,2); the slanted wall is cut at (2,1), exactly on the triangles' edges.
  std::vector<Polygon> faces{{{{0, 0, 0}, {0, 2, 0}, {4, 0, 0}}, {}},
                             {{{0, 0, 1}, {4, 0, 1}, {0, 2, 1}}, {}},
                             {{{0, 0, 0}, {4, 0, 0}, {4, 0, 1}, {0, 0, 1}}, {}},
                             {{{0, 2, 0}, {0, 0, 0}, {0, 0, 1}, {0, 2, 1}}, {}},
                             {{{4, 0, 0}, {2, 1, 0}, {2, 1, 1}, {4, 0, 1}}, {}},
                             {{{2, 1, 0}, {0, 2, 0}, {0, 2, 1}, {2, 1, 1}}, {}}};
  const auto found = find_surface_pieces(faces);
  ASSERT_EQ(found.pieces.size(), 1u);
  EXPECT_TRUE(found.pieces[0].closed);
  EXPECT_NEAR(found.pieces[0].volume, 4, 1e-12);
}

TEST(SurfacePieces, ABoxWithoutABottomStandsOnTheFloor) {
  const auto block = without(box({1, 1, 0}, {2, 2, 1}), 0);
  const auto found = find_surface_pieces(room({0, 0, 0}, {3, 3, 3}) + block);
  ASSERT_EQ(found.pieces.size(), 2u);
  EXPECT_EQ(found.open_edges.size(), 4u);
  for (const OpenEdge& e : found.open_edges) EXPECT_TRUE(e.in_contact);
  EXPECT_TRUE(found.pieces[1].closed);
  EXPECT_NEAR(found.pieces[1].volume, 1, 1e-12);
  EXPECT_TRUE(found.pieces[1].enclosed);
}

TEST(SurfacePieces, ContactMayRunOverSeveralPolygonsOfTheFloor) {
  auto faces = without(room({0, 0, 0}, {3, 3, 3}), 0);
  for (const double x : {0., 1.5}) {
    for (const double y : {0., 1.25}) {
      const double far_x = x == 0 ? 1.5 : 3, far_y = y == 0 ? 1.25 : 3;
      faces.push_back({{{x, y, 0}, {far_x, y, 0}, {far_x, far_y, 0}, {x, far_y, 0}}, {}});
    }
  }
  const auto found = find_surface_pieces(faces + without(box({1, 1, 0}, {2, 2, 1}), 0));
  ASSERT_EQ(found.pieces.size(), 2u);
  EXPECT_TRUE(found.pieces[0].closed);
  EXPECT_TRUE(found.pieces[1].closed);
  // And one that leans out over the edge of what carries it.
  const std::vector<Polygon> table{{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {}}};
  const auto leaning = find_surface_pieces(table + without(box({0.5, 0.25, 0}, {1.5, 0.75, 1}), 0));
  EXPECT_FALSE(leaning.pieces[1].closed);
}

TEST(SurfacePieces, SolidsThatTouchStayApart) {
  // Sharing a whole face, an edge, or standing in the room's corner.
  const auto found = find_surface_pieces(room({0, 0, 0}, {3, 3, 3}) + box({0, 0, 0}, {1, 1, 1}) +
                                         box({1, 0, 0}, {2, 1, 1}) + box({1, 1, 1}, {2, 2, 2}));
  EXPECT_EQ(found.pieces.size(), 4u);
  EXPECT_TRUE(found.open_edges.empty());
  for (std::size_t i = 1; i < 4; ++i) EXPECT_TRUE(found.pieces[i].enclosed);
}

TEST(SurfacePieces, WhatStandsOutsideIsNotEnclosed) {
  const auto above = find_surface_pieces(room({0, 0, 0}, {3, 3, 3}) + box({1, 1, 3}, {2, 2, 4}));
  EXPECT_FALSE(above.pieces.at(1).enclosed);
  const auto plate_above = find_surface_pieces(room({0, 0, 0}, {3, 3, 3}) + box({0, 0, 3}, {3, 3, 3.001}));
  EXPECT_FALSE(plate_above.pieces.at(1).enclosed);
  const auto plate_below = find_surface_pieces(room({0, 0, 0}, {3, 3, 3}) + box({1, 1, 0}, {2, 2, 0.001}));
  EXPECT_TRUE(plate_below.pieces.at(1).enclosed);
}

TEST(SurfacePieces, TheNotchOfAnLShapedRoomIsOutside) {
  // x and y from 0 to 2, without the quarter beyond 1.
  const std::vector<Vec3> plan{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}};
  std::vector<Polygon> faces{{plan, {}}, {{}, {}}};
  for (const Vec3& p : plan) faces[1].outer.insert(faces[1].outer.begin(), p + Vec3{0, 0, 1});
  for (std::size_t i = 0; i < plan.size(); ++i) {
    const Vec3 a = plan[i], b = plan[(i + 1) % plan.size()], up{0, 0, 1};
    faces.push_back({{b, a, a + up, b + up}, {}});
  }
  const auto in = find_surface_pieces(turned(faces + box({0.2, 0.2, 0.2}, {0.8, 0.8, 0.8})));
  ASSERT_EQ(in.pieces.size(), 2u);
  EXPECT_NEAR(in.pieces[0].volume, -3, 1e-12);
  EXPECT_TRUE(in.pieces[1].enclosed);
  const auto out = find_surface_pieces(turned(faces + box({1.2, 1.2, 0.2}, {1.8, 1.8, 0.8})));
  EXPECT_FALSE(out.pieces.at(1).enclosed);
}

TEST(SurfacePieces, SheetsBoundNothing) {
  const std::vector<Polygon> sheet{{{{1, 1, 1}, {2, 1, 1}, {2, 2, 1.5}, {1, 2, 1}}, {}}};
  const auto two_sided =
      find_surface_pieces(room({0, 0, 0}, {3, 3, 3}) + sheet + std::vector<Polygon>{reversed(sheet[0])});
  ASSERT_EQ(two_sided.pieces.size(), 2u);
  EXPECT_TRUE(two_sided.pieces[1].closed);
  EXPECT_EQ(two_sided.pieces[1].volume, 0);
  EXPECT_TRUE(two_sided.pieces[1].enclosed);
  const auto single = find_surface_pieces(room({0, 0, 0}, {3, 3, 3}) + sheet);
  EXPECT_FALSE(single.pieces.at(1).closed);
  EXPECT_TRUE(single.pieces[1].enclosed);
}

/// Turned by no simple angle, the rim of a box without a bottom ends on the floor but for rounding, and the two sides
/// of a sheet, which are cut along other diagonals, enclose some roundings.
TEST(SurfacePieces, ContactsMayHoldNearly) {
  constexpr double kNear = 0x1p-47 * 3;
  const Polygon sheet{{{1, 0.25, 1}, {2, 0.25, 1}, {2, 0.25, 2}, {1, 0.25, 2}}, {}};
  Polygon back = reversed(sheet);
  std::ranges::rotate(back.outer, back.outer.begin() + 1);
  const auto standing = without(box({1, 1, 0}, {2, 2, 1}), 0), floating = without(box({1, 1, 1e-9}, {2, 2, 1}), 0),
             leaning = without(box({2, 2, 0}, {3 + 1e-9, 3, 1}), 0);
  const auto shell = room({0, 0, 0}, {3, 3, 3});
  int open = 0;
  for (const double angle : {0.0, 0.3, 0.7, 1.1, 1.9, 2.3}) {
    const auto place = [&](const std::vector<Polygon>& faces) { return turned(faces, angle); };
    const auto near = [&](const std::vector<Polygon>& faces) { return find_surface_pieces(place(faces), kNear); };
    open += !find_surface_pieces(place(shell + standing)).pieces.at(1).closed;
    EXPECT_TRUE(near(shell + standing).pieces.at(1).closed) << angle;
    EXPECT_NEAR(near(shell + standing).pieces.at(1).volume, 1, 1e-12) << angle;
    EXPECT_FALSE(near(shell + floating).pieces.at(1).closed) << angle;
    EXPECT_FALSE(near(shell + leaning).pieces.at(1).closed) << angle;
    EXPECT_EQ(near(shell + std::vector<Polygon>{sheet, back}).pieces.at(1).volume, 0) << angle;
    EXPECT_NEAR(near(shell).pieces.at(0).volume, -27, 1e-12) << angle;
  }
  EXPECT_GT(open, 0) << "where contacts must be exact";
}

TEST(SurfacePieces, EdgesWhoseLengthUnderflowsAreInContactOnlyNearly) {
  const DirectedEdge edge{{1, 1, 1}, {1, 1, 1}, 0}, tiny{{}, {1e-170, 0, 0}, 0};
  const std::vector<std::uint32_t> piece_of_polygon{0};
  EXPECT_EQ(edges_in_contact(std::vector{tiny}, {}, piece_of_polygon), std::vector<bool>{false});
  EXPECT_EQ(edges_in_contact(std::vector{edge}, {}, piece_of_polygon, 1e-15), std::vector<bool>{true});
}

/// A vertex on an edge, turned, lies beside it; what is farther off than rounding brings it is no T-junction.
TEST(SurfacePieces, TJunctionsMayHoldNearly) {
  constexpr double kNear = 0x1p-47 * 3;
  const auto parted_at = [](double z) {
    std::vector<Polygon> faces = without(box({0, 0, 0}, {1, 2, 3}), 5);
    faces.push_back({{{1, 0, 0}, {1, 2, 0}, {1, 2, z}, {1, 0, z}}, {}});
    faces.push_back({{{1, 0, z}, {1, 2, z}, {1, 2, 3}, {1, 0, 3}}, {}});
    return faces;
  };
  std::vector<Polygon> ajar = parted_at(1);
  ajar.back().outer[0].x += 1e-9;
  int open = 0;
  for (const double angle : {0.3, 0.7, 1.1, 1.9, 2.3}) {
    const auto place = [&](const std::vector<Polygon>& faces) { return turned(faces, angle); };
    for (const double z : {1.0, 2.7}) {
      const auto found = find_surface_pieces(place(parted_at(z)), kNear);
      ASSERT_EQ(found.pieces.size(), 1u) << angle;
      EXPECT_TRUE(found.pieces[0].closed) << angle;
      EXPECT_TRUE(found.open_edges.empty()) << angle;
      EXPECT_NEAR(found.pieces[0].volume, 6, 1e-12) << angle;
      open += !find_surface_pieces(place(parted_at(z))).pieces[0].closed;
    }
    EXPECT_FALSE(find_surface_pieces(place(ajar), kNear).pieces[0].closed) << angle;
  }
  EXPECT_GT(open, 0) << "where vertices must lie on edges exactly";
}

TEST(SurfacePieces, HolesMayRunEitherWay) {
  // A room with a square tube through its ceiling's hole, closed above.
  auto faces = without(room({0, 0, 0}, {3, 3, 3}), 1);
  Polygon ceiling = room({0, 0, 0}, {3, 3, 3})[1];
  ceiling.holes.push_back({{1, 1, 3}, {2, 1, 3}, {2, 2, 3}, {1, 2, 3}});
  const auto tube = without(room({1, 1, 3}, {2, 2, 4}), 0);
  for (int way = 0; way < 2; ++way) {
    const auto found = find_surface_pieces(faces + tube + std::vector<Polygon>{ceiling});
    ASSERT_EQ(found.pieces.size(), 1u);
    EXPECT_TRUE(found.open_edges.empty());
    EXPECT_NEAR(found.pieces[0].volume, -28, 1e-12);
    std::reverse(ceiling.holes[0].begin(), ceiling.holes[0].end());
  }
}

}  // namespace
}  // namespace exitance
