#include "src/scene/scene_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "src/scene/furnished_room.h"
#include "src/scene/reader.h"
#include "tests/scene/scene_files.h"

namespace exitance {
namespace {

class SceneCheck : public SceneFiles {
 protected:
  static constexpr std::string_view kMaterials =
      "[[material]]\nname = \"white\"\nrho = 0.5\n[[material]]\nname = \"lamp\"\nrho = 0\nE = 1\n";
  static constexpr std::string_view kRoom =
      "[[object]]\nname = \"room\"\nbox = {min = [0,0,0], max = [3,3,3]}\nflip = true\nmaterial = \"lamp\"\n";

  // A closed, lit room and what is added to it.
  Scene furnished(const std::string& objects) const {
    return read_scene(write("s.toml", std::string(kMaterials) + std::string(kRoom) + objects), {.keep_faults = true});
  }
  static std::string object(const std::string& shape) {
    return "[[object]]\nname = \"thing\"\nmaterial = \"white\"\n" + shape + "\n";
  }
};

const Finding* find(const SceneReport& report, FindingKind kind) {
  const auto found = std::ranges::find(report.findings, kind, &Finding::kind);
  return found == report.findings.end() ? nullptr : &*found;
}

std::vector<FindingKind> kinds(const SceneReport& report) {
  std::vector<FindingKind> all;
  for (const Finding& f : report.findings) all.push_back(f.kind);
  return all;
}

TEST_F(SceneCheck, NothingToFindInALitRoom) {
  const SceneReport report = check_scene(furnished(""));
  EXPECT_TRUE(report.closed);
  EXPECT_TRUE(report.watertight);
  EXPECT_EQ(report.pieces, 1u);
  EXPECT_THAT(kinds(report), testing::ElementsAre());
}

/// One with a hole and one without have one outline and are no duplicates; what lies in the hole lies on the latter.
TEST_F(SceneCheck, OverlapsOfFacesWithHoles) {
  Scene scene = furnished("");
  const auto square = [](double from, double to) {
    return std::vector<Vec3>{{from, from, 1}, {to, from, 1}, {to, to, 1}, {from, to, 1}};
  };
  std::vector<Vec3> hole = square(1, 2);
  std::ranges::reverse(hole);
  const auto add = [&](const Polygon& polygon) {
    scene.surfaces.push_back(scene.surfaces.front());
    scene.surfaces.back().polygon = polygon;
  };
  const Polygon frame{square(0.5, 2.5), {hole}};
  add(frame);
  add({square(0.5, 2.5), {}});
  add({square(1.25, 1.75), {}});
  const SceneReport report = check_scene(scene);
  EXPECT_FALSE(find(report, FindingKind::duplicate_face));
  const Finding* overlaps = find(report, FindingKind::overlap_same_facing);
  ASSERT_TRUE(overlaps);
  EXPECT_EQ(overlaps->count, 2u);
  EXPECT_DOUBLE_EQ(overlaps->amount, 3 + 0.25);

  add(frame);
  const SceneReport twice = check_scene(scene);
  ASSERT_TRUE(find(twice, FindingKind::duplicate_face));
  EXPECT_EQ(find(twice, FindingKind::duplicate_face)->count, 1u);
  EXPECT_EQ(find(twice, FindingKind::overlap_same_facing)->count, 2u);
}

TEST_F(SceneCheck, TheCornellPattern) {
  // Five walls, open in front, and a block without a bottom; then the front wall.
  std::string open =
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
      "f 1 2 3 4\nf 8 7 6 5\nf 4 3 7 8\nf 1 4 8 5\nf 2 6 7 3\n"
      "v .3 .3 0\nv .6 .3 0\nv .6 .6 0\nv .3 .6 0\nv .3 .3 .5\nv .6 .3 .5\nv .6 .6 .5\nv .3 .6 .5\n"
      "f 13 14 15 16\nf 9 10 14 13\nf 10 11 15 14\nf 11 12 16 15\nf 12 9 13 16\n";
  const Scene published = read_scene(write("open.obj", open));
  EXPECT_FALSE(is_closed(published));
  const SceneReport report = check_scene(published);
  EXPECT_FALSE(report.closed);
  EXPECT_FALSE(report.watertight);
  ASSERT_TRUE(find(report, FindingKind::open_edge));
  EXPECT_EQ(find(report, FindingKind::open_edge)->count, 4u);
  EXPECT_EQ(find(report, FindingKind::open_edge)->amount, 4);
  ASSERT_TRUE(find(report, FindingKind::contact_edge));
  EXPECT_DOUBLE_EQ(find(report, FindingKind::contact_edge)->amount, 1.2);
  EXPECT_FALSE(find(report, FindingKind::single_sheet));

  EXPECT_TRUE(is_closed(read_scene(write("closed.obj", open + "f 1 5 6 2\n"))));
  EXPECT_FALSE(is_closed(read_scene(write("wrong.obj", open + "f 2 6 5 1\n"))));
}

TEST_F(SceneCheck, FurnishedRoomsAreClosed) {
  for (const std::uint32_t polygons : {200u, 500u, 1500u}) {
    const Scene scene = make_furnished_room(polygons, 7);
    EXPECT_TRUE(is_closed(scene));
    Scene open = scene;
    // The largest surface is the room's.
    const auto area = [](const Surface& s) { return norm(area_vector(s.polygon)); };
    open.surfaces.erase(std::ranges::max_element(open.surfaces, {}, area));
    EXPECT_FALSE(is_closed(open));
  }
}

TEST_F(SceneCheck, ClosedIsWhatItsPatchesFace) {
  EXPECT_TRUE(is_closed(furnished(object("polygons = [[[1,1,1],[2,1,1],[1,2,1]]]"))));
  EXPECT_TRUE(is_closed(furnished(object("box = {min = [0,0,0], max = [1,1,1]}"))));
  EXPECT_FALSE(is_closed(furnished(object("box = {min = [5,0,0], max = [6,1,1]}"))));
  EXPECT_TRUE(is_closed(furnished(object("box = {min = [5,0,0], max = [6,1,1]}\nobstruction_only = true"))));
  EXPECT_TRUE(is_closed(furnished(object("box = {min = [5,0,0], max = [6,1,1]}\nflip = true"))));
}

TEST_F(SceneCheck, Contacts) {
  const SceneReport report = check_scene(furnished(object("box = {min = [1,1,0], max = [2,2,1]}") +
                                                   object("polygons = [[[0,0,0],[1,0,0],[1,0.5,0],[0,0.5,0]]]")));
  ASSERT_TRUE(find(report, FindingKind::overlap_against));
  EXPECT_EQ(find(report, FindingKind::overlap_against)->amount, 1);
  ASSERT_TRUE(find(report, FindingKind::overlap_same_facing));
  EXPECT_EQ(find(report, FindingKind::overlap_same_facing)->amount, 0.5);
  EXPECT_EQ(find(report, FindingKind::overlap_same_facing)->places.at(0).surface, 12u);
  EXPECT_TRUE(report.closed);
  EXPECT_FALSE(find(report, FindingKind::single_sheet));
}

/// A turned scene is told the same of: contacts, T-junctions and what closes it hold there but for rounding.
TEST_F(SceneCheck, TurnedScenes) {
  const Scene scene = furnished(
      object("box = {min = [1,1,0], max = [2,2,1]}") + object("polygons = [[[0,0,0],[1,0,0],[1,0.5,0],[0,0.5,0]]]") +
      object("polygons = [[[2,0,0],[2,0,1],[2,1,1],[2,1,0]], [[2,1,0],[2,1,1],[3,1,1],[3,1,0]],\n"
             "[[2,0,1],[3,0,1],[3,0.5,1],[2,0.5,1]], [[2,0.5,1],[3,0.5,1],[3,1,1],[2,1,1]]]") +
      object("polygons = [[[0,3,1],[0,3,2],[1,3,2],[1,3,1]], [[0,3,1],[1,3,1],[1,3,2],[0,3,2]]]"));
  const SceneReport straight = check_scene(scene);
  EXPECT_TRUE(straight.closed);
  EXPECT_TRUE(straight.watertight);
  for (const double angle : {0.3, 1.1, 2.3}) {
    Scene turned = scene;
    const double c = std::cos(angle), s = std::sin(angle);
    for (Surface& surface : turned.surfaces) {
      for (Vec3& p : surface.polygon.outer) {
        const Vec3 q{c * p.x - s * p.y, s * p.x + c * p.y, p.z};
        p = {q.x, c * q.y - s * q.z, s * q.y + c * q.z};
      }
    }
    const SceneReport report = check_scene(turned);
    EXPECT_EQ(report.closed, straight.closed) << angle;
    EXPECT_EQ(report.watertight, straight.watertight) << angle;
    EXPECT_EQ(report.pieces, straight.pieces) << angle;
    EXPECT_EQ(kinds(report), kinds(straight)) << angle;
    for (const FindingKind kind :
         {FindingKind::overlap_same_facing, FindingKind::overlap_against, FindingKind::contact_edge}) {
      ASSERT_TRUE(find(report, kind)) << angle;
      EXPECT_EQ(find(report, kind)->count, find(straight, kind)->count) << angle;
      EXPECT_NEAR(find(report, kind)->amount, find(straight, kind)->amount, 1e-12) << angle;
    }
  }
}

TEST_F(SceneCheck, BadFaces) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Scene scene =
      furnished(object("polygons = [[[1,1,1],[2,1,1],[2,2,1.25],[1,2,1]], [[1,1,2],[2,1,2],[3,1,2]],\n"
                       "[[1,1,2],[2,2,2],[2,1,2],[1,2,2]],\n"
                       "[[1,1,2.5],[2,1,2.5],[2,2,2.5]], [[2,2,2.5],[1,1,2.5],[2,1,2.5]]]"));
  scene.surfaces.push_back(scene.surfaces.back());
  scene.surfaces.back().polygon.outer = {{nan, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const SceneReport report = check_scene(scene);
  for (const auto kind : {FindingKind::non_finite, FindingKind::zero_area, FindingKind::self_intersecting,
                          FindingKind::non_planar, FindingKind::duplicate_face}) {
    ASSERT_TRUE(find(report, kind)) << name_of(kind);
    EXPECT_EQ(find(report, kind)->count, 1u) << name_of(kind);
  }
  EXPECT_EQ(find(report, FindingKind::zero_area)->places.at(0).object, "thing");
  EXPECT_EQ(find(report, FindingKind::self_intersecting)->places.at(0).line, 17u);
  EXPECT_EQ(find(report, FindingKind::duplicate_face)->amount, 0.5);
  // The corner lies 0.25 above the other three's plane; the middle plane halves that, tilted.
  EXPECT_NEAR(find(report, FindingKind::non_planar)->amount, 0.0625, 0.01);
}

TEST_F(SceneCheck, RoundingIsNoBend) {
  const Scene turned =
      furnished(object("box = {min = [1.1,1.2,1.3], max = [1.7,1.8,1.9]}\nrotate = {axis = [1,2,3], degrees = 10}"));
  EXPECT_FALSE(find(check_scene(turned), FindingKind::non_planar));
}

TEST_F(SceneCheck, Materials) {
  const Scene bright = read_scene(write("b.toml",
                                        "[[material]]\nname = \"bright\"\nrho = 1\n[[object]]\nmaterial = \"bright\"\n"
                                        "box = {min = [0,0,0], max = [1,1,1]}\nflip = true\n"),
                                  {.keep_faults = true});
  const SceneReport report = check_scene(bright);
  ASSERT_TRUE(find(report, FindingKind::reflectance));
  EXPECT_EQ(find(report, FindingKind::reflectance)->places.at(0).object, "bright");
  EXPECT_EQ(find(report, FindingKind::reflectance)->severity, Severity::error);
  EXPECT_TRUE(find(report, FindingKind::no_emitter));
}

TEST_F(SceneCheck, ShellsThatLookInsideOut) {
  const auto inside_out = [](const Scene& scene) {
    return find(check_scene(scene), FindingKind::inside_out) != nullptr;
  };
  const std::string cube = "box = {min = [1,1,1], max = [2,2,2]}\n";
  EXPECT_FALSE(inside_out(furnished(object(cube))));
  EXPECT_TRUE(inside_out(furnished(object(cube + "flip = true\n"))));
  // A room whose walls look out: with furniture, and lit but empty.
  const auto read = [&](const std::string& objects) {
    return read_scene(write("o.toml", std::string(kMaterials) + objects));
  };
  const std::string outward = "[[object]]\nmaterial = \"lamp\"\nbox = {min = [0,0,0], max = [3,3,3]}\n";
  EXPECT_TRUE(inside_out(read(outward + object(cube))));
  EXPECT_TRUE(inside_out(read(outward)));
  EXPECT_FALSE(inside_out(read(object(cube))));
}

TEST_F(SceneCheck, SingleSheetsAndBadEdges) {
  const SceneReport sheet = check_scene(furnished(object("polygons = [[[1,1,1],[2,1,1],[2,2,1],[1,2,1]]]")));
  ASSERT_TRUE(find(sheet, FindingKind::single_sheet));
  EXPECT_EQ(find(sheet, FindingKind::single_sheet)->amount, 1);
  const SceneReport two_sided =
      check_scene(furnished(object("polygons = [[[1,1,1],[2,1,1],[2,2,1],[1,2,1]]]\ntwo_sided = true")));
  EXPECT_FALSE(find(two_sided, FindingKind::single_sheet));
  EXPECT_TRUE(two_sided.watertight);

  // Neighbours that run along their common edge in the same direction; three faces on one edge.
  const SceneReport twisted =
      check_scene(furnished(object("polygons = [[[1,1,1],[2,1,1],[2,2,1]], [[1,1,1],[2,1,1],[2,1,2]]]")));
  ASSERT_TRUE(find(twisted, FindingKind::non_manifold_edge));
  EXPECT_EQ(find(twisted, FindingKind::non_manifold_edge)->severity, Severity::warning);
  EXPECT_EQ(find(twisted, FindingKind::non_manifold_edge)->count, 1u);
}

}  // namespace
}  // namespace exitance
