#include "geometry/shaft.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <optional>

#include "src/stress/placement.h"
#include "src/stress/shaft_oracle.h"

namespace exitance {
namespace {

using Rational = ExactKernel::FT;
using Point = ExactPoint;
using Overlap = Shaft::Overlap;

// --- Scenes -------------------------------------------------------------------------------------------------------

/// A scene of a few small things on a lattice, so that nearly everything touches, is coplanar or in line with
/// something.
struct Things {
  std::vector<Polygon> polygons;
  std::vector<Role> roles;
  void add(const Polygon& p, Role role) {
    polygons.push_back(p);
    roles.push_back(role);
  }
};

Vec3 lattice_vector(Random& random, int size) {
  const auto part = [&] { return static_cast<double>(random.whole(-size, size)); };
  return {part(), part(), part()};
}

Vec3 axis_vector(Random& random, int axis, int size) {
  Vec3 v;
  v[axis] = static_cast<double>(random.whole(1, size));
  return v;
}

void add_lattice_flat(Things& things, Random& random, Role role) {
  const Vec3 p = lattice_vector(random, 3);
  const bool along_axes = random.whole(0, 2) > 0;
  const int axis = random.whole(0, 2);
  Vec3 u = along_axes ? axis_vector(random, axis, 4) : lattice_vector(random, 3);
  Vec3 v = along_axes ? axis_vector(random, (axis + 1) % 3, 4) : lattice_vector(random, 3);
  if (random.whole(0, 1) == 0) std::swap(u, v);
  if (cross(u, v) == Vec3{}) return;
  switch (random.whole(0, 4)) {
    case 0:
      return things.add({{p, p + u, p + v}, {}}, role);
    case 1:  // T-junction
      return things.add({{p, p + 0.5 * u, p + u, p + v}, {}}, role);
    case 2:
      return things.add({{p, p + 2 * u, p + 2 * u + v, p + u + 2 * v, p + 2 * v}, {}}, role);
    default:
      return things.add({{p, p + u, p + u + v, p + v}, {}}, role);
  }
}

/// A parallelepiped; u, v, w turn to the right.
void add_solid(Things& things, const Vec3& p, const Vec3& u, const Vec3& v, const Vec3& w, Role role) {
  for (const auto& [o, s, t] :
       {std::tuple{p, v, u}, {p, w, v}, {p, u, w}, {p + w, u, v}, {p + u, v, w}, {p + v, w, u}}) {
    things.add({{o, o + s, o + s + t, o + t}, {}}, role);
  }
}

void add_lattice_solid(Things& things, Random& random, Role role) {
  const Vec3 p = lattice_vector(random, 3);
  const bool along_axes = random.whole(0, 2) > 0;
  const Vec3 u = along_axes ? axis_vector(random, 0, 3) : lattice_vector(random, 2);
  Vec3 v = along_axes ? axis_vector(random, 1, 3) : lattice_vector(random, 2);
  Vec3 w = along_axes ? axis_vector(random, 2, 3) : lattice_vector(random, 2);
  const double volume = dot(cross(u, v), w);
  if (volume == 0) return;
  if (volume < 0) std::swap(v, w);
  if (random.whole(0, 3) == 0) {
    things.add({{p, p + v, p + u}, {}}, role);
    things.add({{p, p + w, p + v}, {}}, role);
    things.add({{p, p + u, p + w}, {}}, role);
    things.add({{p + u, p + v, p + w}, {}}, role);
    return;
  }
  add_solid(things, p, u, v, w, role);
}

/// Small ends on either side of large things.
Things wall_of_things(Random& random) {
  Things things;
  const auto half = [&](int low, int high) { return 0.5 * static_cast<double>(random.whole(low, high)); };
  for (const double side : {-1.0, 1.0}) {
    for (int k = 0; k < 2; ++k) {
      const Vec3 p{half(-3, 3), half(-3, 3), -2.0 * side}, u{half(1, 3), half(-1, 1), side * half(0, 1)},
          v{half(-1, 1), side * half(1, 3), half(0, 1)};
      things.add(random.whole(0, 1) == 0 ? Polygon{{p, p + u, p + v}, {}} : Polygon{{p, p + u, p + u + v, p + v}, {}},
                 Role::patch);
    }
  }
  for (int k = 0; k < 3; ++k) {
    const Vec3 p{-half(2, 7), -half(2, 7), half(-3, 3)}, u{half(4, 16), half(-1, 1), half(-1, 1)},
        v{half(-1, 1), half(4, 16), half(-1, 1)}, w{half(-2, 2), half(-2, 2), half(1, 2)};
    if (random.whole(0, 1) == 0) {
      things.add({{p, p + u, p + u + v, p + v}, {}}, Role::patch);
    } else {
      add_solid(things, p, u, v, w, Role::patch);
    }
  }
  return things;
}

Things random_things(Random& random) {
  if (random.whole(0, 2) == 0) return wall_of_things(random);
  Things things;
  const int flats = random.whole(2, 5), solids = random.whole(0, 2);
  for (int k = 0; k < flats; ++k) {
    const int kind = random.whole(0, 5);
    add_lattice_flat(things, random, kind == 0 ? Role::sheet : kind == 1 ? Role::unoccluding : Role::patch);
  }
  for (int k = 0; k < solids; ++k)
    add_lattice_solid(things, random, random.whole(0, 1) == 0 ? Role::patch : Role::solid_face);
  return things;
}

struct Tally {
  std::map<Overlap, int> overlaps;
  int not_facing = 0, undecided_blocking = 0, lines = 0;
  int pairs = 0;
};

/// Compares with the oracle everything that Shaft says of a pair of ends.
void check_pair(const PolygonSoup& soup, const ShaftOracle& oracle, Shaft& shaft, const ShaftEnd& given_a,
                const ShaftEnd& given_b, Random& random, Tally& tally) {
  const ExactEnd a = oracle.end(given_a), b = oracle.end(given_b);
  shaft.reset(given_a, given_b);
  ASSERT_EQ(shaft.face_each_other(), oracle.face_each_other(a, b)) << given_a.facet << ' ' << given_b.facet;
  ++tally.pairs;
  std::vector<std::uint32_t> found;
  const Overlap most = shaft.find_occluders(found);
  if (!shaft.face_each_other()) {
    ++tally.not_facing;
    EXPECT_TRUE(found.empty());
    return;
  }
  const auto sides = sides_of_hull(a, b);
  std::vector<std::uint32_t> expected;
  Overlap expected_most = Overlap::outside;
  for (const std::uint32_t index : items_of(soup)) {
    const Overlap overlap = shaft.overlap(index);
    Overlap truth = oracle.overlap(a, b, sides, index);
    const ExactItem item = oracle.item(index);
    const bool own = index == a.facet || index == b.facet;
    if (truth == Overlap::blocking && overlap == Overlap::partial && item.solid && !plainly_separated(a, b, item)) {
      ++tally.undecided_blocking;
      truth = Overlap::partial;
    }
    ++tally.overlaps[truth];
    ASSERT_EQ(overlap, truth) << "item " << index << " of " << soup.facets().size() << " facets, ends " << given_a.facet
                              << ' ' << given_b.facet;
    if (truth != Overlap::outside) expected.push_back(index);
    expected_most = std::max(expected_most, truth);
    const bool contact = std::ranges::any_of(std::array{&a, &b}, [&](const ExactEnd* end) {
      return std::ranges::any_of(soup.coplanar(end->facet), [&](std::uint32_t t) {
        return index < soup.facets().size() ? t == index : soup.facets()[t].shell == index - soup.facets().size();
      });
    });
    if (own || contact || random.whole(0, 3) != 0) continue;
    const Lines lines = look_along_lines(a, b, item, 12, random);
    tally.lines += lines.seen;
    if (overlap == Overlap::outside) {
      ASSERT_EQ(lines.blocked, 0);
    }
    if (overlap == Overlap::blocking) {
      ASSERT_EQ(lines.blocked, lines.seen);
    }
  }
  EXPECT_EQ(found, expected);
  EXPECT_EQ(most, expected_most);
}

/// Without what rounding has made no polygon.
Things placed(const Placement& placement, const Things& things) {
  Things result;
  for (std::size_t k = 0; k < things.polygons.size(); ++k) {
    const Polygon p = placement(things.polygons[k]);
    if (find_defect(p) == PolygonDefect::none) result.add(p, things.roles[k]);
  }
  return result;
}

void expect_all_kinds(const Tally& tally) {
  EXPECT_GT(tally.not_facing, tally.pairs / 20);
  for (const Overlap o : {Overlap::outside, Overlap::partial, Overlap::blocking}) {
    EXPECT_GT(tally.overlaps.at(o), 20) << static_cast<int>(o);
  }
  EXPECT_LT(tally.undecided_blocking, 1 + tally.overlaps.at(Overlap::blocking) / 50);
}

/// All placements, and two in which products of three coordinates overflow and underflow.
std::vector<Placement> shaft_placements() {
  std::vector<Placement> all = placements("shaft");
  Placement huge = all[2], minute = all[2];
  huge.name = "tilted_2^350";
  huge.scale = 0x1p350;
  minute.name = "tilted_2^-350";
  minute.scale = 0x1p-350;
  all.push_back(huge);
  all.push_back(minute);
  return all;
}

class ShaftPlacement : public testing::TestWithParam<Placement> {};

TEST_P(ShaftPlacement, AgreesWithTheOracle) {
  const Placement& placement = GetParam();
  Random random("shaft/" + placement.name);
  Tally tally;
  StageCounts stages;
  for (int scene = 0; scene < 40; ++scene) {
    const Things things = placed(placement, random_things(random));
    const PolygonSoup soup(things.polygons, things.roles);
    const ShaftOracle oracle(soup);
    Shaft shaft(soup);
    const auto n = static_cast<std::uint32_t>(soup.facets().size());
    for (std::uint32_t i = 0; i < n; ++i) {
      for (std::uint32_t j = 0; j < n; ++j) {
        if (soup.facets()[i].polygon == soup.facets()[j].polygon || random.whole(0, 3) != 0) continue;
        check_pair(soup, oracle, shaft, {i, {}}, {j, {}}, random, tally);
        ASSERT_FALSE(HasFatalFailure()) << "scene " << scene;
      }
    }
    stages += shaft.stage_counts();
  }
  expect_all_kinds(tally);
  EXPECT_GT(stages.exact, 0u);
}

/// A facet's piece: its corners moved towards one of them, exactly (lattice placements keep halves and quarters).
std::vector<Vec3> piece_of(const PolygonSoup& soup, std::uint32_t facet, Random& random) {
  const auto corners = soup.corners(soup.facets()[facet]);
  const Vec3 to = corners[static_cast<std::size_t>(random.whole(0, static_cast<int>(corners.size()) - 1))].at;
  const double part = random.whole(0, 1) == 0 ? 0.5 : 0.25;
  std::vector<Vec3> loop;
  for (const Corner& c : corners) loop.push_back(to + part * (c.at - to));
  return loop;
}

class ShaftExactPlacement : public testing::TestWithParam<Placement> {};

TEST_P(ShaftExactPlacement, PiecesAgreeWithTheOracle) {
  const Placement& placement = GetParam();
  Random random("shaft pieces/" + placement.name);
  Tally tally;
  for (int scene = 0; scene < 40; ++scene) {
    const Things things = placed(placement, random_things(random));
    const PolygonSoup soup(things.polygons, things.roles);
    const ShaftOracle oracle(soup);
    Shaft shaft(soup);
    const auto n = static_cast<std::uint32_t>(soup.facets().size());
    for (std::uint32_t i = 0; i < n; ++i) {
      for (std::uint32_t j = 0; j < n; ++j) {
        if (soup.facets()[i].polygon == soup.facets()[j].polygon || random.whole(0, 2) != 0) continue;
        const auto a = piece_of(soup, i, random), b = piece_of(soup, j, random);
        check_pair(soup, oracle, shaft, {i, a}, {j, random.whole(0, 3) == 0 ? std::span<const Vec3>{} : b}, random,
                   tally);
        ASSERT_FALSE(HasFatalFailure()) << "scene " << scene;
      }
    }
  }
  expect_all_kinds(tally);
}

/// Whether a facet lies in the plane of another, or of a shell's facet, up to rounding: there a rounded piece may lie
/// on either side.
bool in_one_plane_but_for_rounding(const ShaftOracle& oracle, std::uint32_t facet, std::uint32_t index) {
  const ExactItem item = oracle.item(index);
  return std::ranges::any_of(item.planes, [&](const ExactSide& plane) {
    return std::ranges::all_of(oracle.loop(facet), [&](const Point& p) {
      const Rational value = plane.value(p), far = plane.normal.squared_length() * (p - plane.origin).squared_length();
      return value == 0 || CGAL::to_double(value * value / far) <= 1e-20;
    });
  });
}

/// Of rounded pieces the answers hold for lines between points away from the pieces' edges.
TEST_P(ShaftPlacement, OfRoundedPiecesHoldsAlongLines) {
  const Placement& placement = GetParam();
  Random random("shaft rounded pieces/" + placement.name);
  std::map<Overlap, int> lines_of;
  for (int scene = 0; scene < 25; ++scene) {
    const Things things = placed(placement, random_things(random));
    const PolygonSoup soup(things.polygons, things.roles);
    const ShaftOracle oracle(soup);
    Shaft shaft(soup);
    const auto n = static_cast<std::uint32_t>(soup.facets().size());
    /// Both the rounded thirds and points well inside the exact ones.
    const auto third = [&](std::uint32_t facet, std::vector<Vec3>& rounded) {
      const auto corners = soup.corners(soup.facets()[facet]);
      const Point to =
          exact_point(corners[static_cast<std::size_t>(random.whole(0, static_cast<int>(corners.size()) - 1))].at);
      ExactEnd end{facet, {}, oracle.plane(facet)};
      for (const Corner& c : corners) end.points.push_back(to + (exact_point(c.at) - to) / 3);
      const Point middle = exact_mean(end.points);
      for (Point& p : end.points) {
        rounded.push_back({CGAL::to_double(p.x()), CGAL::to_double(p.y()), CGAL::to_double(p.z())});
        p = p + Rational(0x1p-20) * (middle - p);
      }
      return end;
    };
    for (int pair = 0; pair < 60 && n > 1; ++pair) {
      const auto i = static_cast<std::uint32_t>(random.whole(0, static_cast<int>(n) - 1)),
                 j = static_cast<std::uint32_t>(random.whole(0, static_cast<int>(n) - 1));
      std::vector<Vec3> a, b;
      const ExactEnd exact_a = third(i, a), exact_b = third(j, b);
      if (soup.facets()[i].polygon == soup.facets()[j].polygon || in_one_plane_but_for_rounding(oracle, i, j)) continue;
      shaft.reset({i, a}, {j, b});
      for (const std::uint32_t item : items_of(soup)) {
        const bool touches_end = std::ranges::any_of(std::array{i, j}, [&](std::uint32_t end) {
          return end == item || std::ranges::any_of(soup.coplanar(end), [&](std::uint32_t t) {
                   return item < n ? t == item : soup.facets()[t].shell == item - n;
                 });
        });
        if (touches_end || in_one_plane_but_for_rounding(oracle, i, item) ||
            in_one_plane_but_for_rounding(oracle, j, item)) {
          continue;
        }
        const Overlap overlap = shaft.overlap(item);
        if (overlap == Overlap::partial) continue;
        const Lines lines = look_along_lines(exact_a, exact_b, oracle.item(item), 10, random);
        lines_of[overlap] += lines.seen;
        ASSERT_EQ(lines.blocked, overlap == Overlap::outside ? 0 : lines.seen)
            << "scene " << scene << " ends " << i << ' ' << j << " item " << item;
      }
    }
  }
  EXPECT_GT(lines_of[Overlap::outside], 1000);
  EXPECT_GT(lines_of[Overlap::blocking], 100);
}

std::string name_of(const testing::TestParamInfo<Placement>& info) {
  std::string name = info.param.name;
  std::ranges::replace_if(
      name, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; }, '_');
  return name;
}

/// Those that keep halves and quarters exact.
std::vector<Placement> exact_placements() {
  std::vector<Placement> exact = shaft_placements();
  std::erase_if(exact,
                [](const Placement& p) { return !p.name.starts_with("lattice") && !p.name.starts_with("tilted"); });
  return exact;
}

INSTANTIATE_TEST_SUITE_P(All, ShaftPlacement, testing::ValuesIn(shaft_placements()), name_of);
INSTANTIATE_TEST_SUITE_P(All, ShaftExactPlacement, testing::ValuesIn(exact_placements()), name_of);

// --- One by one ---------------------------------------------------------------------------------------------------

/// A unit square on the floor that looks up, its like two above that looks down, and one more thing; in every
/// placement.
struct Between {
  explicit Between(const Things& between, const Placement& placement) {
    Things all;
    all.add({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {}}, Role::patch);
    all.add({{{0, 0, 2}, {0, 1, 2}, {1, 1, 2}, {1, 0, 2}}, {}}, Role::patch);
    for (std::size_t k = 0; k < between.polygons.size(); ++k) all.add(between.polygons[k], between.roles[k]);
    for (Polygon& p : all.polygons) p = placement(p);
    soup.emplace(all.polygons, all.roles);
    Shaft shaft(*soup, {0, {}}, {1, {}});
    overlap = shaft.find_occluders(found);
  }
  std::optional<PolygonSoup> soup;
  std::vector<std::uint32_t> found;
  Overlap overlap = Overlap::outside;
};

class ShaftCase : public testing::TestWithParam<Placement> {
 protected:
  Overlap between(const Polygon& polygon, Role role = Role::patch) const {
    Things things;
    things.add(polygon, role);
    return Between(things, GetParam()).overlap;
  }
  Overlap between_box(const Vec3& lower, const Vec3& upper, Role role = Role::patch) const {
    Things things;
    const Vec3 d = upper - lower;
    add_solid(things, lower, {d.x, 0, 0}, {0, d.y, 0}, {0, 0, d.z}, role);
    return Between(things, GetParam()).overlap;
  }
};

TEST_P(ShaftCase, WhatTouchesFromOutsideDoesNotEnter) {
  EXPECT_EQ(between({{{1, 0, 0.5}, {1, 1, 0.5}, {1, 1, 1}, {1, 0, 1}}, {}}), Overlap::outside) << "in a side";
  EXPECT_EQ(between({{{1, 0, 1}, {2, 0, 1}, {2, 1, 1}, {1, 1, 1}}, {}}), Overlap::outside) << "by an edge";
  EXPECT_EQ(between({{{1, 0.5, 1}, {2, 0, 1}, {2, 1, 1}}, {}}), Overlap::outside) << "by a vertex";
  EXPECT_EQ(between({{{1.5, 0.5, 1}, {0.5, 1.5, 1}, {2, 2, 1}}, {}}), Overlap::outside) << "an edge of the shaft";
  EXPECT_EQ(between({{{0.5, 0.5, 0}, {0, 0, -1}, {1, 0, -1}}, {}}), Overlap::outside) << "an end from behind";
  EXPECT_EQ(between_box({1, 0, 0}, {2, 1, 2}), Overlap::outside) << "a box along a side";
  EXPECT_EQ(between_box({1, 1, 0}, {2, 2, 2}), Overlap::outside) << "a box along an edge";
  EXPECT_EQ(between_box({0, 0, -1}, {1, 1, 0}, Role::solid_face), Overlap::outside) << "a box under an end";
}

TEST_P(ShaftCase, WhatTouchesFromInsideEnters) {
  EXPECT_EQ(between({{{1, 0, 1}, {1, 1, 1}, {0.5, 0.5, 1}}, {}}), Overlap::partial) << "by an edge";
  EXPECT_EQ(between({{{1, 0.5, 1}, {0.5, 0.75, 1}, {0.5, 0.25, 1}}, {}}), Overlap::partial) << "by a vertex";
  EXPECT_EQ(between({{{0.5, 0.5, 0}, {0.5, 0.5, 2}, {1, 0.5, 2}}, {}}), Overlap::partial) << "edge-on";
  EXPECT_EQ(between({{{-1, 0.5, 0}, {2, 0.5, 0}, {2, 0.5, 2}, {-1, 0.5, 2}}, {}}), Overlap::partial) << "a divider";
  EXPECT_EQ(between_box({0.5, 0, 0.5}, {1, 1, 1}), Overlap::partial);
}

TEST_P(ShaftCase, BlockingTakesTheWholeCrossSection) {
  EXPECT_EQ(between({{{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}, {}}), Overlap::blocking) << "exactly";
  EXPECT_EQ(between({{{-1, -1, 0}, {2, -1, 0.5}, {2, 2, 2}, {-1, 2, 1.5}}, {}}), Overlap::blocking) << "tilted";
  EXPECT_EQ(between({{{0, 0, 1}, {0.75, 0, 1}, {1, 0.25, 1}, {1, 1, 1}, {0, 1, 1}}, {}}), Overlap::partial);
  EXPECT_EQ(between({{{-1, 0, 0}, {2, 0, 0}, {2, 1, 2}, {-1, 1, 2}}, {}}), Overlap::blocking) << "edge to edge";
  EXPECT_EQ(between_box({0, 0, 0.5}, {1, 1, 1}), Overlap::blocking);
  EXPECT_EQ(between_box({-1, -1, 0.5}, {2, 2, 3}), Overlap::blocking) << "one end in a solid";
  EXPECT_EQ(between_box({-1, -1, -1}, {2, 2, 3}), Overlap::outside) << "both ends in a solid";
}

TEST_P(ShaftCase, WhatLiesInAnEndsPlaneEntersWhereItCovers) {
  const Polygon all{{{-1, -1, 0}, {2, -1, 0}, {2, 2, 0}, {-1, 2, 0}}, {}},
      half{{{0.5, -1, 0}, {2, -1, 0}, {2, 2, 0}, {0.5, 2, 0}}, {}},
      beside{{{1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}}, {}};
  EXPECT_EQ(between(all), Overlap::blocking) << "a rug, later in the scene";
  EXPECT_EQ(between(half, Role::sheet), Overlap::partial);
  EXPECT_EQ(between(beside, Role::sheet), Overlap::outside);
  EXPECT_EQ(between({{all.outer.rbegin(), all.outer.rend()}, {}}), Overlap::outside) << "the back of a sheet";
  EXPECT_EQ(between_box({0, 0, 0}, {1, 1, 1}, Role::solid_face), Overlap::blocking) << "a box that stands on it";
  EXPECT_EQ(between_box({0.5, 0, 0}, {2, 1, 1}, Role::solid_face), Overlap::partial);
  EXPECT_EQ(between_box({-1, -1, -1}, {2, 2, 0}, Role::solid_face), Overlap::outside) << "a box underneath";
  EXPECT_EQ(between_box({-1, -1, -1}, {2, 2, 0}), Overlap::blocking) << "a box let in, whose lid lies on top";
}

INSTANTIATE_TEST_SUITE_P(Exact, ShaftCase,
                         testing::Values(shaft_placements()[0], shaft_placements()[2], shaft_placements()[3],
                                         shaft_placements()[9]),
                         name_of);

TEST(Shaft, EndsThatDoNotFaceEachOtherHaveNone) {
  const Polygon floor{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {}},
      beside{{{1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}}, {}}, back{{{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}, {}},
      wall{{{1, 0, 0}, {1, 0, 1}, {1, 1, 1}, {1, 1, 0}}, {}},
      between{{{0.5, 0, 0.25}, {1, 0, 0.25}, {1, 1, 0.25}, {0.5, 1, 0.25}}, {}};
  const PolygonSoup soup(std::vector<Polygon>{floor, beside, back, wall, between});
  Shaft shaft(soup, {0, {}}, {1, {}});
  std::vector<std::uint32_t> found;
  EXPECT_FALSE(shaft.face_each_other());
  EXPECT_EQ(shaft.find_occluders(found), Overlap::outside);
  shaft.reset({0, {}}, {2, {}});
  EXPECT_FALSE(shaft.face_each_other());
  EXPECT_EQ(shaft.overlap(4), Overlap::outside);
  shaft.reset({0, {}}, {0, {}});
  EXPECT_FALSE(shaft.face_each_other());
  shaft.reset({0, {}}, {3, {}});
  EXPECT_TRUE(shaft.face_each_other());
  EXPECT_EQ(shaft.overlap(4), Overlap::partial) << "about a shared edge";
}

/// An end that crosses the other's plane: what stands below it does not enter.
TEST(Shaft, WhatStandsBelowAnEndsPlaneDoesNotEnter) {
  const Polygon shelf{{{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}, {}},
      wall{{{2, 0, 0}, {2, 0, 2}, {2, 1, 2}, {2, 1, 0}}, {}},
      below{{{1.5, 0, 0}, {1.5, 1, 0}, {1.5, 1, 1}, {1.5, 0, 1}}, {}},
      above{{{1.5, 0, 1}, {1.5, 1, 1}, {1.5, 1, 2}, {1.5, 0, 2}}, {}};
  const PolygonSoup soup(std::vector<Polygon>{shelf, wall, below, above});
  Shaft shaft(soup, {0, {}}, {1, {}});
  std::vector<std::uint32_t> found;
  EXPECT_EQ(shaft.find_occluders(found), Overlap::partial) << "though it hides all that the ends see of each other";
  EXPECT_EQ(found, std::vector<std::uint32_t>{3});
}

/// Corners of a turned room: pieces that end on a neighbour's edge, rounded, do not let the neighbour in.
TEST(Shaft, NeighboursOfRoundedPiecesStayOutside) {
  Random random("neighbours of rounded pieces");
  for (const Placement& placement : placements("neighbours")) {
    Things solid;
    add_solid(solid, {0, 0, 0}, {3, 0, 0}, {0, 2, 0}, {0, 0, 1}, Role::patch);
    Things room;
    for (const Polygon& p : solid.polygons) {  // as triangles that face inward
      const Vec3 &a = p.outer[0], &b = p.outer[1], &c = p.outer[2], &d = p.outer[3];
      room.add(placement(Polygon{{a, c, b}, {}}), Role::patch);
      room.add(placement(Polygon{{a, d, c}, {}}), Role::patch);
    }
    const PolygonSoup soup(room.polygons, room.roles);
    Shaft shaft(soup);
    int asked = 0;
    for (int pair = 0; pair < 200; ++pair) {
      const auto i = static_cast<std::uint32_t>(random.whole(0, 11)),
                 j = static_cast<std::uint32_t>(random.whole(0, 11));
      const auto part_of = [&](std::uint32_t facet) {
        const auto corners = soup.corners(soup.facets()[facet]);
        std::vector<Vec3> loop;
        for (const Corner& c : corners) loop.push_back(corners[0].at + (1.0 / 3) * (c.at - corners[0].at));
        return loop;
      };
      const auto a = part_of(i), b = part_of(j);
      shaft.reset({i, a}, {j, b});
      if (!shaft.face_each_other()) continue;
      StageCounts counts;
      for (std::uint32_t t = 0; t < 12; ++t) {
        const Plane& plane = soup.facets()[t].plane;
        const bool in_front = std::ranges::all_of(std::array{i, j}, [&](std::uint32_t f) {
          return std::ranges::all_of(soup.corners(soup.facets()[f]),
                                     [&](const Corner& c) { return side_of(plane, c.at, counts) >= 0; });
        });
        if (!in_front) continue;
        ++asked;
        EXPECT_EQ(shaft.overlap(t), Overlap::outside) << placement.name;
      }
    }
    EXPECT_GT(asked, 100) << placement.name;
  }
}

/// Pieces of two walls of a turned room that meet in a corner: all else is beyond it, but in front of both.
TEST(Shaft, WhatLiesBeyondPiecesThatMeetInACornerStaysOutside) {
  Things things;
  things.add({{{0, 0, 0},
               {1.5916483741032423, -1.1166531878965318, 2.0542008448968709},
               {1.4097486983335219, 0.69865299146022042, 1.2347034482298276}},
              {}},
             Role::patch);
  things.add({{{1.4097486983335219, 0.69865299146022042, 1.2347034482298276},
               {1.5916483741032423, -1.1166531878965318, 2.0542008448968709},
               {0.18469382064324791, -0.65130657222937538, 3.3973059829204404}},
              {}},
             Role::patch);
  things.add({{{1.0178669613949323, -0.77932156396400432, 1.7085387759255997},
               {1.1940855486866226, -0.69198994003147674, 1.8628767069543279},
               {1.2395604676290528, -1.1458164848706649, 2.0677510561210886}},
              {}},
             Role::sheet);
  const PolygonSoup soup(things.polygons, things.roles);
  const std::vector<Vec3> a{{1.500698536218382, -0.20900009821815568, 1.6444521465633493},
                            {0.70487434916676095, 0.34932649573011021, 0.61735172411491379},
                            {0.79582418705162117, -0.55832659394826589, 1.0271004224484355}},
      b{{1.4097486983335219, 0.69865299146022042, 1.2347034482298276},
        {1.500698536218382, -0.20900009821815568, 1.6444521465633493},
        {0.79722125948838496, 0.023673209615422519, 2.3160047155751338}};
  Shaft shaft(soup, {0, a}, {1, b});
  ASSERT_TRUE(shaft.face_each_other());
  std::vector<std::uint32_t> found;
  EXPECT_EQ(shaft.find_occluders(found), Overlap::outside);
  EXPECT_EQ(shaft.overlap(2), Overlap::outside) << "its every y is less than the ends'";
}

}  // namespace
}  // namespace exitance
