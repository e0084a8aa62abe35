// Solids that are not convex, as occluders: their silhouettes against the oracle, where edges coincide, solids touch
// and points lie in the planes of faces.

#include "geometry/silhouette.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "geometry/view_cones.h"
#include "geometry/viewpoint.h"
#include "src/stress/placement.h"
#include "src/stress/visibility_oracle.h"
#include "tests/geometry/solids.h"

namespace exitance {
namespace {

const Faces& solid(int kind) {
  static const std::array<Faces, 6> solids{
      prism({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}, 2, 3),                          // an L
      prism({{-2, -2}, {2, -2}, {2, 2}, {1, 2}, {1, -1}, {-1, -1}, {-1, 2}, {-2, 2}}, 2, 4),  // a U
      prism({{0, 0}, {3, 0}, {3, 3}, {2, 3}, {2, 2}, {1, 2}, {1, 1}, {0, 1}}, 3, 4),          // stairs
      ring(1, 2, 3, 4),
      vase(8, 4, 2),
      prism({{-3, -1}, {3, -1}, {3, 1}, {1, 1}, {1, 0}, {-1, 0}, {-1, 1}, {-3, 1}}, 1, 2)};  // a bridge
  return solids[static_cast<std::size_t>(kind)];
}

Faces moved(Faces faces, const Vec3& by) {
  for (Polygon& f : faces) {
    for (Vec3& v : f.outer) v = v + by;
  }
  return faces;
}

struct Question {
  Vec3 point, normal;
  Polygon source;
  std::vector<Faces> solids;
};

Question question(Random& random, int solids) {
  const auto whole = [&](int low, int high) { return double(random.whole(low, high)); };
  Question q;
  q.point = {whole(-3, 3), whole(-3, 3), whole(-1, 0)};
  q.normal = {whole(-1, 1), whole(-1, 1), 2};
  const double x = whole(-4, 0), y = whole(-4, 0), z = whole(4, 6);
  q.source = {{{x, y, z}, {x, y + whole(2, 6), z}, {x + whole(2, 6), y + 5, z}, {x + 4, y, z}}, {}};
  for (int k = 0; k < solids; ++k) {
    q.solids.push_back(moved(solid(random.whole(0, 5)), {whole(-2, 2), whole(-2, 2), whole(-1, 0)}));
  }
  return q;
}

TEST(Silhouette, AgreesWithTheOracle) {
  std::size_t asked = 0, by_silhouette = 0, partial = 0;
  for (const Placement& place : placements("silhouettes")) {
    Random random("silhouettes " + place.name);
    for (int k = 0; k < 60; ++k) {
      const Question q = question(random, 1 + k % 3);
      std::vector<Polygon> polygons{place(q.source)};
      std::vector<Role> roles{Role::patch};
      std::vector<Obstacle> occluders;
      for (const Faces& faces : q.solids) {
        Obstacle& occluder = occluders.emplace_back();
        occluder.solid = true;
        for (const Polygon& f : faces) occluder.faces.push_back(place(f));
        polygons.insert(polygons.end(), occluder.faces.begin(), occluder.faces.end());
        roles.resize(polygons.size(), Role::solid_face);
      }
      if (!std::ranges::all_of(polygons, [](const Polygon& p) { return find_defect(p) == PolygonDefect::none; }))
        continue;
      const PolygonSoup soup(polygons, roles);
      const Vec3 point = place(q.point), normal = place.normal(q.normal);
      Viewpoint viewpoint(soup);
      viewpoint.look_from({point, normal});
      double F = 0, error = 0;
      for (std::uint32_t f = soup.first_facet(0); f < soup.first_facet(1); ++f) {
        const PointFormFactor answer = viewpoint.form_factor({f, {}});
        if (answer.side != Side::front) continue;
        F += answer.F;
        error += answer.error;
        partial += answer.visibility == Visibility::partial;
      }
      const auto truth = static_cast<double>(oracle_form_factor({point, normal, polygons[0], occluders}).F);
      EXPECT_LE(std::fabs(F - truth), error + 1e-17) << place.name << ", question " << k << ": " << F << ", " << truth;
      EXPECT_LE(error, 1e-11) << place.name << ", question " << k;

      View view(soup);
      view.look_from({point, normal});
      ViewCones<double> cones(view);
      for (std::uint32_t s = 0; s < soup.shells().size(); ++s) {
        ++asked;
        by_silhouette += view.outside(soup.shells()[s]) && cones.silhouette_of(s).is_usable;
      }
    }
  }
  EXPECT_GT(by_silhouette, asked / 2) << "of " << asked;
  EXPECT_GT(partial, asked / 8);
}

/// What a point sees of a source behind a solid and sheets, and what the oracle says.
struct Comparison {
  double F = 0, error = 0, truth = 0;
  bool is_partial = false;
};
Comparison compare(const Vec3& point, const Vec3& normal, const Faces& solid, const Faces& sheets,
                   const Polygon& source) {
  std::vector<Polygon> polygons = solid;
  polygons.insert(polygons.end(), sheets.begin(), sheets.end());
  polygons.push_back(source);
  std::vector<Role> roles(solid.size(), Role::solid_face);
  roles.resize(solid.size() + sheets.size(), Role::sheet);
  roles.push_back(Role::patch);
  const PolygonSoup soup(polygons, roles);
  Viewpoint view(soup);
  view.look_from({point, normal});
  Comparison c;
  const auto last = static_cast<std::uint32_t>(polygons.size()) - 1;
  for (std::uint32_t f = soup.first_facet(last); f < soup.first_facet(last + 1); ++f) {
    const PointFormFactor answer = view.form_factor({f, {}});
    if (answer.side != Side::front) continue;
    c.F += answer.F;
    c.error += answer.error;
    c.is_partial = c.is_partial || answer.visibility == Visibility::partial;
  }
  std::vector<Obstacle> occluders{{solid, true}};
  for (const Polygon& sheet : sheets) occluders.push_back({{sheet}, false});
  c.truth = static_cast<double>(oracle_form_factor({point, normal, source, occluders}).F);
  return c;
}

// Edges in one plane through the point, each from one direction of it to another: of all pairs, in planes across every
// axis and none, those coincide that turn the same way and share an angle.
TEST(Silhouette, EdgesCoincideThatRunTheSameWayOverOneAnother) {
  constexpr std::array<std::array<int, 2>, 7> kDirections{{{5, -1}, {4, 1}, {3, 2}, {2, 3}, {1, 4}, {-1, 5}, {-3, 4}}};
  struct Span {
    std::size_t from, to;
  };
  for (const auto& [u, v] : {std::pair(Vec3{1, 0, 0}, Vec3{0, 1, 0}), std::pair(Vec3{0, 1, 0}, Vec3{0, 0, 1}),
                             std::pair(Vec3{0, 0, 1}, Vec3{1, 0, 0}), std::pair(Vec3{2, 3, 6}, Vec3{-6, -2, 3})}) {
    const Vec3 x{3, -2, 1};
    const auto at = [&](std::size_t direction, int far) {
      const auto& [p, q] = kDirections[direction];
      return x + double(far * p) * u + double(far * q) * v;
    };
    std::vector<Span> spans;
    for (std::size_t from = 0; from < 7; ++from) {
      for (std::size_t to = 0; to < 7; ++to) {
        if (from != to) spans.push_back({from, to});
      }
    }
    for (const Span& a : spans) {
      for (const Span& b : spans) {
        const Vec3 a0 = at(a.from, 2), a1 = at(a.to, 1), b0 = at(b.from, 1), b1 = at(b.to, 3);
        const ViewPlane side_a{ViewPlane::Kind::edge, 1, &a0, &a1, nullptr},
            side_b{ViewPlane::Kind::edge, 1, &b0, &b1, nullptr};
        const bool same_way = (a.from < a.to) == (b.from < b.to);
        const bool overlap = std::max(std::min(a.from, a.to), std::min(b.from, b.to)) <
                             std::min(std::max(a.from, a.to), std::max(b.from, b.to));
        EXPECT_EQ(coincide(x, side_a, side_b), same_way && overlap)
            << a.from << a.to << b.from << b.to << " in the plane of " << u.x << u.y << u.z;
      }
    }
  }
}

// Stairs from a point in line with their steps, from which one step's edge stands before the next one's: up to where
// the one is seen over the other, and beside that line, they are of use.
TEST(Silhouette, IsNotUsableWhereEdgesCoincide) {
  const Faces stairs = prism({{0, 0}, {3, 0}, {3, 3}, {2, 3}, {2, 2}, {1, 2}, {1, 1}, {0, 1}}, 3, 4);
  struct Look {
    Vec3 from;
    bool usable;
  };
  for (const Look& look : {Look{{-1, 0, 2.5}, false}, Look{{-2, -1, 2.75}, false}, Look{{-1, 0, 0}, true},
                           Look{{-1, 0.125, 2.5}, true}, Look{{-2, -1.125, 2.75}, true}}) {
    for (const bool turn : {false, true}) {
      const auto placed = [&](const Vec3& v) { return turn ? Vec3{3 * v.x - 4 * v.z, 5 * v.y, 4 * v.x + 3 * v.z} : v; };
      Faces faces = stairs;
      for (Polygon& face : faces) std::ranges::transform(face.outer, face.outer.begin(), placed);
      const PolygonSoup soup(faces, std::vector<Role>(faces.size(), Role::solid_face));
      ASSERT_EQ(soup.shells().size(), 1u);
      View view(soup);
      view.look_from({placed(look.from), placed({0, 0, 1})});
      ViewCones<double> cones(view);
      EXPECT_EQ(cones.silhouette_of(0).is_usable, look.usable) << look.from.x << ' ' << look.from.y << ' ' << turn;
    }
  }
}

// Sheets that reach below the horizon, before and behind a solid above it.
TEST(Silhouette, CoversEdgesThatReachBelowTheHorizon) {
  std::size_t partial = 0;
  for (const Placement& place : placements("silhouettes and sheets")) {
    Random random("silhouettes and sheets " + place.name);
    for (int k = 0; k < 4; ++k) {
      const Question q = question(random, 1);
      const auto whole = [&](int low, int high) { return double(random.whole(low, high)); };
      const Polygon sheet{{{whole(-4, 0), whole(-4, 0), whole(2, 7)},
                           {whole(1, 4), whole(-4, 4), whole(2, 7)},
                           {whole(-4, 4), whole(1, 4), whole(-9, -4)}},
                          {}};
      const auto placed = [&](Faces faces) {
        for (Polygon& face : faces) face = place(face);
        return faces;
      };
      const Faces faces = placed(q.solids[0]), sheets = placed({sheet}), source = placed({q.source});
      const auto is_sound = [](const Polygon& p) { return find_defect(p) == PolygonDefect::none; };
      if (!std::ranges::all_of(faces, is_sound) || !is_sound(sheets[0]) || !is_sound(source[0])) continue;
      const Comparison c = compare(place(q.point), place.normal(q.normal), faces, sheets, source[0]);
      EXPECT_LE(std::fabs(c.F - c.truth), c.error + 1e-17) << place.name << ", question " << k;
      EXPECT_LE(c.error, 1e-11) << place.name << ", question " << k;
      partial += c.is_partial;
    }
  }
  EXPECT_GT(partial, 8u);
}

// An edge comes out from behind a solid and goes on below the horizon; half way round from its end there is the solid
// again, so that the way along it must start at the end that is above.
TEST(Silhouette, AnEdgeIsFollowedFromTheEndThatIsAboveTheHorizon) {
  const Placement straight, tilted{"tilted", {1, -1, 0}, {1, 1, -2}, {1, 1, 1}, {}};
  for (const Placement& place : {straight, tilted}) {
    const auto placed = [&](Faces faces) {
      for (Polygon& face : faces) face = place(face);
      return faces;
    };
    const Faces solid = placed(prism({{8, -2}, {12, -2}, {12, 0}, {10, 0}, {10, 2}, {8, 2}}, 1, 4)),
                source = placed({{{{-100, -100, 8}, {-100, 100, 8}, {100, 100, 8}, {100, -100, 8}}, {}}});
    Faces sheet = placed({{{{18, -1, 6}, {-8, -1, -2}, {2, -6, 3}}, {}}});
    const double without = compare({}, place.normal({0, 0, 1}), solid, {}, source[0]).truth;
    for (const bool turned_over : {false, true}) {
      if (turned_over) std::ranges::reverse(sheet[0].outer);
      const Comparison c = compare({}, place.normal({0, 0, 1}), solid, sheet, source[0]);
      EXPECT_LE(std::fabs(c.F - c.truth), c.error + 1e-17) << c.F << ", " << c.truth;
      EXPECT_LE(c.error, 1e-13);
      EXPECT_LT(c.truth, without - 1e-3);
    }
  }
}

// An edge of a sheet starts so little above the horizon that its height comes out as 0 and ends as little below. A
// solid that is open to one side only hides all of the sheet and, half way round from its lower end, what is there.
TEST(Silhouette, AnEndIsAboveTheHorizonByExactSigns) {
  const Placement tilted{"tilted", {1, -1, 0}, {1, 1, -2}, {1, 1, 1}, {}};
  Faces solid = prism({{-10, -10}, {10, -10}, {10, 10}, {8, 10}, {8, -8}, {-8, -8}, {-8, 10}, {-10, 10}}, 0, 4);
  for (Polygon& face : solid) face = tilted(face);
  const Vec3 x{0, -(0x1p-53 - 0x1p-60), 0};  // 2^-53 below the solid
  Vec3 end = tilted({1, 1, 0});
  end.z -= 0x1p-51;
  Polygon sheet{{tilted({2, -1, 0}), end, tilted({4, 0, 1})}, {}};
  const Polygon source = tilted(Polygon{{{30, -60, -5}, {30, -60, 20}, {30, 60, 20}, {30, 60, -5}}, {}});
  for (const bool turned_over : {false, true}) {
    if (turned_over) std::ranges::reverse(sheet.outer);
    const Comparison c = compare(x, {1, 1, 1}, solid, {sheet}, source);
    EXPECT_GT(c.truth, 1e-3);
    EXPECT_LE(std::fabs(c.F - c.truth), c.error + 1e-17) << c.F << ", " << c.truth;
    EXPECT_LE(c.error, 1e-13);
  }

  // Of that edge the solid covers what is above its own bottom.
  std::vector<Polygon> polygons = solid;
  polygons.push_back({{tilted({2, -1, 0}), end, tilted({4, 0, 1})}, {}});
  std::vector<Role> roles(solid.size(), Role::solid_face);
  roles.push_back(Role::sheet);
  const PolygonSoup soup(polygons, roles);
  View view(soup);
  view.look_from({x, {1, 1, 1}});
  ViewCones<double> cones(view);
  ASSERT_TRUE(cones.silhouette_of(0).is_usable);
  const Cone<double>& cone = cones.of_facet(static_cast<std::uint32_t>(soup.facets().size()) - 1);
  const auto edge = std::ranges::find_if(cone.sides, [](const auto& side) { return side.from == 0; });
  ASSERT_TRUE(edge != cone.sides.end() && edge->to == 1);
  LayersOverEdge<double> layers;
  std::vector<Stretch<double>> covered;
  StageCounts counts;
  EXPECT_FALSE(layers.find(cone, *edge, cones.silhouette_of(0), Tie::silhouette_moves,
                           {{x, {1, 1, 1}, {}}, counts, kFinestPerAngle}, covered));
  ASSERT_EQ(covered.size(), 1u);
  EXPECT_EQ(covered[0].lo, 0);
  // Heights times 2^53 at both ends; that of the bottom is 1 − 2^-7 at any distance.
  const double from = 1 - 0x1p-7, to = from - 4;
  EXPECT_GT(covered[0].hi, 0.5 * from / (from - to));
  EXPECT_LT(covered[0].hi, from / (from - to));
}

// Edges of a solid in line with sides of the source, the solid within and beyond them, to all sides.
TEST(Silhouette, EdgesMayBeInLineWithTheSources) {
  for (int turns = 0; turns < 4; ++turns) {
    for (const bool turn : {false, true}) {
      const auto placed = [&](Vec3 v) {
        for (int k = 0; k < turns; ++k) v = {-v.y, v.x, v.z};
        return turn ? Vec3{3 * v.x - 4 * v.z, 5 * v.y, 4 * v.x + 3 * v.z} : v;
      };
      const auto all_placed = [&](Faces faces) {
        for (Polygon& face : faces) std::ranges::transform(face.outer, face.outer.begin(), placed);
        return faces;
      };
      // Its shadow at 4 is twice as large.
      const Faces faces = all_placed(prism({{-1, -1}, {2, -1}, {2, 1}, {1, 1}, {1, 2}, {-1, 2}}, 2, 3));
      for (const auto& [x0, y0, x1, y1] : {std::array{-5, -5, 4, 5},
                                           {-5, -5, 2, 5},
                                           {2, -5, 6, 5},
                                           {-5, -5, 6, 2},
                                           {-5, 2, 6, 6},
                                           {-2, -2, 6, 6},
                                           {-2, -2, 4, 4},
                                           {2, 2, 6, 6}}) {
        const Vec3 a{double(x0), double(y0), 4}, c{double(x1), double(y1), 4};
        const Faces source = all_placed({{{a, {a.x, c.y, 4}, c, {c.x, a.y, 4}}, {}}});
        const Comparison of = compare({0, 0, 0}, placed({0, 0, 1}), faces, {}, source[0]);
        EXPECT_LE(std::fabs(of.F - of.truth), of.error + 1e-17)
            << turns << turn << ": " << x0 << ' ' << y0 << ' ' << x1 << ' ' << y1 << ": " << of.F << ", " << of.truth;
        EXPECT_LE(of.error, 1e-13);
      }
    }
  }
}

// From each point as if it were the first that is looked from.
TEST(Silhouette, IsFoundAnewFromEachPoint) {
  const Polygon source{{{-4, -4, 9}, {-4, 4, 9}, {4, 4, 9}, {4, -4, 9}}, {}};
  for (int kind = 0; kind < 6; ++kind) {
    std::vector<Polygon> polygons = solid(kind);
    std::vector<Role> roles(polygons.size(), Role::solid_face);
    const auto facet = static_cast<std::uint32_t>(polygons.size());
    polygons.push_back(source);
    roles.push_back(Role::patch);
    const PolygonSoup soup(polygons, roles);
    Viewpoint view(soup);
    double lowest = 1, highest = 0;
    for (const Vec3& x : {Vec3{-3, -2, 0}, Vec3{3, 2.5, -0.5}, Vec3{0.25, 0.5, 0}}) {
      Viewpoint other(soup);
      view.look_from({x, {0, 0, 1}});
      other.look_from({x, {0, 0, 1}});
      const Source whole{soup.first_facet(facet), {}};
      const double F = view.form_factor(whole).F;
      EXPECT_EQ(F, other.form_factor(whole).F) << "solid " << kind;
      lowest = std::min(lowest, F);
      highest = std::max(highest, F);
    }
    EXPECT_GT(highest, lowest + 1e-3);
  }
}

// Of a solid across the horizon, or below it, the whole outline tells nothing; of one that touches it neither.
TEST(Silhouette, IsUsableOnlyAboveTheHorizon) {
  const Polygon source{{{-4, -4, 9}, {-4, 4, 9}, {4, 4, 9}, {4, -4, 9}}, {}};
  for (int kind = 0; kind < 6; ++kind) {
    double lowest = HUGE_VAL, highest = -HUGE_VAL;
    for (const Polygon& f : solid(kind)) {
      for (const Vec3& v : f.outer) {
        lowest = std::min(lowest, v.z);
        highest = std::max(highest, v.z);
      }
    }
    for (const double low : {lowest - highest - 1, 0.5 * (lowest - highest), 0.0, 0x1p-40, 1.0}) {
      std::vector<Polygon> polygons = moved(solid(kind), {0, 0, low - lowest});
      std::vector<Role> roles(polygons.size(), Role::solid_face);
      polygons.push_back(source);
      roles.push_back(Role::patch);
      const PolygonSoup soup(polygons, roles);
      ASSERT_EQ(soup.shells().size(), 1u);
      View view(soup);
      view.look_from({{-7.3, -5.9, 0}, {0, 0, 1}});
      ViewCones<double> cones(view);
      EXPECT_EQ(cones.silhouette_of(0).is_usable, low > 0) << "solid " << kind << " from " << low;
    }
  }
}

}  // namespace
}  // namespace exitance
