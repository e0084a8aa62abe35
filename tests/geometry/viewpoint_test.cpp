#include "geometry/viewpoint.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "src/stress/visibility_oracle.h"

namespace exitance {
namespace {

/// F from a point of polygon 0 to the front of the last polygon; `hidden`: which polygons hide nothing.
PointFormFactor ask(const std::vector<Polygon>& polygons, const Vec3& x, const Vec3& normal,
                    std::initializer_list<std::size_t> hidden) {
  std::vector<Role> roles(polygons.size(), Role::patch);
  for (const std::size_t k : hidden) roles[k] = Role::unoccluding;
  const PolygonSoup soup(polygons, roles);
  Viewpoint view(soup);
  view.look_from({x, normal, soup.first_facet(0)});
  return view.form_factor({soup.first_facet(static_cast<std::uint32_t>(polygons.size()) - 1), {}});
}

/// A turn by 3, 4, 5 and a scale by 5, which keep small whole numbers and their halves exact.
Vec3 turned_by_345(const Vec3& v) {
  return {3 * v.x - 4 * v.z, 5 * v.y, 4 * v.x + 3 * v.z};
}
std::vector<Polygon> turned_by_345(std::vector<Polygon> polygons) {
  for (Polygon& polygon : polygons)
    std::ranges::transform(polygon.outer, polygon.outer.begin(), [](const Vec3& v) { return turned_by_345(v); });
  return polygons;
}

TEST(Viewpoint, SaysWhichSideOfASourceItSeesAndThatItIsSeenEdgeOn) {
  const Polygon floor{{{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}}, {}};
  const auto side_at = [&](double z, bool turned_over) {
    Polygon source{{{-1, -1, z}, {-1, 1, z}, {1, 1, z}, {1, -1, z}}, {}};  // looks down
    if (turned_over) std::ranges::reverse(source.outer);
    return ask({floor, source}, {0, 0, 0}, {0, 0, 1}, {}).side;
  };
  EXPECT_EQ(side_at(2, false), Side::front);
  EXPECT_EQ(side_at(2, true), Side::back);
  EXPECT_EQ(side_at(0x1p-500, false), Side::front);
  const Polygon wall{{{0, 1, 0}, {0, 2, 0}, {0, 2, 1}, {0, 1, 1}}, {}};  // its plane goes through the point
  const PointFormFactor edge_on = ask({floor, wall}, {0, 0, 0}, {0, 0, 1}, {});
  EXPECT_EQ(edge_on.side, Side::edge_on);
  EXPECT_EQ(edge_on.F, 0);
}

// A bent quadrilateral's halves (0 and 1) stand on the source (3); a triangle (2) that shares an edge with half 1 lies
// in the source's plane, faces the point like half 1, and hides nothing: the shared edge still bounds what half 1
// hides.
TEST(Viewpoint, NeighbourInTheSourcesPlaneDoesNotCarryOn) {
  const std::vector<Polygon> polygons = {{{{5.3289999999999997, 2.3363730669710785, 0.4376672056356824},
                                           {5.3125828622157885, 2.3648083837376763, 0.49252143771883894},
                                           {5.3629948355779229, 2.3736973747702312, 0.49252143771883894}},
                                          {}},
                                         {{{5.3289999999999997, 2.3363730669710785, 0.4376672056356824},
                                           {5.3629948355779229, 2.3736973747702312, 0.49252143771883894},
                                           {5.3572932234611361, 2.3413619256261735, 0.4376672056356824}},
                                          {}},
                                         {{{5.3821738666258749, 2.273002920411527, 0.4376672056356824},
                                           {5.3289999999999997, 2.3363730669710785, 0.4376672056356824},
                                           {5.3572932234611361, 2.3413619256261735, 0.4376672056356824}},
                                          {}},
                                         {{{4.4000000000000004, 2.1499999999999999, 0.4376672056356824},
                                           {5.5999999999999996, 2.1499999999999999, 0.4376672056356824},
                                           {5.5999999999999996, 2.4499999999999997, 0.4376672056356824}},
                                          {}}};
  const Vec3 x{5.3348592325979034, 2.3582929418263285, 0.47423669369112009};
  const Vec3 normal{-0.15134912922527982, 0.85834356710944382, -0.49024459393713371};
  const PointFormFactor with = ask(polygons, x, normal, {}), without = ask(polygons, x, normal, {2});
  EXPECT_NEAR(with.F, without.F, with.error + without.error);
}

// Slivers of a turned cube's face, one plane but for rounding, seen by a point of that face from 5e-15 above a plane of
// theirs; a piece of one has rounded corners, which drop by as much. How far, 64 bits know only 1e-17 well.
TEST(Viewpoint, PiecesOfSliversInThePlaneOfThePointAreSeenEdgeOn) {
  const Vec3 tip{-0.53164265169423452, -1.4856357042207127, -0.71431270830368843};
  const auto at = [](double y, double z) { return Vec3{-1.3104793363115357, y, z}; };
  const std::vector<Polygon> polygons = {
      {{tip, at(-0.32922166564640476, 0.76410536182484945), at(-0.31139751844517605, 0.75503343939633782)}, {}},
      {{tip, at(-0.29357337124394733, 0.74596151696782631), at(-0.27574922404271862, 0.7368895945393148)}, {}},
      {{tip, at(-0.27574922404271862, 0.7368895945393148), at(-0.25792507684149002, 0.72781767211080328)}, {}},
      {{tip, at(-0.25792507684149002, 0.72781767211080328), at(-0.24010092964026122, 0.71874574968229177)}, {}},
      {{tip, at(-0.24010092964026122, 0.71874574968229177), at(-0.22227678243903251, 0.70967382725378014)}, {}},
      {{at(1.1323584048543494, 0.020207722686902629), at(-0.65005631526852148, 0.92739996553805726),
        Vec3{-1.2920581164314779, -0.64652354227485787, 0.93434101539422532}},
       {}}};
  const std::vector<Vec3> piece = {{-0.9210609940028851, -0.90742868493355877, 0.024896326760580512},
                                   at(-0.32922166564640476, 0.76410536182484945),
                                   at(-0.3203095920457904, 0.75956940061059364)};
  const PolygonSoup soup(polygons);
  Viewpoint view(soup);
  view.look_from({{-1.180673222208652, -0.013969143507104653, 0.25915256092418071},
                  {-0.92106099400288544, -0.17663864968318316, -0.34705249280839123}});
  EXPECT_LT(view.form_factor({0, piece}).F, 1e-12);
}

// A tall screen crosses the source's plane above the horizon's other side: what it has in front of the source lies
// below the receiver's horizon, so that it hides nothing.
TEST(Viewpoint, OccluderInFrontOnlyBelowTheHorizonHidesNothing) {
  const std::vector<Polygon> polygons = {
      {{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {}},
      // Pierces the plane x + z = 4 of the source; its part with x + z < 4 lies at z < 0.
      {{{4.5, -2, -1}, {4.5, 2, -1}, {4.2, 1, 1}, {4.2, -1, 1}}, {}},
      {{{4, -1, 0.125}, {4, 1, 0.125}, {2, 1, 2.125}, {2, -1, 2.125}}, {}}};
  const Vec3 x{0.1, 0.2, 0}, normal{0, 0, 1};
  for (const bool turned : {false, true}) {
    auto scene = polygons;
    if (turned) std::reverse(scene[2].outer.begin(), scene[2].outer.end());
    const PointFormFactor with = ask(scene, x, normal, {}), without = ask(scene, x, normal, {1});
    ASSERT_GT(without.F, 1e-3);
    EXPECT_NEAR(with.F, without.F, with.error + without.error);
  }
}

// A wall that comes up to the horizon and no further, with an edge or with a corner, is not there to be seen.
TEST(Viewpoint, ASourceThatOnlyTouchesTheHorizonIsAway) {
  const Polygon floor{{{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}}, {}};
  for (const double last : {0.0, -0.5}) {
    const Polygon wall{{{2, -1, 0}, {2, -1, -1}, {3, 1, -1}, {3, 1, last}}, {}};
    for (const bool turn : {false, true}) {
      std::vector<Polygon> scene{floor, wall};
      if (turn) scene = turned_by_345(scene);
      const PointFormFactor seen = ask(scene, {0, 0, 0}, turn ? Vec3{-4, 0, 3} : Vec3{0, 0, 1}, {});
      EXPECT_EQ(seen.visibility, Visibility::away);
      EXPECT_NE(seen.side, Side::edge_on);
      EXPECT_EQ(seen.F, 0);
    }
  }
}

// A long box that is level with the point lies beside it under a source that fills most of the hemisphere: each side
// of the source has a part of the box on its inner side.
TEST(Viewpoint, ABoxThatIsLevelWithThePointHidesNothing) {
  const auto box = [](double top) {
    const double a = 1, b = 2, c = 100;
    return std::vector<Polygon>{{{{a, -c, -1}, {a, c, -1}, {b, c, -1}, {b, -c, -1}}, {}},
                                {{{a, -c, top}, {b, -c, top}, {b, c, top}, {a, c, top}}, {}},
                                {{{a, -c, -1}, {b, -c, -1}, {b, -c, top}, {a, -c, top}}, {}},
                                {{{a, c, -1}, {a, c, top}, {b, c, top}, {b, c, -1}}, {}},
                                {{{a, -c, -1}, {a, -c, top}, {a, c, top}, {a, c, -1}}, {}},
                                {{{b, -c, -1}, {b, c, -1}, {b, c, top}, {b, -c, top}}, {}}};
  };
  const Polygon source{{{-3, -3, 1}, {-3, 3, 1}, {10, 0, 1}}, {}};
  const auto seen = [&](double top, bool turn) {
    std::vector<Polygon> scene = box(top);
    scene.push_back(source);
    if (turn) scene = turned_by_345(scene);
    const PolygonSoup soup(scene);
    Viewpoint view(soup);
    view.look_from({{0, 0, 0}, turn ? Vec3{-4, 0, 3} : Vec3{0, 0, 1}});
    return view.form_factor({6, {}});
  };
  for (const bool turn : {false, true}) {
    const PointFormFactor level = seen(0, turn);
    EXPECT_EQ(level.visibility, Visibility::open);
    EXPECT_NEAR(level.F, seen(-0.5, turn).F, 2 * level.error);
    EXPECT_LT(seen(0.25, turn).F, level.F - 1e-3);
  }
}

// Of a source of which two plates that overlap hide a part each nothing is left.
TEST(Viewpoint, WhatIsHiddenInPartsIsBlocked) {
  const std::vector<Polygon> polygons = {{{{-2, -2, 2}, {0.25, -2, 2}, {0.25, 2, 2}, {-2, 2, 2}}, {}},
                                         {{{-0.25, -2, 2}, {2, -2, 2}, {2, 2, 2}, {-0.25, 2, 2}}, {}},
                                         {{{-1, -1, 4}, {-1, 1, 4}, {1, 1, 4}, {1, -1, 4}}, {}}};
  for (const bool turn : {false, true}) {
    const PolygonSoup soup(turn ? turned_by_345(polygons) : polygons);
    Viewpoint view(soup);
    view.look_from({{0, 0, 0}, turn ? Vec3{-4, 0, 3} : Vec3{0, 0, 1}});
    const PointFormFactor seen = view.form_factor({2, {}});
    EXPECT_EQ(seen.visibility, Visibility::blocked);
    EXPECT_EQ(seen.F, 0);
  }
}

// What is seen of a square past a plate, of which a strip stands over its edge: the boundary runs so that it encloses
// the visible area to its left, seen from the point, whichever side the square shows; of nothing there is no boundary.
TEST(Viewpoint, TheVisibleRegionLiesToTheLeftOfItsBoundary) {
  const Polygon square{{{-2, -2, 2}, {-2, 2, 2}, {2, 2, 2}, {2, -2, 2}}, {}};
  const Polygon plate{{{-0.5, -0.25, 1}, {2, -0.25, 1}, {2, 0.5, 1}, {-0.5, 0.5, 1}}, {}};  // hides 3 by 1.5
  for (const bool from_above : {false, true}) {
    for (const bool turn : {false, true}) {
      std::vector<Polygon> scene{square, plate};
      if (from_above) {
        for (Vec3& v : scene[1].outer) v.z = 3;
      }
      if (turn) scene = turned_by_345(scene);
      const PolygonSoup soup(scene, std::vector<Role>{Role::patch, Role::sheet});
      Viewpoint view(soup);
      const auto placed = [&](const Vec3& v) { return turn ? turned_by_345(v) : v; };
      const Vec3 x = placed({0, 0, from_above ? 4.0 : 0.0}), up = placed({0, 0, 1});
      view.look_from({x, (from_above ? -1.0 : 1.0) * up});
      Vec3 twice;
      for (const BoundaryPiece& piece : view.visible_region({0, {}})) {
        EXPECT_NE(piece.from, piece.to);
        twice = twice + cross(piece.from - x, piece.to - x);
      }
      const double scale = turn ? 25 : 1, towards = (from_above ? 1 : -1) * dot(up, twice) / (2 * norm(up));
      EXPECT_NEAR(towards, scale * (16 - 4.5), scale * 1e-12) << from_above << turn;
    }
  }
  const std::vector<Polygon> hidden = {square,
                                       {{{-2, -2, 1}, {0, -2, 1}, {0, 2, 1}, {-2, 2, 1}}, {}},
                                       {{{0, -2, 1}, {2, -2, 1}, {2, 2, 1}, {0, 2, 1}}, {}}};
  const PolygonSoup soup(hidden);
  Viewpoint view(soup);
  view.look_from({{0.125, 0.25, 0}, {0, 0, 1}});
  EXPECT_TRUE(view.visible_region({0, {}}).empty());
}

// A wall that stands on the floor or reaches below it, seen past a box that stands on the floor and under a shelf that
// goes through the wall: which lines bound what is seen, where their stretches lie, and that the outline counts each of
// them once, but of what is level with the point only how many pieces there are.
TEST(Viewpoint, TheOutlineIsOfTheEdgesThatAreSeen) {
  const Polygon floor{{{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}}, {}};
  const Polygon shelf{{{3, -0.5, 2.5}, {5, -0.5, 2.5}, {5, 0.5, 2.5}, {3, 0.5, 2.5}}, {}};
  const auto wall = [](double bottom) {  // with a corner in the middle of an edge
    return Polygon{{{4, -2, bottom}, {4, -2, 5}, {4, 2, 5}, {4, 2, bottom}, {4, 1.5, bottom}}, {}};
  };
  const std::vector<Polygon> box = {{{{2, -0.5, 0}, {2, 0.5, 0}, {2.5, 0.5, 0}, {2.5, -0.5, 0}}, {}},
                                    {{{2, -0.5, 1}, {2.5, -0.5, 1}, {2.5, 0.5, 1}, {2, 0.5, 1}}, {}},
                                    {{{2, -0.5, 0}, {2.5, -0.5, 0}, {2.5, -0.5, 1}, {2, -0.5, 1}}, {}},
                                    {{{2, 0.5, 0}, {2, 0.5, 1}, {2.5, 0.5, 1}, {2.5, 0.5, 0}}, {}},
                                    {{{2, -0.5, 0}, {2, -0.5, 1}, {2, 0.5, 1}, {2, 0.5, 0}}, {}},
                                    {{{2.5, -0.5, 0}, {2.5, 0.5, 0}, {2.5, 0.5, 1}, {2.5, -0.5, 1}}, {}}};
  struct Look {
    double bottom;
    bool has_box, has_shelf;
    std::size_t level, other, pieces;
  };
  for (const Look& look :
       {Look{0, false, false, 2, 3, 1}, Look{0, true, false, 3, 6, 2}, Look{-1, false, false, 1, 3, 1},
        Look{-1, true, false, 2, 6, 2}, Look{1, false, false, 0, 5, 0}, Look{1, true, true, 0, 13, 0}}) {
    for (const bool turn : {false, true}) {
      std::vector<Polygon> scene = box;
      scene.insert(scene.end(), {floor, shelf, wall(look.bottom)});
      if (turn) scene = turned_by_345(scene);
      const PolygonSoup soup(scene);
      ASSERT_EQ(soup.facets().size(), 9u);
      ASSERT_EQ(soup.shells().size(), 1u);
      std::vector<std::uint32_t> items;
      if (look.has_shelf) items.push_back(7);
      if (look.has_box) items.push_back(9);
      Viewpoint view(soup);
      view.look_from({{0, 0, 0}, turn ? Vec3{-4, 0, 3} : Vec3{0, 0, 1}, 6});
      ASSERT_GT(view.form_factor({8, {}}, items, 1e-13).F, 0.01);
      std::size_t level = 0, other = 0;
      std::uint64_t sum = 0;
      for (const SeenEdge& edge : view.seen_edges()) {
        const Vec3 up = turn ? Vec3{-0.8, 0, 0.6} : Vec3{0, 0, 1};
        const bool is_level = std::fabs(dot(edge.from, up)) < 1e-9 && std::fabs(dot(edge.to, up)) < 1e-9;
        is_level ? ++level : ++other;
        if (!is_level) sum += edge.id;
        // Both ends lie in the plane of the point and the line, and are no less far apart than the wall shows them.
        const Vec3 normal = (1 / norm(cross(edge.a, edge.b))) * cross(edge.a, edge.b);
        EXPECT_NEAR(dot(normal, edge.from), 0, 1e-12);
        EXPECT_NEAR(dot(normal, edge.to), 0, 1e-12);
        EXPECT_GT(norm(edge.to - edge.from), 0.01);
      }
      EXPECT_EQ(level, look.level) << look.bottom << look.has_box << turn;
      EXPECT_EQ(other, look.other) << look.bottom << look.has_box << turn;
      EXPECT_EQ(view.outline() - sum, look.pieces) << look.bottom << look.has_box << turn;
    }
  }
}

// A piece's corners stand for points exactly in its facet's plane, to which they drop along the axis that the plane is
// most across: such a point may be on another side of the horizon than the rounded corner. `on` is an axis as numbered
// from the one that the plane is across, mirrored or not.
TEST(Viewpoint, CornersOfPiecesAreAboveTheHorizonWhereTheyDropTo) {
  for (const int first : {0, 1, 2}) {
    for (const double mirrored : {1.0, -1.0}) {
      const auto on = [&](double a, double b, double c) {
        Vec3 v;
        v[first] = mirrored * a;
        v[(first + 1) % 3] = b;
        v[(first + 2) % 3] = c;
        return v;
      };
      const auto loop = [&](std::vector<Vec3> corners) {
        if (mirrored < 0) std::ranges::reverse(corners);
        return corners;
      };
      const auto seen = [&](const std::vector<Vec3>& facet, const std::vector<Vec3>& piece, const Vec3& x,
                            const Vec3& normal) {
        const PolygonSoup soup(std::vector<Polygon>{{loop(facet), {}}});
        Viewpoint view(soup);
        view.look_from({x, normal});
        return view.form_factor({0, loop(piece)}).visibility;
      };
      // The plane a + b / 2 = 4, the horizon a = 3.5.
      const std::vector<Vec3> slanted{on(4, 0, -2), on(3, 2, -2), on(3, 2, 2), on(4, 0, 2)};
      const auto of_slanted = [&](double a, double b) {
        return seen(slanted, {on(a, b, 0), on(3, 2, -1), on(3, 2, 1)}, on(3.5, -3, 0), on(1, 0, 0));
      };
      for (const double off : {0x1p-50, 0x1p-45, -0x1p-50, -0x1p-45}) {
        EXPECT_EQ(of_slanted(3.5 + off, 1), Visibility::away) << first << ' ' << mirrored << ' ' << off;
      }
      EXPECT_EQ(of_slanted(3.5 - 0x1p-51, 1 - 0x1p-49), Visibility::open) << first << ' ' << mirrored;
      EXPECT_EQ(of_slanted(3.5 + 0x1p-51, 1 + 0x1p-49), Visibility::away) << first << ' ' << mirrored;
      // The plane a = 2, the horizon 2 b = a.
      const std::vector<Vec3> across{on(2, -2, -2), on(2, 2, -2), on(2, 2, 2), on(2, -2, 2)};
      for (const double off : {0x1p-50, -0x1p-50}) {
        EXPECT_EQ(seen(across, {on(2 - off, 1, 0), on(2 - off, 0, 1), on(2 - off, 0, -1)}, {}, on(-1, 2, 0)),
                  Visibility::away)
            << first << ' ' << mirrored << ' ' << off;
      }
    }
  }
}

// A source seen from behind is not covered by what lies on its front; one seen from its front is.
TEST(Viewpoint, CoversLieOnTheFront) {
  const Polygon source{{{-1, -1, 1}, {-1, 1, 1}, {1, 1, 1}, {1, -1, 1}}, {}};  // faces down, to the point
  const std::vector<Polygon> polygons = {source, source};
  const std::vector<Role> roles = {Role::unoccluding, Role::sheet};
  const PolygonSoup soup(polygons, roles);
  Viewpoint view(soup);
  view.look_from({{0, 0, 0}, {0, 0, 1}});
  EXPECT_EQ(view.form_factor({0, {}}).visibility, Visibility::blocked);
  view.look_from({{0, 0, 2}, {0, 0, -1}});
  const PointFormFactor behind = view.form_factor({0, {}});
  EXPECT_EQ(behind.side, Side::back);
  EXPECT_GT(behind.F, 0.5);
}

// Two tiles in the floor's plane with a common edge: the one before it in the scene lies under it and hides nothing,
// the one behind it lies on it, and their edge bounds what is hidden.
TEST(Viewpoint, ATileUnderTheFloorDoesNotCarryOnOneThatLiesOnIt) {
  const Polygon under{{{1, 1, 0}, {2, 1, 0}, {2, 3, 0}, {1, 3, 0}}, {}};
  const Polygon floor{{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}}, {}};
  const Polygon on_top{{{2, 1, 0}, {3, 1, 0}, {3, 3, 0}, {2, 3, 0}}, {}};
  const auto seen = [](const std::vector<Polygon>& polygons, std::uint32_t facet) {
    const PolygonSoup soup(polygons);
    Viewpoint view(soup);
    view.look_from({{1.75, 2, 3}, {0.1, 0.2, -1}});
    return view.form_factor({facet, {}});
  };
  const PointFormFactor with = seen({under, floor, on_top}, 1), without = seen({floor, on_top}, 0),
                        whole = seen({under, floor}, 1);
  EXPECT_NEAR(with.F, without.F, with.error + without.error);
  EXPECT_LT(with.F, whole.F - 0.01);
}

// A floor and a rug of two triangles, one of which lies in the floor's plane while the other dips under it: it is the
// first that hides, and the edge between them bounds what it hides.
TEST(Viewpoint, OnlyTheFlushHalfOfABentRugCovers) {
  const Polygon floor{{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}}, {}};
  const Polygon rug{{{1, 1, 0}, {3, 1, 0}, {3, 3, 0}, {1, 3, -0x1p-30}}, {}};
  const Polygon flush{{{1, 1, 0}, {3, 1, 0}, {3, 3, 0}}, {}};
  const auto seen = [&](const Polygon& on_top) {
    const PolygonSoup soup(std::vector<Polygon>{floor, on_top});
    Viewpoint view(soup);
    view.look_from({{1.75, 2, 3}, {0.1, 0.2, -1}});
    return view.form_factor({0, {}});
  };
  const PointFormFactor with = seen(rug), expected = seen(flush);
  ASSERT_GT(expected.F, 0.1);
  EXPECT_NEAR(with.F, expected.F, with.error + expected.error);
}

// A face of a solid covers an earlier face in its plane that looks the same way, and only that part of it.
TEST(Viewpoint, ASolidCoversWhatItsFaceIsFlushWith) {
  const Polygon floor{{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {}};
  const Polygon left{{{-1, -1, 0}, {0, -1, 0}, {0, 1, 0}, {-1, 1, 0}}, {}};
  const std::vector<Polygon> box = {
      {{{0, -2, -1}, {0, 2, -1}, {2, 2, -1}, {2, -2, -1}}, {}}, {{{0, -2, 0}, {2, -2, 0}, {2, 2, 0}, {0, 2, 0}}, {}},
      {{{0, -2, -1}, {2, -2, -1}, {2, -2, 0}, {0, -2, 0}}, {}}, {{{0, 2, -1}, {0, 2, 0}, {2, 2, 0}, {2, 2, -1}}, {}},
      {{{0, -2, -1}, {0, -2, 0}, {0, 2, 0}, {0, 2, -1}}, {}},   {{{2, -2, -1}, {2, 2, -1}, {2, 2, 0}, {2, -2, 0}}, {}}};
  const auto seen = [&](const Polygon& source, bool box_is_later, Role of_box) {
    std::vector<Polygon> polygons = box;
    std::vector<Role> roles(polygons.size(), of_box);
    const std::size_t place = box_is_later ? 0 : polygons.size();
    polygons.insert(polygons.begin() + static_cast<std::ptrdiff_t>(place), source);
    roles.insert(roles.begin() + static_cast<std::ptrdiff_t>(place), Role::patch);
    const PolygonSoup soup(polygons, roles);
    Viewpoint view(soup);
    view.look_from({{0.1, 0.2, 1.5}, {0.1, 0, -1}});
    return view.form_factor({soup.first_facet(static_cast<std::uint32_t>(place)), {}}).F;
  };
  EXPECT_NEAR(seen(floor, true, Role::patch), seen(left, true, Role::unoccluding), 1e-13);
  EXPECT_NEAR(seen(floor, false, Role::patch), seen(floor, false, Role::unoccluding), 1e-13);
  // Of what only occludes, a sheet covers any patch in its plane, a face of a solid one that it faces.
  EXPECT_NEAR(seen(floor, false, Role::sheet), seen(left, true, Role::unoccluding), 1e-13);
  EXPECT_NEAR(seen(floor, true, Role::solid_face), seen(floor, true, Role::unoccluding), 1e-13);
}

// A point of one box's side (0) sees past another box (1 … 6), whose side 6 lies in the same plane; rounded an ulp
// beyond that plane, where 6 is seen from its front, it sees the same of the floor.
TEST(Viewpoint, APointRoundedOutOfItsPlaneSeesTheSolidsThatTouchIt) {
  const std::vector<Polygon> polygons = {
      {{{3, 2, 1}, {3, 2, 4}, {3, 3, 4}, {3, 3, 1}}, {}}, {{{2, 1, 0}, {2, 2, 0}, {3, 2, 0}, {3, 1, 0}}, {}},
      {{{2, 1, 2}, {3, 1, 2}, {3, 2, 2}, {2, 2, 2}}, {}}, {{{2, 1, 0}, {3, 1, 0}, {3, 1, 2}, {2, 1, 2}}, {}},
      {{{2, 2, 0}, {2, 2, 2}, {3, 2, 2}, {3, 2, 0}}, {}}, {{{2, 1, 0}, {2, 1, 2}, {2, 2, 2}, {2, 2, 0}}, {}},
      {{{3, 1, 0}, {3, 2, 0}, {3, 2, 2}, {3, 1, 2}}, {}}, {{{3, 2, 1}, {4, 2, 1}, {4, 2, 4}, {3, 2, 4}}, {}},
      {{{3, 3, 2}, {3, 4, 2}, {3, 4, 4}, {3, 3, 4}}, {}}, {{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}}, {}}};
  const Vec3 x{3, 2.4996, 2.75578};
  const PointFormFactor on_it = ask(polygons, x, {-1, 0, 0}, {});
  ASSERT_EQ(on_it.visibility, Visibility::partial);
  for (const double ulps : {-2, -1, 1, 2}) {
    const PointFormFactor beside = ask(polygons, x + Vec3{ulps * 0x1p-51, 0, 0}, {-1, 0, 0}, {});
    EXPECT_NEAR(beside.F, on_it.F, 1e-13) << ulps;
  }
}

// A sliver at the horizon whose form factor is less than what double precision proves of its error.
TEST(Viewpoint, AValueThatItsErrorHidesIsFoundByMoreDigits) {
  const Polygon sliver{{{1.4383009909092819, 4.16591604043351, 1.4713784300498425},
                        {1.4383007608553131, 4.1659158802377867, 0.029931785947447942},
                        {1.438300610820116, 4.1435290484360277, 0.029931785947447942},
                        {1.4383008408740849, 4.1435289282892338, 1.4713784300498425}},
                       {}};
  const Vec3 x{1.437218837044699, 4.1664570280684945, 0.029392532646353886},
      normal{0.57749151863506454, 0.57691417572229375, -0.5776448560796098};
  const PolygonSoup soup(std::vector<Polygon>{sliver});
  Viewpoint view(soup);
  view.look_from({x, normal});
  const auto truth = static_cast<double>(oracle_form_factor({x, normal, sliver, {}}).F);
  ASSERT_GT(truth, 1e-12);
  for (const double tolerance : {1e-11, 1e-10}) {
    double F = 0, error = 0;
    for (std::uint32_t f = 0; f < soup.facets().size(); ++f) {
      const PointFormFactor part = view.form_factor({f, {}}, tolerance);
      F += part.F;
      error += part.error;
    }
    EXPECT_NEAR(F, truth, 6e-13) << tolerance;
    EXPECT_LE(std::fabs(F - truth), error) << tolerance;
  }
}

// A strip above the horizon so low that its form factor is just what its error hides, or just not: what is given as 0
// is wrong by no more than its error there, either.
TEST(Viewpoint, TheErrorHoldsWhereItJustHidesTheValue) {
  for (int k = 0; k < 24; ++k) {
    const Vec3 x{0.1 + 0.01 * k, 0.2, 0}, normal{0, 0, 1};
    const auto strip = [](double height) {
      return Polygon{{{1, -1, height}, {1, 1, height}, {1, 1, 0}, {1, -1, 0}}, {}};
    };
    const auto seen = [&](double height) {
      const PolygonSoup soup(std::vector<Polygon>{strip(height)});
      Viewpoint view(soup);
      view.look_from({x, normal});
      return view.form_factor({0, {}}, 1);
    };
    double low = 1e-8, high = 1e-6;
    ASSERT_EQ(seen(low).F, 0);
    ASSERT_GT(seen(high).F, 0);
    for (int step = 0; step < 48; ++step) {
      const double middle = 0.5 * (low + high);
      (seen(middle).F > 0 ? high : low) = middle;
    }
    for (const double height : {low, high}) {
      const PointFormFactor answer = seen(height);
      const auto truth = static_cast<double>(oracle_form_factor({x, normal, strip(height), {}}).F);
      EXPECT_LE(std::fabs(answer.F - truth), answer.error) << k << ": " << height;
    }
  }
}

// Of the two sides of a sheet a point sees one, the front of the side that is turned to it.
TEST(Viewpoint, SheetsAreSeenFromOneSide) {
  const std::vector<Polygon> polygons = {{{{-1, -1, 1}, {-1, 1, 1}, {1, 1, 1}, {1, -1, 1}}, {}},
                                         {{{1, -1, 1}, {1, 1, 1}, {-1, 1, 1}, {-1, -1, 1}}, {}}};
  const PolygonSoup soup(polygons);
  Viewpoint view(soup);
  view.look_from({{0, 0, 0}, {0, 0, 1}});
  EXPECT_GT(view.form_factor({0, {}}).F, 0.5);
  EXPECT_EQ(view.form_factor({1, {}}).F, 0);
}

// A corner of a sheet lies an ulp from the point, so that nearly all of what is seen of the edges that end there is
// seen of their last ulp: a stretch of it that another sheet leaves open must not be taken for one that is not there.
TEST(Viewpoint, StretchesWithinRoundingAreSeen) {
  const Vec3 x{0.0062500000000000003, 0.012500000000000001, 0.018749999999999999}, normal{-0.625, -0.375, -0.625};
  const std::vector<Polygon> polygons = {
      {{{-0.078125, 0.046875, -0.1875},
        {-0.4375, -0.15625, -0.125},
        {0.0062500000000000012, 0.012500000000000002, 0.018749999999999996}},
       {}},
      {{{-0.0625, -0.375, -0.4375}, {-0.3125, -0.0546875, -0.625}, {-0.1875, -0.15625, -0.4375}}, {}},
      {{{-0.21875, -0.875, -0.75}, {-0.3125, -0.009765625, -1.25}, {-1, 0.1875, -0.5}}, {}}};
  const std::vector<Role> roles = {Role::sheet, Role::sheet, Role::unoccluding};
  const PolygonSoup soup(polygons, roles);
  Viewpoint view(soup);
  view.look_from({x, normal});
  const PointFormFactor seen = view.form_factor({2, {}});
  const PointQuestion question{x, normal, polygons[2], {{{polygons[0]}, false}, {{polygons[1]}, false}}};
  EXPECT_NEAR(seen.F, static_cast<double>(oracle_form_factor(question).F), seen.error + kRoundoff);
  EXPECT_LE(seen.error, 1e-13);
}

}  // namespace
}  // namespace exitance
