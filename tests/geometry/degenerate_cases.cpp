#include "tests/geometry/degenerate_cases.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "src/stress/placement.h"
#include "src/stress/stage.h"

namespace exitance {
namespace {

// The stage all families play on: the point is the origin and looks up; the source lies at height 16 and faces down;
// most occluders lie at height 8, so that a length of theirs is twice as long on the source.
constexpr double kSourceHeight = Stage::kSourceHeight, kMiddle = Stage::kMiddle;

Obstacle middle(double x0, double y0, double x1, double y1) {
  return sheet(rectangle(kMiddle, x0, y0, x1, y1));
}
Obstacle middle(const Points2& points) {
  return sheet(at_height(kMiddle, points));
}

/// The same surface as triangles: each face of at most four corners cut along a diagonal.
Obstacle as_triangles(const Obstacle& occluder) {
  Obstacle cut{{}, occluder.solid};
  for (const Polygon& face : occluder.faces) {
    for (std::size_t i = 2; i < face.outer.size(); ++i) {
      cut.faces.push_back({{face.outer[0], face.outer[i - 1], face.outer[i]}, {}});
    }
  }
  return cut;
}

const Polygon kCeiling{reversed(rectangle(kSourceHeight, -8, -8, 8, 8)), {}};

struct Looking {
  Vec3 from, along;
};
const Looking kUp{{0, 0, 0}, {0, 0, 1}};

/// Collects the families on the stage.
class Families {
 public:
  void add(std::string name, std::vector<Obstacle> occluders, const Polygon& source = kCeiling,
           const Looking& looking = kUp) {
    cases_.push_back({std::move(name), looking.from, looking.along, source, std::move(occluders)});
  }

  void shared_edges();
  void source_boundary();
  void repeated();
  void crossing();
  void slivers();
  void source_plane();
  void coplanar();
  void horizon();
  void through_the_point();
  void shapes();
  void no_area();
  void solids();
  void outside();
  void full_cover();
  void small_distances();
  void lattice_soups();

  std::vector<PointCase> take() { return std::move(cases_); }

 private:
  std::vector<PointCase> cases_;
};

void Families::shared_edges() {
  add("shared_edge/pair", {middle(-2, -1, 0, 1), middle(0, -1, 2, 1)});
  add("shared_edge/pair_off_axis", {middle({{1, 1}, {3, 0}, {2, 3}}), middle({{1, 1}, {2, 3}, {-1, 2}})});
  add("shared_edge/pair_one_reversed", {middle(-2, -1, 0, 1), sheet(reversed(rectangle(kMiddle, 0, -1, 2, 1)))});
  add("shared_edge/pair_at_two_heights", {middle(-2, -1, 0, 1), sheet(rectangle(4, 0, -0.5, 1, 0.5))});
  add("shared_edge/in_projection_only", {middle(-2, -1, 1, 1), sheet(rectangle(4, 0.5, -2, 1, 2))});
  add("shared_edge/t_junction", {middle(-2, -1, 0, 1), middle(0, -1, 2, 0), middle(0, 0, 2, 1)});
  add("shared_edge/overlapping_in_line", {middle(-2, -1, 0, 1), middle(0, -3, 2, 0.5)});
  add("shared_edge/same_side", {middle(-2, -1, 0, 1), middle(-1, -2, 0, 2)});
  add("shared_edge/same_side_two_heights", {middle(-2, -1, 0, 1), sheet(rectangle(4, -0.5, -1, 0, 1))});
  add("shared_edge/nested_corner", {middle(-2, -2, 2, 2), middle(-2, -2, 0, 0)});
  add("shared_edge/fold",
      {sheet({{0, -2, 8}, {3, -2, 8}, {3, 2, 8}, {0, 2, 8}}), sheet({{0, -2, 8}, {0, 2, 8}, {-1, 2, 4}, {-1, -2, 4}})});
  add("shared_edge/fold_back",
      {sheet({{0, -2, 8}, {3, -2, 8}, {3, 2, 8}, {0, 2, 8}}), sheet({{0, -2, 8}, {0, 2, 8}, {2, 2, 4}, {2, -2, 4}})});
  add("shared_edge/fold_edge_on",
      {sheet({{0, -2, 8}, {3, -2, 8}, {3, 2, 8}, {0, 2, 8}}), sheet({{0, -2, 8}, {0, 2, 8}, {0, 2, 4}, {0, -2, 4}})});
  for (const int n : {3, 4, 6}) {
    const Points2 rim{{3, 0}, {2, 2}, {-1, 3}, {-3, 1}, {-2, -2}, {1, -3}};
    std::vector<Obstacle> fan, around;
    for (int i = 0; i < n; ++i) {
      const auto p = rim[static_cast<std::size_t>(i * 6 / n)], q = rim[static_cast<std::size_t>((i + 1) * 6 / n % 6)];
      fan.push_back(middle({{0, 0}, p, q}));
      around.push_back(middle({{1, 0}, p, q}));
    }
    add("shared_edge/fan_" + std::to_string(n), fan);
    add("shared_edge/fan_off_centre_" + std::to_string(n), around);
    fan.pop_back();
    add("shared_edge/open_fan_" + std::to_string(n), fan);
  }
  std::vector<Obstacle> bricks, tiles, triangles;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      const double x = column - 1.5 + 0.5 * (row % 2), y = row - 1.5;
      bricks.push_back(middle(x, y, x + 1, y + 1));
      tiles.push_back(middle(column - 1, row - 1, column, row));
      triangles.push_back(as_triangles(tiles.back()));
    }
  }
  add("shared_edge/bricks", bricks);
  add("shared_edge/tiles", tiles);
  add("shared_edge/tiles_as_triangles", triangles);
}

void Families::source_boundary() {
  add("source_edge/inside", {middle(2, -1, 4, 1)});
  add("source_edge/outside", {middle(4, -1, 6, 1)});
  add("source_edge/both_sides", {middle(2, -1, 4, 1), middle(4, -1, 6, 1)});
  add("source_edge/across", {middle(2, -1, 6, 1)});
  add("source_edge/whole_inside", {middle(2, -4, 4, 4)});
  add("source_edge/longer_inside", {middle(2, -5, 4, 5)});
  add("source_edge/longer_outside", {middle(4, -5, 6, 5)});
  add("source_edge/corner_inside", {middle(2, 2, 4, 4)});
  add("source_edge/corner_outside", {middle(4, 4, 6, 6)});
  add("source_edge/corner_beside", {middle(4, 2, 6, 4)});
  add("source_edge/all_four_inside",
      {middle(-4, -4, -3, 4), middle(3, -4, 4, 4), middle(-4, -4, 4, -3), middle(-4, 3, 4, 4)});
  add("source_edge/two_on_one_edge", {middle(2, -2, 4, 0), middle(3, 0, 4, 2)});
  add("source_edge/two_overlapping_on_one_edge", {middle(2, -2, 4, 1), middle(3, 0, 4, 2)});
  add("source_edge/at_two_heights", {middle(2, -2, 4, 1), sheet(rectangle(4, 1, -1, 2, 1))});
  add("source_vertex/on_edge_inside", {middle({{4, 0}, {2, 1}, {2, -1}})});
  add("source_vertex/on_edge_outside", {middle({{4, 0}, {6, -1}, {6, 1}})});
  add("source_vertex/on_edge_across", {middle({{4, 0}, {2, -1}, {6, -3}, {6, 3}, {2, 1}})});
  add("source_vertex/on_vertex_inside", {middle({{4, 4}, {1, 3}, {3, 1}})});
  add("source_vertex/on_vertex_outside", {middle({{4, 4}, {6, 5}, {5, 6}})});
  add("source_vertex/on_vertex_across", {middle({{4, 4}, {3, 6}, {1, 1}, {6, 3}})});
  add("source_vertex/edge_through_vertex", {middle({{3, 5}, {5, 3}, {6, 6}}), middle({{-3, -5}, {-5, -3}, {-1, -1}})});
  add("source_vertex/diagonal", {middle({{-4, -4}, {4, -4}, {4, 4}})});
  add("source_vertex/both_diagonals", {middle({{-4, -4}, {4, -4}, {4, 4}}), middle({{-4, 4}, {4, -4}, {4, 4}})});
  add("source_vertex/long_diagonal", {middle({{-5, -5}, {5, -5}, {5, 5}})});
  add("source_vertex/touching_diagonals", {middle({{-4, -4}, {0, -4}, {0, 0}}), middle({{0, 0}, {4, 4}, {0, 4}})});
}

void Families::repeated() {
  const Loop one = rectangle(kMiddle, -1, -2, 2, 1);
  Loop turned = one;
  std::rotate(turned.begin(), turned.begin() + 1, turned.end());
  add("duplicate/twice", {sheet(one), sheet(one)});
  add("duplicate/thrice", {sheet(one), sheet(one), sheet(one)});
  add("duplicate/reversed", {sheet(one), sheet(reversed(one))});
  add("duplicate/from_another_vertex", {sheet(one), sheet(turned)});
  add("duplicate/same_cone",
      {sheet(one), sheet(rectangle(4, -0.5, -1, 1, 0.5)), sheet(rectangle(2, -0.25, -0.5, 0.5, 0.25))});
  add("duplicate/as_triangles", {sheet(one), as_triangles(sheet(one)), as_triangles(sheet(turned))});
  add("duplicate/two_diagonals", {as_triangles(sheet(one)), as_triangles(sheet(turned))});
  add("duplicate/abutting_twice",
      {middle(-2, -1, 0, 1), middle(0, -1, 2, 1), middle(-2, -1, 0, 1), middle(0, -1, 2, 1)});
  add("duplicate/abutting_and_whole", {middle(-2, -1, 0, 1), middle(0, -1, 2, 1), middle(-2, -1, 2, 1)});
  add("duplicate/on_source_edge", {middle(2, -1, 4, 1), middle(2, -1, 4, 1), sheet(rectangle(4, 1, -0.5, 2, 0.5))});
  add("duplicate/box", {box({-1, -1, 4}, {1, 2, 6}), box({-1, -1, 4}, {1, 2, 6})});
  add("duplicate/repeated_vertices", {sheet({one[0], one[0], one[1], one[2], one[2], one[2], one[3], one[0]})});
  add("duplicate/collinear_vertices", {sheet({one[0], {0, -2, 8}, {1, -2, 8}, one[1], one[2], one[3], {-1, 0, 8}})});
}

void Families::crossing() {
  const Obstacle slope = sheet({{-2, -2, 6}, {2, -2, 10}, {2, 2, 10}, {-2, 2, 6}});
  add("interpenetrating/two", {slope, sheet({{-2, -2, 10}, {2, -2, 6}, {2, 2, 6}, {-2, 2, 10}})});
  add("interpenetrating/edge_in_face", {slope, sheet({{-1, 0, 8}, {1, 0, 8}, {0, 3, 9}})});
  add("interpenetrating/vertex_in_face", {slope, sheet({{0, 0, 8}, {4, 1, 8}, {3, 3, 6}})});
  add("interpenetrating/three", {slope, sheet({{-2, 0, 4}, {2, 0, 5}, {2, 1, 12}, {-2, 1, 11}}), middle(-1, -3, 1, 3)});
  add("interpenetrating/boxes", {box({-2, -2, 4}, {1, 1, 7}), box({-1, -1, 5}, {2, 2, 8})});
  add("interpenetrating/flush_boxes", {box({-2, -2, 4}, {1, 1, 7}), box({-1, -2, 4}, {2, 1, 7})});
  add("interpenetrating/octahedra", {octahedron({0, 0, 8}, 2), octahedron({1, 1, 8}, 2)});
  add("interpenetrating/louvre",
      {sheet({{-3, -3, 6}, {-2, -3, 8}, {-2, 3, 8}, {-3, 3, 6}}),
       sheet({{-1, -3, 6}, {0, -3, 8}, {0, 3, 8}, {-1, 3, 6}}), sheet({{1, -3, 6}, {2, -3, 8}, {2, 3, 8}, {1, 3, 6}}),
       sheet({{-4, 0, 7}, {4, 0, 7}, {4, 1, 7}, {-4, 1, 7}})});
  for (const int n : {3, 5, 8}) {
    std::vector<Obstacle> pencil;  // all edges run through the point over the origin
    for (int i = 0; i < n; ++i) pencil.push_back(middle({{0, 0}, {4, i - 2.0}, {3.5, i - 1.5}}));
    add("interpenetrating/pencil_" + std::to_string(n), pencil);
  }
}

void Families::slivers() {
  for (const int n : {2, 4, 8}) {
    for (const double aspect : {1e3, 1e6, 1e9}) {
      const std::string name =
          "sliver/" + std::to_string(n) + "_of_1e" + std::to_string(std::lround(std::log10(aspect)));
      Random random(name);
      std::vector<Obstacle> needles, crossing;
      for (int i = 0; i < n; ++i) {
        const double x = random.real(-3, 3), y = random.real(-3, 3), z = random.real(4, 12);
        const double dx = random.real(-4, 4), dy = random.real(-4, 4), dz = random.real(-2, 2);
        const double w = 8 / aspect;
        needles.push_back(sheet({{x, y, z}, {x + dx, y + dy, z + dz}, {x - dy * w, y + dx * w, z}}));
        crossing.push_back(
            sheet({{-x, -y, z}, {x, y, z + dz}, {x - w * y, y + w * x, z + dz}, {-x - w * y, -y + w * x, z}}));
      }
      add(name, needles);
      add(name + "_crossing", crossing);
    }
  }
  add("sliver/fan", [] {
    std::vector<Obstacle> fan;
    for (int i = 0; i < 12; ++i) fan.push_back(middle({{-4, -4}, {4, -1 + i / 8.0}, {4, -1 + (i + 1) / 8.0}}));
    return fan;
  }());
  add("sliver/source", {middle(-1, -1, 1, 1)}, {reversed(rectangle(kSourceHeight, -8, 0, 8, 0x1p-27)), {}});
  add("sliver/source_along_edge", {middle(-1, -1, 1, 0)}, {reversed(rectangle(kSourceHeight, -8, 0, 8, 0x1p-27)), {}});
}

void Families::source_plane() {
  const auto slope = [](double y0, double y1, double x0, double z0, double x1, double z1) {
    return sheet({{x0, y0, z0}, {x1, y0, z1}, {x1, y1, z1}, {x0, y1, z0}});
  };
  add("straddling/inside", {slope(-2, 2, 0, 12, 4, 20)});
  add("straddling/leaning_back", {slope(-2, 2, 4, 12, 0, 20)});
  add("straddling/cut_on_source_edge", {slope(-2, 2, 6, 12, 10, 20)});
  add("straddling/cut_on_source_edge_from_outside", {slope(-2, 2, 10, 12, 6, 20)});
  add("straddling/cut_along_whole_edge", {slope(-9, 9, 7, 8, 9, 24)});
  add("straddling/cut_through_corner", {sheet({{6, 6, 12}, {12, 4, 20}, {4, 12, 20}})});
  add("straddling/cut_along_diagonal", {sheet({{-9, -9, 12}, {9, 9, 12}, {9, 9, 20}, {-9, -9, 20}})});
  add("straddling/vertex_in_front", {sheet({{0, 0, 8}, {6, 2, 24}, {2, 6, 24}})});
  add("straddling/vertex_behind", {sheet({{0, 0, 24}, {3, 1, 8}, {1, 3, 8}})});
  add("straddling/needle", {sheet({{1, 1, 15.999}, {1, 2, 15.999}, {1, 1, 1000}})});
  add("straddling/edge_on", {slope(-2, 2, 0, 8, 0, 24)});
  add("straddling/crossing_pair", {slope(-2, 2, 0, 12, 4, 20), slope(-2, 2, 4, 12, 0, 20)});
  add("straddling/shared_edge", {slope(-2, 2, 0, 12, 4, 20), slope(2, 5, 0, 12, 4, 20)});
  add("straddling/shared_edge_behind", {slope(-2, 2, 0, 12, 4, 20), slope(-2, 2, 4, 20, 6, 12)});
  add("straddling/duplicate", {slope(-2, 2, 0, 12, 4, 20), slope(-2, 2, 0, 12, 4, 20)});
  add("straddling/below_the_cut", {slope(-2, 2, 0, 12, 4, 20), sheet(rectangle(8, 0, -1, 1, 1))});
  add("straddling/box", {box({-2, -2, 12}, {2, 2, 20})});
  add("straddling/box_over_corner", {box({6, 6, 12}, {10, 10, 20})});
  add("straddling/box_flush_with_edge", {box({4, -2, 12}, {8, 2, 20})});
  add("straddling/octahedron", {octahedron({1, 1, 16}, 4)});
  add("straddling/from_behind_the_point", {slope(-1, 1, 2, -8, 4, 24)});
  add("touching/vertex", {sheet({{0, 0, 16}, {2, 1, 12}, {1, 2, 12}})});
  add("touching/vertex_on_source_vertex", {sheet({{8, 8, 16}, {5, 6, 12}, {6, 5, 12}})});
  add("touching/vertex_on_source_edge", {sheet({{8, 0, 16}, {5, 1, 12}, {6, -1, 12}})});
  add("touching/vertex_from_behind", {sheet({{0, 0, 16}, {2, 1, 20}, {1, 2, 20}})});
  add("touching/edge", {slope(-2, 2, 0, 12, 4, 16)});
  add("touching/edge_on_source_edge", {slope(-8, 8, 5, 12, 8, 16)});
  add("touching/edge_on_part_of_source_edge", {slope(-2, 3, 5, 12, 8, 16)});
  add("touching/edge_from_behind", {slope(-2, 2, 0, 20, 4, 16)});
  add("touching/two_share_the_edge", {slope(-2, 2, 0, 12, 4, 16), slope(-2, 2, 6, 12, 4, 16)});
  add("touching/wall", {slope(-8, 8, 2, 12, 2, 16)});
  add("touching/walls_around", {slope(-2, 2, 2, 12, 2, 16), slope(-2, 2, -2, 12, -2, 16)});
  add("touching/box", {box({-2, -2, 12}, {2, 2, 16})});
  add("touching/box_at_edge", {box({4, -2, 12}, {8, 2, 16})});
  add("touching/box_at_corner", {box({4, 4, 12}, {8, 8, 16})});
  add("touching/octahedron", {octahedron({1, 1, 12}, 4)});
}

void Families::coplanar() {
  const auto flat = [](double x0, double y0, double x1, double y1) {
    return sheet(rectangle(kSourceHeight, x0, y0, x1, y1));
  };
  add("coplanar/inside", {flat(-2, -1, 3, 2)});
  add("coplanar/inside_reversed", {sheet(reversed(rectangle(kSourceHeight, -2, -1, 3, 2)))});
  add("coplanar/overlapping", {flat(4, -1, 12, 3)});
  add("coplanar/along_edge", {flat(4, -1, 8, 3)});
  add("coplanar/beside", {flat(8, -1, 12, 3)});
  add("coplanar/same", {flat(-8, -8, 8, 8)});
  add("coplanar/larger", {flat(-9, -9, 9, 9)});
  add("coplanar/two_abutting", {flat(-2, -1, 0, 2), flat(0, -1, 2, 2)});
  add("coplanar/tiled", {flat(-8, -8, 0, 8), flat(0, -8, 8, 8)});
  add("coplanar/and_its_shadow", {flat(-2, -2, 2, 2), middle(-1, -1, 1, 1)});
  add("coplanar/abutting_a_shadow", {flat(-2, -2, 2, 2), middle(1, -1, 2, 1)});
  add("coplanar/under_a_straddling_one",
      {flat(-2, -2, 2, 2), sheet({{0, -2, 12}, {4, -2, 20}, {4, 2, 20}, {0, 2, 12}})});
  add("coplanar/box_in_front", {box({-2, -2, 14}, {3, 3, 16})});
  add("coplanar/box_behind", {box({-2, -2, 16}, {3, 3, 18})});
  add("coplanar/boxes_both_sides", {box({-2, -2, 14}, {3, 3, 16}), box({-4, -4, 16}, {1, 1, 18})});
  add("coplanar/tetrahedron_in_front", {tetrahedron({-4, -4, 16}, {4, -4, 16}, {0, 5, 16}, {0, 0, 15})});
  add("coplanar/tetrahedron_behind", {tetrahedron({-4, -4, 16}, {4, -4, 16}, {0, 5, 16}, {0, 0, 19})});
  // From inside, only the face in the source's plane stands between.
  add("coplanar/inside_a_box", {box({-2, -2, -2}, {2, 2, 16})});
  add("coplanar/inside_a_wide_box", {box({-9, -9, -2}, {9, 9, 16})});
}

void Families::horizon() {
  add("horizon/occluder_across", {sheet({{2, -2, -4}, {2, 2, -4}, {2, 2, 4}, {2, -2, 4}})});
  add("horizon/occluder_vertex_on_it", {sheet({{2, -2, 0}, {1, 2, 8}, {2, 1, 8}})});
  add("horizon/occluder_edge_on_it", {sheet({{2, -2, 0}, {2, 2, 0}, {2, 2, 8}, {2, -2, 8}})});
  add("horizon/occluder_in_it", {sheet(rectangle(0, 1, -1, 3, 1))});
  const auto wall = [](double z0, double z1) {
    return Polygon{{{8, 8, z0}, {8, -8, z0}, {8, -8, z1}, {8, 8, z1}}, {}};
  };
  const Polygon front = [&] {
    Polygon p = wall(-8, 8);
    std::reverse(p.outer.begin(), p.outer.end());  // faces the point
    return p;
  }();
  const auto facing = [&](double z0, double z1) { return Polygon{reversed(wall(z0, z1).outer), {}}; };
  const Obstacle half = sheet({{4, -1, 0}, {4, 1, 0}, {4, 1, 4}, {4, -1, 4}});
  const Obstacle across = sheet({{4, -1, -2}, {4, 1, -2}, {4, 1, 2}, {4, -1, 2}});
  const Obstacle below = sheet({{4, -1, -3}, {4, 1, -3}, {4, 1, 0}, {4, -1, 0}});
  for (const auto& [name, source] : {std::pair{"across", front},
                                     {"down_to_it", facing(0, 8)},
                                     {"below", facing(-8, 0)},
                                     {"just_above", facing(-8, 0x1p-30)},
                                     {"seen_from_behind", wall(-8, 8)}}) {
    const std::string family = std::string("horizon/source_") + name;
    add(family, {}, source);
    add(family + "/half", {half}, source);
    add(family + "/occluder_across", {across}, source);
    add(family + "/occluder_below", {below}, source);
    add(family + "/abutting_at_it", {half, below}, source);
    add(family + "/covered", {sheet({{4, -5, 0}, {4, 5, 0}, {4, 5, 5}, {4, -5, 5}})}, source);
    add(family + "/exactly_covered", {sheet({{4, -4, -4}, {4, 4, -4}, {4, 4, 4}, {4, -4, 4}})}, source);
  }
  add("horizon/source_vertex_on_it", {middle(-1, -1, 1, 1)}, {{{8, 0, 0}, {8, 4, 8}, {8, -4, 8}}, {}});
  add("horizon/source_vertices_on_it", {half}, {{{8, 0, -4}, {8, 4, 0}, {8, 0, 4}, {8, -4, 0}}, {}});
  add("horizon/tilted", {middle(-1, -1, 1, 1), middle(1, -1, 2, 2)}, kCeiling, {{0, 0, 0}, {2, 0, 1}});
  add("horizon/through_source_vertices", {middle(-1, -1, 1, 1)}, kCeiling, {{0, 0, 0}, {1, 1, 0}});
  add("horizon/along_source_edge", {middle(-1, -1, 1, 1)}, kCeiling, {{0, 0, 0}, {2, 0, -1}});
  add("horizon/along_source_edge_all_seen", {middle(-1, -1, 1, 1)}, kCeiling, {{0, 0, 0}, {-2, 0, 1}});
  add("horizon/along_occluder_edge", {middle(0, -1, 2, 1)}, kCeiling, {{0, 0, 0}, {1, 0, 0}});
  add("horizon/along_occluder_edge_below", {middle(-2, -1, 0, 1), middle(0, -1, 1, 1)}, kCeiling,
      {{0, 0, 0}, {1, 0, 0}});
  add("horizon/source_overhead_looking_down", {}, kCeiling, {{0, 0, 0}, {0, 0, -1}});
}

void Families::through_the_point() {
  const Vec3 o{};
  const Obstacle veil = middle(-1, -2, 2, 1);
  const std::vector<std::pair<const char*, Loop>> ones{
      {"on_plane", {{2, 0, 1}, {4, 0, 8}, {1, 0, 8}}},
      {"on_edge_line", {{1, 1, 4}, {2, 2, 8}, {3, 1, 8}}},
      {"on_edge", {{-1, -1, -4}, {1, 1, 4}, {3, 1, 8}}},
      {"on_vertex", {o, {2, 1, 8}, {1, 2, 8}}},
      {"on_vertex_of_quad", {o, {2, 0, 8}, {3, 3, 16}, {1, 3, 8}}},
      {"inside", {{-2, -1, 0}, {2, -1, 0}, {0, 2, 0}}},
      {"inside_tilted", {{-2, -2, -1}, {2, -2, 1}, {2, 2, 1}, {-2, 2, -1}}},
      {"inside_upright", {{0, -2, -4}, {0, 2, -4}, {0, 2, 4}, {0, -2, 4}}},
      {"on_edge_of_upright", {{0, -2, 0}, {0, 2, 0}, {0, 2, 4}, {0, -2, 4}}},
  };
  std::vector<Obstacle> all{veil};
  for (const auto& [name, loop] : ones) {
    add(std::string("at_the_point/") + name, {sheet(loop)});
    add(std::string("at_the_point/") + name + "_and_another", {veil, sheet(loop)});
    all.push_back(sheet(loop));
  }
  add("at_the_point/all", all);
  add("at_the_point/wedge", {sheet({o, {2, 0, 8}, {2, 2, 8}}), sheet({o, {2, 2, 8}, {0, 2, 8}})});
  add("at_the_point/box_vertex", {veil, box({0, 0, 0}, {2, 2, 2})});
  add("at_the_point/box_edge", {veil, box({0, -1, 0}, {2, 2, 2})});
  add("at_the_point/box_edge_upright", {veil, box({0, 0, -1}, {2, 2, 2})});
  add("at_the_point/box_face", {veil, box({-1, -1, 0}, {2, 2, 2})});
  add("at_the_point/box_top", {veil, box({-1, -1, -2}, {2, 2, 0})});
  add("at_the_point/box_side", {veil, box({0, -1, -1}, {2, 2, 2})});
  add("at_the_point/in_source_plane", {veil}, kCeiling, {{20, 0, 16}, {-1, 0, 0}});
  add("at_the_point/in_the_source", {veil}, kCeiling, {{0, 0, 16}, {0, 0, -1}});
  add("at_the_point/on_source_edge", {veil}, kCeiling, {{8, 0, 16}, {0, 0, -1}});
  add("at_the_point/on_source_vertex", {veil}, kCeiling, {{8, 8, 16}, {-1, -1, -1}});
  add("at_the_point/on_source_edge_line", {veil}, kCeiling, {{8, 12, 16}, {-1, -1, -1}});
  add("at_the_point/behind_source", {veil}, kCeiling, {{0, 0, 20}, {0, 0, -1}});
}

void Families::shapes() {
  const Points2 ell{{-4, -4}, {4, -4}, {4, 0}, {0, 0}, {0, 4}, {-4, 4}};
  const Points2 star{{4, 0}, {1, 1}, {0, 4}, {-1, 1}, {-4, 0}, {-1, -1}, {0, -4}, {1, -1}};
  const Points2 comb{{-4, -4}, {4, -4}, {4, 4},   {2, 4},   {2, -2}, {1, -2},
                     {1, 4},   {-1, 4}, {-1, -2}, {-2, -2}, {-2, 4}, {-4, 4}};
  const auto doubled = [](Points2 points) {
    for (auto& p : points) p = {2 * p[0], 2 * p[1]};
    return points;
  };
  const std::vector<std::pair<std::string, Points2>> outlines{{"ell", ell}, {"star", star}, {"comb", comb}};
  for (const auto& [name, outline] : outlines) {
    const Polygon source{reversed(at_height(kSourceHeight, doubled(outline))), {}};
    add("shape/source_" + name, {}, source);
    add("shape/source_" + name + "_occluded", {middle(-1, -2, 2, 1)}, source);
    add("shape/source_" + name + "_occluded_twice", {middle(-1, -2, 0, 4), middle(0, -1, 4, 1)}, source);
    add("shape/source_" + name + "_same_outline", {middle(outline)}, source);
    add("shape/occluder_" + name, {middle(outline)});
    add("shape/occluder_" + name + "_twice",
        {middle(outline), sheet(reversed(at_height(4, {{0, 0}, {2, 0}, {2, 2}, {0, 2}})))});
    add("shape/occluder_" + name + "_upright", {sheet([&] {
          Loop loop;
          for (const auto& [x, y] : outline) loop.push_back({x / 2 + 1, y / 4, 8 - x});
          return loop;
        }())});
    add("shape/" + name + "_straddling", {sheet([&] {
          Loop loop;
          for (const auto& [x, y] : outline) loop.push_back({x, y, 16 + x});
          return loop;
        }())});
  }
  const Polygon frame{rectangle(kMiddle, -3, -3, 3, 3), {rectangle(kMiddle, -1, -1, 1, 1)}};
  const Polygon sashes{rectangle(kMiddle, -3, -3, 3, 3),
                       {rectangle(kMiddle, -2, -2, -1, 2), reversed(rectangle(kMiddle, 1, -2, 2, 2))}};
  const Polygon ring{reversed(rectangle(kSourceHeight, -8, -8, 8, 8)), {rectangle(kSourceHeight, -2, -2, 2, 2)}};
  const auto occluder = [](const Polygon& p) { return Obstacle{{p}, false}; };
  add("hole/occluder", {occluder(frame)});
  add("hole/two_holes", {occluder(sashes)});
  add("hole/plugged", {occluder(frame), middle(-1, -1, 1, 1)});
  add("hole/half_plugged", {occluder(frame), middle(-1, -1, 0, 1)});
  add("hole/plugged_nearer", {occluder(frame), sheet(rectangle(4, -0.5, -0.5, 0.5, 0.5))});
  add("hole/both", {occluder(frame), occluder(sashes)});
  add("hole/source", {}, ring);
  add("hole/source_same_hole", {occluder(frame)}, ring);
  add("hole/source_plug", {middle(-1, -1, 1, 1)}, ring);
  add("hole/source_plug_half", {middle(-1, -1, 1, 0)}, ring);
  add("hole/source_occluded", {middle(-3, -2, 1, 1)}, ring);
  add("not_planar/source", {middle(-1, -2, 2, 1)}, {{{-8, 8, 16}, {8, 8, 17}, {8, -8, 16}, {-8, -8, 16}}, {}});
  add("not_planar/source_saddle", {middle(-1, -2, 2, 1)}, {{{-8, 8, 15}, {8, 8, 17}, {8, -8, 15}, {-8, -8, 17}}, {}});
  add("not_planar/occluder", {sheet({{-2, -2, 8}, {2, -2, 8}, {2, 2, 9}, {-2, 2, 8}})});
  add("not_planar/occluder_pair",
      {sheet({{-2, -2, 8}, {2, -2, 8}, {2, 2, 9}, {-2, 2, 8}}), sheet({{2, -2, 8}, {4, -2, 7}, {4, 2, 8}, {2, 2, 9}})});
  add("not_planar/occluder_folded_in_projection", {sheet({{-2, -2, 4}, {2, -2, 9}, {2, 2, 4}, {-2, 2, 9}})});
  add("not_planar/occluder_across_source_plane", {sheet({{-2, -2, 12}, {2, -2, 20}, {2, 2, 12}, {-2, 2, 20}})});
  add("not_planar/source_in_the_plane_of_the_point", {}, {{{-8, 8, 16}, {8, 8, 16}, {8, -8, 0}, {-8, -8, 0}}, {}},
      {{0, 16, 0}, {0, 0, 1}});
}

void Families::no_area() {
  const Obstacle veil = middle(-1, -2, 2, 1);
  add("no_area/segment", {veil, middle({{-3, -3}, {0, 0}, {3, 3}})});
  add("no_area/segment_back_and_forth", {veil, middle({{-3, -3}, {3, 3}, {0, 0}, {1, 1}})});
  add("no_area/point", {veil, middle({{1, 1}, {1, 1}, {1, 1}})});
  add("no_area/point_at_the_point", {veil, sheet({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}})});
  add("no_area/on_shared_edge", {middle(-2, -1, 0, 1), middle(0, -1, 2, 1), middle({{0, -2}, {0, 0}, {0, 2}})});
  add("no_area/upright", {veil, sheet({{0, 0, 4}, {0, 0, 8}, {0, 0, 12}})});
  add("no_area/source", {veil}, {at_height(kSourceHeight, {{-8, 0}, {0, 0}, {8, 0}}), {}});
  add("no_area/source_point", {veil}, {at_height(kSourceHeight, {{1, 1}, {1, 1}, {1, 1}}), {}});
}

void Families::solids() {
  add("solid/box", {box({-1, -2, 4}, {2, 1, 8})});
  add("solid/box_as_triangles", {as_triangles(box({-1, -2, 4}, {2, 1, 8}))});
  add("solid/box_edge_on_sides", {box({0, 0, 4}, {2, 2, 8})});
  add("solid/flat_box", {box({-2, -2, 8}, {2, 2, 8 + 0x1p-20})});
  add("solid/octahedron", {octahedron({0, 0, 8}, 2)});
  add("solid/octahedron_aside", {octahedron({2, 1, 8}, 2)});
  add("solid/tetrahedron", {tetrahedron({-2, -2, 6}, {3, -1, 7}, {0, 3, 8}, {0, 0, 12})});
  add("solid/tetrahedra_sharing_a_face", {tetrahedron({-2, -2, 6}, {3, -1, 7}, {0, 3, 8}, {0, 0, 12}),
                                          tetrahedron({-2, -2, 6}, {3, -1, 7}, {0, 3, 8}, {1, 0, 2})});
  add("solid/stack", {box({-2, -2, 4}, {2, 2, 6}), box({-2, -2, 6}, {2, 2, 8}), box({-1, -1, 8}, {3, 1, 9})});
  add("solid/row", {box({-3, -1, 4}, {-1, 1, 6}), box({-1, -1, 4}, {1, 1, 6}), box({1, -1, 4}, {3, 1, 6})});
  add("solid/row_with_t", {box({-2, -1, 4}, {0, 1, 6}), box({0, -2, 5}, {2, 0.5, 7})});
  add("solid/touching_at_an_edge", {box({-2, -2, 4}, {0, 0, 6}), box({0, 0, 4}, {2, 2, 6})});
  add("solid/touching_at_a_vertex", {box({-2, -2, 4}, {0, 0, 6}), box({0, 0, 6}, {2, 2, 8})});
  add("solid/box_and_sheet_on_it", {box({-2, -2, 4}, {2, 2, 6}), sheet(rectangle(4, -1, -1, 3, 1))});
  add("solid/box_and_sheet_along_it",
      {box({-2, -2, 4}, {2, 2, 6}), sheet({{2, -2, 4}, {2, 2, 4}, {2, 2, 8}, {2, -2, 8}})});
  add("solid/point_inside", {box({-1, -1, -1}, {1, 1, 1})});
  add("solid/point_inside_octahedron", {octahedron({0.25, 0.25, 0.25}, 2)});
  add("solid/point_inside_source_outside", {box({-1, -1, -1}, {1, 1, 20})});
  add("solid/around_everything", {box({-20, -20, -20}, {20, 20, 20})});
  add("solid/exactly_covering", {box({-2, -2, 4}, {2, 2, 5})});
}

void Families::outside() {
  const Obstacle veil = middle(-1, -2, 2, 1);
  add("outside/behind_the_point", {veil, sheet(rectangle(-4, -2, -2, 2, 2))});
  add("outside/behind_and_mirrored", {sheet(rectangle(-8, -4, -4, 4, 4))});
  add("outside/beyond_the_source", {veil, sheet(rectangle(20, -9, -9, 9, 9))});
  add("outside/box_beyond_the_source", {veil, box({-9, -9, 18}, {9, 9, 20})});
  add("outside/beside", {veil, middle(5, -2, 9, 2)});
  add("outside/through_the_horizon_plane", {sheet({{3, -2, -8}, {3, 2, -8}, {1, 2, 12}, {1, -2, 12}})});
  add("outside/behind_to_beyond", {sheet({{3, -2, -8}, {3, 2, -8}, {1, 2, 24}, {1, -2, 24}})});
  add("outside/plane_through_behind", {sheet({{-30, -3, -4}, {30, -3, -2}, {30, 3, -2}, {-30, 3, -4}})});
  add("outside/huge", {sheet({{-1e4, -1e4, 8}, {1e4, -1e4, 8}, {0, 1, 8}})});
  add("outside/none", {});
}

void Families::full_cover() {
  add("cover/larger", {middle(-5, -5, 5, 5)});
  add("cover/exact", {middle(-4, -4, 4, 4)});
  add("cover/exact_twice", {middle(-4, -4, 4, 4), sheet(rectangle(4, -2, -2, 2, 2))});
  add("cover/two_tiles", {middle(-4, -4, 0, 4), middle(0, -4, 4, 4)});
  add("cover/two_larger_tiles", {middle(-5, -5, 1, 5), middle(1, -5, 5, 5)});
  add("cover/two_heights", {middle(-4, -4, 0, 4), sheet(rectangle(4, 0, -2, 2, 2))});
  add("cover/three_tiles", {middle(-4, -4, 4, 0), middle(-4, 0, 1, 4), middle(1, 0, 4, 4)});
  add("cover/four_tiles", {middle(-4, -4, 0, 0), middle(0, -4, 4, 0), middle(-4, 0, 0, 4), middle(0, 0, 4, 4)});
  add("cover/four_triangles", {middle({{0, 0}, {-4, -4}, {4, -4}}), middle({{0, 0}, {4, -4}, {4, 4}}),
                               middle({{0, 0}, {4, 4}, {-4, 4}}), middle({{0, 0}, {-4, 4}, {-4, -4}})});
  add("cover/four_triangles_off_centre", {middle({{1, -1}, {-4, -4}, {4, -4}}), middle({{1, -1}, {4, -4}, {4, 4}}),
                                          middle({{1, -1}, {4, 4}, {-4, 4}}), middle({{1, -1}, {-4, 4}, {-4, -4}})});
  add("cover/pinwheel",
      {middle(-5, -5, 1, -1), middle(1, -5, 5, 1), middle(-1, 1, 5, 5), middle(-5, -1, -1, 5), middle(-1, -1, 1, 1)});
  add("cover/open_pinwheel", {middle(-5, -5, 1, -1), middle(1, -5, 5, 1), middle(-1, 1, 5, 5), middle(-5, -1, -1, 5)});
  add("cover/overlapping", {middle(-5, -5, 1, 5), middle(-1, -5, 5, 5)});
  add("cover/slopes", {sheet({{-4, -4, 8}, {0, -4, 8}, {0, 4, 8}, {-4, 4, 8}}),
                       sheet({{0, -4, 8}, {5, -5, 10}, {5, 5, 10}, {0, 4, 8}})});
  add("cover/all_but_a_corner", {middle({{-4, -4}, {4, -4}, {4, 3}, {3, 4}, {-4, 4}})});
}

void Families::small_distances() {
  for (const int k : {10, 20, 30, 40}) {
    const double e = std::ldexp(1, -k);
    const std::string by = "_2^-" + std::to_string(k);
    add("gap/between" + by, {middle(-3, -2, 0, 2), middle(e, -2, 3, 2)});
    add("gap/overlap" + by, {middle(-3, -2, e, 2), middle(0, -2, 3, 2)});
    add("gap/covering_but_a_gap" + by, {middle(-5, -5, 0, 5), middle(e, -5, 5, 5)});
    add("gap/two_crossing_gaps" + by,
        {middle(-5, -5, 0, 0), middle(e, -5, 5, 0), middle(-5, e, 0, 5), middle(e, e, 5, 5)});
    add("gap/slanted" + by, {middle({{-4, -4}, {4, -3}, {-4, 4}}), middle({{4, -3}, {4, 4}, {-4 + e, 4}})});
    add("gap/short_of_source_edge" + by, {middle(2, -2, 4 - e, 2)});
    add("gap/past_source_edge" + by, {middle(2, -2, 4 + e, 2), middle(-4 - e, -2, -2, 2)});
    add("near/above_source" + by, {sheet(rectangle(kSourceHeight - e, -2, -3, 3, 2))});
    add("near/behind_source" + by, {sheet(rectangle(kSourceHeight + e, -2, -3, 3, 2))});
    add("near/box_on_source" + by, {box({-2, -3, kSourceHeight - 2}, {3, 2, kSourceHeight - e})});
    add("near/tilted_to_source" + by, {sheet({{-2, -2, 16 - e}, {2, -2, 16 + e}, {2, 2, 16 + e}, {-2, 2, 16 - e}})});
    add("near/before_the_point" + by, {sheet(rectangle(e, -e / 8, -e / 4, e / 4, e / 8))});
    add("near/half_plane_before_the_point" + by, {sheet(rectangle(e, -4, -4, 0, 4))});
    add("near/behind_the_point" + by, {sheet(rectangle(-e, -4, -4, 4, 4))});
    add("near/edge_on" + by, {sheet({{0, -2, 4}, {e, -2, 8}, {e, 2, 8}, {0, 2, 4}})});
    add("near/on_edge" + by, {sheet({{e, -4, -4}, {e, 4, 4}, {4, 4, 4}})});
    add("near/point_close_to_source" + by, {sheet({{-2, -2, 16}, {2, -2, 12}, {2, 2, 12}, {-2, 2, 16}})}, kCeiling,
        {{1, 3, kSourceHeight - e}, {0, 0, 1}});
  }
  for (const int k : {10, 20, 30}) {
    const double e = std::ldexp(1, -k);
    const std::string by = "_2^-" + std::to_string(k);
    const Polygon dot{reversed(rectangle(kSourceHeight, -8 * e, -8 * e, 8 * e, 8 * e)), {}};
    const Polygon far_dot{reversed(rectangle(kSourceHeight, 8, 4, 8 + 8 * e, 4 + 8 * e)), {}};
    add("tiny/source" + by, {}, dot);
    add("tiny/half_covered" + by, {middle(0, -1, 2, 1)}, dot);
    add("tiny/quarter_covered" + by, {middle(0, 0, 2, 1)}, dot);
    add("tiny/slanting_cover" + by, {middle({{-3, -3}, {3, 3}, {3, -3}})}, dot);
    add("tiny/tiny_occluder" + by, {middle(-e, -2 * e, 2 * e, 3 * e)}, dot);
    add("tiny/covered_by_two" + by, {middle(0, -1, 2, 1), middle(-2, -1, 0, 1)}, dot);
    add("tiny/aside" + by, {middle(-1, -1, 4, 2 + 2 * e)}, far_dot);
    add("tiny/only_occluder" + by, {middle(-e, -2 * e, 2 * e, 3 * e)});
  }
}

/// Triangles and rectangles with corners on a coarse lattice: everything happens at once.
void Families::lattice_soups() {
  for (int i = 0; i < 60; ++i) {
    const std::string name = "soup/" + std::to_string(i);
    Random random(name);
    std::vector<Obstacle> occluders;
    const auto corner = [&](int low, int high) {
      const int z = random.whole(low, high);  // doubled towards the point's distance, so that cones coincide often
      const double scale = i % 2 == 0 ? 1 : z / 8.0;
      return Vec3{scale * random.whole(-3, 3), scale * random.whole(-3, 3), static_cast<double>(z)};
    };
    const int count = random.whole(2, 9);
    for (int k = 0; k < count; ++k) {
      const int kind = random.whole(0, 3);
      const Vec3 a = corner(2, 12), b = corner(2, i % 3 == 0 ? 20 : 14), c = corner(i % 5 == 0 ? -6 : 2, 14);
      if (kind == 0) occluders.push_back(sheet({a, b, b + c - a, c}));
      if (kind == 1) occluders.push_back(sheet({a, b, c}));
      if (kind == 2) {
        const double z = random.whole(1, 3) * 4;
        occluders.push_back(sheet(rectangle(z, a.x, a.y, a.x + random.whole(1, 4), a.y + random.whole(1, 4))));
      }
      if (kind == 3) {
        occluders.push_back(
            box(a, a + Vec3{1.0 * random.whole(1, 3), 1.0 * random.whole(1, 3), 1.0 * random.whole(1, 3)}));
      }
    }
    add(name, occluders);
  }
}

bool is_usable(const Polygon& polygon) {
  const PolygonDefect defect = find_defect(polygon);
  return defect == PolygonDefect::none || defect == PolygonDefect::zero_area;
}

}  // namespace

std::vector<PointCase> degenerate_cases() {
  Families families;
  families.shared_edges();
  families.source_boundary();
  families.repeated();
  families.crossing();
  families.slivers();
  families.source_plane();
  families.coplanar();
  families.horizon();
  families.through_the_point();
  families.shapes();
  families.no_area();
  families.solids();
  families.outside();
  families.full_cover();
  families.small_distances();
  families.lattice_soups();

  std::vector<PointCase> cases;
  for (const PointCase& staged : families.take()) {
    for (const Placement& place : placements(staged.name)) {
      PointCase placed{
          staged.name + "/" + place.name, place(staged.point), place.normal(staged.normal), place(staged.source), {}};
      bool usable = is_usable(placed.source);
      for (const Obstacle& occluder : staged.occluders) {
        placed.occluders.push_back({{}, occluder.solid});
        for (const Polygon& face : occluder.faces) {
          placed.occluders.back().faces.push_back(place(face));
          usable = usable && is_usable(placed.occluders.back().faces.back());
        }
      }
      if (usable) cases.push_back(std::move(placed));
    }
  }
  return cases;
}

}  // namespace exitance
