// Surfaces that lie on others in one plane, turned so that they do but for rounding: from sample points everything
// looks as it does where nothing is turned.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <utility>

#include "src/form_factor/area_closure.h"
#include "src/form_factor/area_rows.h"
#include "src/form_factor/point_rows.h"
#include "src/scene/scene_check.h"
#include "src/visibility/exact_visibility.h"

namespace exitance {
namespace {

using Loop = std::vector<Vec3>;

struct Turn {
  Vec3 axis{0, 0, 1};
  double angle = 0, scale = 1;
  Vec3 shift{};
  Vec3 operator()(const Vec3& v) const {  // Rodrigues
    if (angle == 0) return scale * v + shift;
    const Vec3 k = normalized(axis);
    const Vec3 turned = std::cos(angle) * v + std::sin(angle) * cross(k, v) + (1 - std::cos(angle)) * dot(k, v) * k;
    return scale * turned + shift;
  }
};

Scene empty_scene() {
  Scene scene;
  scene.materials = {{"grey", {0.5}, {1}, "", 0}};
  scene.bands = 1;
  scene.objects = {{"object", ""}};
  return scene;
}

/// Triangles, which are planar and cut alike however they are turned. Of a rectangle either diagonal may be taken.
void add(Scene& scene, Loop loop, bool other_diagonal = false, bool obstruction_only = false) {
  if (other_diagonal) std::ranges::rotate(loop, loop.begin() + 1);
  for (std::size_t k = 1; k + 1 < loop.size(); ++k)
    scene.surfaces.push_back({{{loop[0], loop[k], loop[k + 1]}, {}}, 0, 0, obstruction_only, 0});
}

/// Looks up.
Loop rectangle(double x0, double y0, double x1, double y1, double z = 0) {
  return {{x0, y0, z}, {x1, y0, z}, {x1, y1, z}, {x0, y1, z}};
}

std::array<Loop, 6> faces_of_box(const Vec3& a, const Vec3& b) {
  return {{{{a.x, a.y, a.z}, {a.x, b.y, a.z}, {b.x, b.y, a.z}, {b.x, a.y, a.z}},
           {{a.x, a.y, b.z}, {b.x, a.y, b.z}, {b.x, b.y, b.z}, {a.x, b.y, b.z}},
           {{a.x, a.y, a.z}, {b.x, a.y, a.z}, {b.x, a.y, b.z}, {a.x, a.y, b.z}},
           {{b.x, a.y, a.z}, {b.x, b.y, a.z}, {b.x, b.y, b.z}, {b.x, a.y, b.z}},
           {{b.x, b.y, a.z}, {a.x, b.y, a.z}, {a.x, b.y, b.z}, {b.x, b.y, b.z}},
           {{a.x, b.y, a.z}, {a.x, a.y, a.z}, {a.x, a.y, b.z}, {a.x, b.y, b.z}}}};
}

void add_box(Scene& scene, const Vec3& a, const Vec3& b) {
  for (const Loop& face : faces_of_box(a, b)) add(scene, face);
}

/// Looks in; floor: whether it has one.
void add_room(Scene& scene, bool floor = true) {
  for (Loop face : faces_of_box({-2, -2, 0}, {2, 2, 3})) {
    if (!floor && std::ranges::all_of(face, [](const Vec3& v) { return v.z == 0; })) continue;
    std::ranges::reverse(face);
    add(scene, face);
  }
}

struct Case {
  std::string name;
  Scene scene;
};

std::vector<Case> cases() {
  std::vector<Case> all;
  const auto add_case = [&](const std::string& name, const auto& furnish, bool floor = true) {
    Scene scene = empty_scene();
    add_room(scene, floor);
    furnish(scene);
    all.push_back({name, scene});
  };
  const Loop rug = rectangle(-1, -1.25, 1.25, 1);
  add_case("rug", [&](Scene& s) { add(s, rug); });
  add_case("rug cut otherwise", [&](Scene& s) { add(s, rug, true); });
  add_case("rug that was there before the floor", [&](Scene& s) {
    Scene other = empty_scene();
    add(other, rug);
    add_room(other);
    s = other;
  });
  add_case("rug from wall to wall", [&](Scene& s) { add(s, rectangle(-2, -1, 2, 1), true); });
  add_case("the floor once more", [&](Scene& s) { add(s, rectangle(-2, -2, 2, 2), true); });
  add_case(
      "rug over T-junctions",
      [&](Scene& s) {
        add(s, rectangle(-2, -2, 0, 2));
        add(s, rectangle(0, -2, 2, 0.5));
        add(s, rectangle(0, 0.5, 2, 2), true);
        add(s, rug, true);
      },
      false);
  add_case("two rugs that overlap", [&](Scene& s) {
    add(s, rug);
    add(s, rectangle(0, 0, 1.75, 1.75), true);
  });
  add_case("three rugs, a pile", [&](Scene& s) {
    add(s, rug);
    add(s, rectangle(-0.75, -0.75, 0.75, 0.75), true);
    add(s, rectangle(-0.5, -0.5, 0.5, 0.5));
  });
  add_case("rug under a box", [&](Scene& s) {
    add(s, rug, true);
    add_box(s, {-0.5, -0.5, 0}, {0.5, 0.25, 1});
  });
  add_case("box on half a rug", [&](Scene& s) {
    add(s, rug, true);
    add_box(s, {0.5, -0.5, 0}, {1.75, 0.25, 1});
  });
  add_case("cloth on a box", [&](Scene& s) {
    add_box(s, {-1, -1, 0}, {1, 1, 1});
    add(s, rectangle(-0.5, -0.75, 0.5, 0.75, 1), true);
  });
  add_case("cloth beyond the edges of a box", [&](Scene& s) {
    add_box(s, {-1, -1, 0}, {1, 1, 1});
    add(s, rectangle(-1.5, -0.75, 1.5, 0.75, 1), true);
  });
  add_case("cloth that is as large as a box", [&](Scene& s) {
    add_box(s, {-1, -1, 0}, {1, 1, 1});
    add(s, rectangle(-1, -1, 1, 1, 1), true);
  });
  add_case("box under a cloth", [&](Scene& s) {
    Scene other = empty_scene();
    add(other, rectangle(-0.5, -0.75, 0.5, 0.75, 1), true);
    add_room(other);
    add_box(other, {-1, -1, 0}, {1, 1, 1});
    s = other;
  });
  add_case("cloth on a step", [&](Scene& s) {
    const std::array<Loop, 8> step = {{{{-1, 0, 0}, {1, 0, 0}, {1, 0, 1}, {-1, 0, 1}},
                                       {{-1, 0, 1}, {1, 0, 1}, {1, 0.75, 1}, {-1, 0.75, 1}},
                                       {{-1, 0.75, 1}, {1, 0.75, 1}, {1, 0.75, 2}, {-1, 0.75, 2}},
                                       {{-1, 0.75, 2}, {1, 0.75, 2}, {1, 1.5, 2}, {-1, 1.5, 2}},
                                       {{1, 1.5, 0}, {-1, 1.5, 0}, {-1, 1.5, 2}, {1, 1.5, 2}},
                                       {{-1, 1.5, 0}, {1, 1.5, 0}, {1, 0, 0}, {-1, 0, 0}},
                                       {{1, 0, 0}, {1, 0.75, 0}, {1, 0.75, 1}, {1, 0, 1}},
                                       {{-1, 0, 0}, {-1, 0, 1}, {-1, 0.75, 1}, {-1, 0.75, 0}}}};
    for (const Loop& face : step) add(s, face);
    add(s, {{1, 0.75, 0}, {1, 1.5, 0}, {1, 1.5, 2}, {1, 0.75, 2}});
    add(s, {{-1, 0.75, 0}, {-1, 0.75, 2}, {-1, 1.5, 2}, {-1, 1.5, 0}});
    add(s, rectangle(-0.5, 0, 0.5, 0.5, 1), true);
  });
  add_case("solid with T-junctions", [&](Scene& s) {
    for (const Loop& face : faces_of_box({-1, -1, 0}, {1, 1, 1})) {
      if (std::ranges::all_of(face, [](const Vec3& v) { return v.x == 1; })) continue;
      add(s, face);
    }
    add(s, {{1, -1, 0}, {1, 1, 0}, {1, 1, 0.25}, {1, -1, 0.25}});
    add(s, {{1, -1, 0.25}, {1, 1, 0.25}, {1, 1, 1}, {1, -1, 1}});
  });
  add_case("box without a bottom", [&](Scene& s) {
    for (const Loop& face : faces_of_box({-1, -1, 0}, {1, 0.5, 1})) {
      if (!std::ranges::all_of(face, [](const Vec3& v) { return v.z == 0; })) add(s, face);
    }
  });
  add_case("sheet of two sides that stands on the floor", [&](Scene& s) {
    const Loop sheet = {{-1, 0.25, 0}, {1.25, 0.25, 0}, {1.25, 0.25, 1}, {-1, 0.25, 1}};
    add(s, sheet);
    add(s, {sheet.rbegin(), sheet.rend()}, true);
  });
  add_case("picture on a wall", [&](Scene& s) { add(s, {{-1, 2, 1}, {1, 2, 1}, {1, 2, 2}, {-1, 2, 2}}, true); });
  add_case("box within a box, with a side in common", [&](Scene& s) {
    add_box(s, {-1, -1, 0.25}, {1, 1, 1.5});
    add_box(s, {-0.5, -1, 0.5}, {0.5, 0.5, 1.25});
  });
  add_case("boxes in a corner, side by side and on top of each other", [&](Scene& s) {
    add_box(s, {-2, -2, 0}, {-1, -1, 1});
    add_box(s, {-1, -2, 0}, {0, -1, 1});
    add_box(s, {-1, -2, 1}, {0, -1.5, 2});
    add_box(s, {-2, 1, 2}, {-1, 2, 3});
  });
  add_case("sheet of two sides on a wall, from within a box that stands there", [&](Scene& s) {
    const Loop sheet = {{-1, 2, 1}, {1, 2, 1}, {1, 2, 2.5}, {-1, 2, 2.5}};
    add_box(s, {0, 1, 1}, {1, 2, 2});
    add(s, sheet);
    add(s, {sheet.rbegin(), sheet.rend()});
  });
  add_case("sheet of two sides that is cut otherwise on each", [&](Scene& s) {
    add(s, rectangle(-1, -1, 1, 1, 1));
    const Loop below = rectangle(-1, -1, 1, 0.5, 1), beside = rectangle(-1, 0.5, 1, 1, 1);
    add(s, {below.rbegin(), below.rend()});
    add(s, {beside.rbegin(), beside.rend()}, true);
  });
  add_case("sheet that looks at the floor on which it lies", [&](Scene& s) { add(s, {rug.rbegin(), rug.rend()}); });
  add_case("room beyond a part of a wall", [&](Scene& s) {
    for (Loop face : faces_of_box({2, -1, 0}, {4, 1, 2})) {
      std::ranges::reverse(face);
      add(s, face);
    }
  });
  add_case("obstruction that looks up", [&](Scene& s) { add(s, rug, true, true); });
  add_case("obstruction that looks down", [&](Scene& s) { add(s, {rug.rbegin(), rug.rend()}, true, true); });
  return all;
}

struct Rows {
  explicit Rows(Scene scene, const Turn& turn, double patch_size)
      : Rows(
            [&] {
              for (Surface& surface : scene.surfaces)
                std::ranges::transform(surface.polygon.outer, surface.polygon.outer.begin(), turn);
              return scene;
            }(),
            patch_size) {}
  Rows(const Scene& scene, double patch_size)
      : soup(make_soup(scene)), mesh(make_patch_mesh(scene, soup, {.patch_size = patch_size})) {}

  PointRows all() const { return point_rows(ExactVisibility(mesh, soup), 0, mesh.elements.size()); }

  PolygonSoup soup;
  PatchMesh mesh;
};

std::vector<double> row(const FormFactorMatrix& F, std::size_t i) {
  std::vector<double> dense(F.columns);
  for (std::size_t k = 0; k < F.row(i).size(); ++k) dense[F.row_columns(i)[k]] = F.row(i)[k];
  return dense;
}

/// Infinite where the matrices are not of one size.
double largest_difference(const FormFactorMatrix& F, const FormFactorMatrix& G) {
  if (F.rows() != G.rows() || F.columns != G.columns) return std::numeric_limits<double>::infinity();
  double largest = 0;
  for (std::size_t e = 0; e < F.rows(); ++e) {
    const auto p = row(F, e), q = row(G, e);
    for (std::size_t j = 0; j < p.size(); ++j) largest = std::max(largest, std::fabs(p[j] - q[j]));
  }
  return largest;
}

std::vector<Turn> turns(std::uint64_t seed, int count) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> any(-1, 1);
  std::vector<Turn> all;
  for (int k = 0; k < count; ++k) {
    const Vec3 axis{any(random), any(random), any(random)};
    all.push_back({axis, 3 * any(random)});
  }
  return all;
}

TEST(LevelRows, AreThoseOfTheSceneThatIsNotTurned) {
  for (const Case& c : cases()) {
    for (const double patch_size : {0.0, 1.5}) {
      SCOPED_TRACE(c.name + ", patches of " + std::to_string(patch_size));
      const Rows straight(c.scene, Turn{}, patch_size);
      const PointRows expected = straight.all();
      ASSERT_LT(expected.statistics.closure_max_defect, 1e-12);
      for (const Turn& turn : turns(17, patch_size == 0 ? 4 : 1)) {
        const Rows rows(c.scene, turn, patch_size);
        const PointRows found = rows.all();
        EXPECT_LT(found.statistics.closure_max_defect, 1e-12);
        EXPECT_EQ(found.statistics.covered_points, expected.statistics.covered_points);
        EXPECT_LT(largest_difference(found.F, expected.F), 1e-12) << turn.angle;
      }
    }
  }
}

/// Rooms with a few boxes and sheets at random places of a lattice, on the floor, a wall and each other. No sheets meet
/// at an angle, which would make them one surface that ends on the room's and may pass for a solid.
Scene random_room(std::mt19937_64& random) {
  const auto one_of = [&](int n) { return static_cast<int>(random() % static_cast<std::uint64_t>(n)); };
  const auto stretch = [&](double from, int steps) {
    const int a = one_of(steps), b = a + 1 + one_of(steps - a);
    return std::pair(from + 0.5 * a, from + 0.5 * b);
  };
  Scene scene = empty_scene();
  add_room(scene);
  for (int left = 2 + one_of(3); left > 0; --left) {
    const auto [x0, x1] = stretch(-2, 8);
    const auto [y0, y1] = stretch(-2, 8);
    const auto [z0, z1] = stretch(0, 6);
    if (one_of(2) == 0) {
      add_box(scene, {x0, y0, one_of(2) == 0 ? 0 : z0}, {x1, y1, z1});
      continue;
    }
    Loop sheet = rectangle(x0, y0, x1, y1, one_of(2) == 0 ? 0 : z0);
    const double below = z0 + 0.25, above = std::min(z1, 2.5) + 0.25;
    if (one_of(3) == 0 && below < above) sheet = {{x0, 2, below}, {x1, 2, below}, {x1, 2, above}, {x0, 2, above}};
    add(scene, sheet, one_of(2) == 0);
    if (one_of(3) == 0) add(scene, {sheet.rbegin(), sheet.rend()}, one_of(2) == 0);
  }
  return scene;
}

TEST(LevelRows, OfRandomRooms) {
  std::mt19937_64 random(19);
  const std::vector<Turn> all = turns(20, 40);
  for (std::size_t k = 0; k < all.size(); ++k) {
    SCOPED_TRACE(k);
    const Scene scene = random_room(random);
    const Rows straight(scene, Turn{}, 0), turned(scene, all[k], 0);
    const PointRows expected = straight.all(), found = turned.all();
    EXPECT_LT(expected.statistics.closure_max_defect, 1e-12);
    EXPECT_LT(found.statistics.closure_max_defect, 1e-12);
    EXPECT_EQ(found.statistics.covered_points, expected.statistics.covered_points);
    EXPECT_LT(largest_difference(found.F, expected.F), 1e-12);
  }
}

/// Sheets a few roundings apart, in the order in which they cover each other and against it: too far apart to be level
/// one with all others, too near for some not to be.
TEST(LevelRows, OfPilesOfSheets) {
  constexpr double kNear = 0x1p-47 * 3;
  for (const double step : {0.3, 0.9, 1.1, -0.3, -0.9, -1.1}) {
    for (const Turn& turn : turns(22, 3)) {
      Scene scene = empty_scene();
      add_room(scene);
      const double lowest = step < 0 ? -4 * step * kNear : 0;
      add(scene, rectangle(-1, -1.25, 1.25, 1, lowest));
      add(scene, rectangle(-0.75, -1, 1, 1.25, lowest + step * kNear), true);
      add(scene, rectangle(-1.25, -0.75, 0.75, 0.75, lowest + 2 * step * kNear));
      add(scene, rectangle(-0.5, -0.5, 0.5, 0.5, lowest + 3 * step * kNear), true);
      EXPECT_LT(Rows(scene, turn, 0).all().statistics.closure_max_defect, 1e-12) << step << ' ' << turn.angle;
      EXPECT_LT(Rows(scene, Turn{}, 0).all().statistics.closure_max_defect, 1e-12) << step;
    }
  }
}

/// In a place where coordinates are rounded to 1e-10 m, corners of patches are known no better, and where a solid
/// stands on the floor but for that, as much of its sides is neither seen nor hides anything. A point in a contact may
/// see as much.
TEST(LevelRows, AtAnySizeAndPlace) {
  const Turn place = turns(21, 1).front();
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const PointRows expected = Rows(c.scene, Turn{}, 0).all();
    for (const auto& [scale, shift] : {std::pair(1e-6, 0.0), std::pair(1e6, 0.0), std::pair(1.0, 1e6)}) {
      const Turn turn{place.axis, place.angle, scale, {shift, -0.7 * shift, 0.3 * shift}};
      const PointRows found = Rows(c.scene, turn, 0).all();
      EXPECT_LT(found.statistics.closure_max_defect, shift > 0 ? 1e-10 : 1e-12) << scale << ' ' << shift;
      if (shift == 0) {
        EXPECT_EQ(found.statistics.covered_points, expected.statistics.covered_points) << scale;
      }
      EXPECT_LT(largest_difference(found.F, expected.F), shift > 0 ? 1e-7 : 1e-12) << scale << ' ' << shift;
    }
  }
}

TEST(LevelRows, OfAreasAreThoseOfTheSceneThatIsNotTurned) {
  constexpr double kTolerance = 1e-4;
  for (const Case& c : cases()) {
    if (c.name != "two rugs that overlap" && c.name != "obstruction that looks down" && c.name != "cloth on a box")
      continue;
    SCOPED_TRACE(c.name);
    const auto rows_of = [&](const Turn& turn) {
      const Rows rows(c.scene, turn, 0);
      AreaRows areas = area_rows(rows.mesh, rows.soup, {.pairs = {.tolerance = kTolerance}}, 1);
      return std::pair(area_closure(rows.mesh, rows.soup, areas.F, is_closed(c.scene)), std::move(areas.F));
    };
    const auto [expected_closure, expected] = rows_of({});
    for (const Turn& turn : turns(18, 2)) {
      const auto [closure, found] = rows_of(turn);
      EXPECT_NEAR(closure.max_defect, expected_closure.max_defect,
                  closure.largest_row_error + expected_closure.largest_row_error);
      for (std::size_t e = 0; e < found.rows(); ++e) {
        const auto p = row(found, e), q = row(expected, e);
        for (std::size_t j = 0; j < p.size(); ++j) EXPECT_NEAR(p[j], q[j], 2 * kTolerance) << e << ' ' << j;
      }
    }
  }
}

}  // namespace
}  // namespace exitance
