// What lies on a surface covers it: neither counts what is covered, as a part of what sends or of what receives.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include "src/links/hierarchical_solution.h"
#include "src/scene/scene_file.h"
#include "tests/links/linked_rooms.h"
#include "tests/output/scratch_folder.h"

namespace exitance {
namespace {

/// About a vertical axis.
std::vector<Surface> turned(std::vector<Surface> surfaces, double degrees, const Vec3& about) {
  const double c = std::cos(degrees * std::numbers::pi / 180), s = std::sin(degrees * std::numbers::pi / 180);
  for (Surface& surface : surfaces) {
    for (Vec3& v : surface.polygon.outer) {
      const Vec3 w = v - about;
      v = about + Vec3{c * w.x - s * w.y, s * w.x + c * w.y, w.z};
    }
  }
  return surfaces;
}

Surface square(double low, double high, double z, bool up, std::uint32_t material = 2) {
  Surface s;
  s.polygon.outer = {{low, low, z}, {high, low, z}, {high, high, z}, {low, high, z}};
  if (!up) std::reverse(s.polygon.outer.begin(), s.polygon.outer.end());
  s.material = material;
  return s;
}

/// Area of an object's surface (all of them: kNone) that is open.
double open_area_of(const LinkedRadiosity& links, std::uint32_t object, std::uint32_t surface = kNone) {
  double sum = 0;
  for (const Root& root : links.tree().roots()) {
    if (root.present && root.object == object && (surface == kNone || root.surface == surface))
      sum += links.tree().node(root.node_first).open_area;
  }
  return sum;
}

constexpr std::uint32_t kFloor = 0, kBottom = 0, kTop = 1;  // of box_faces

/// Named rooms in which the last object lies on something.
struct Case {
  std::string name;
  Scene scene;
  double floor = 9;           ///< [m²] of it that is open
  double last = 0;            ///< of the last object
  Vec3 away{0.3, 0.25, 0.4};  ///< a move after which nothing of it is covered
};

std::vector<Case> cases() {
  std::vector<Case> all;
  const auto box = [](double side, double z) {
    return box_faces({1.1, 1.2, z}, {1.1 + side, 1.2 + side, z + 0.5}, 2, 0);
  };
  const auto room_with = [](const std::vector<std::vector<Surface>>& things) {
    Scene scene = empty_room();
    for (const auto& thing : things) add(scene, "thing", thing);
    return scene;
  };
  all.push_back({"box on the floor", room_with({box(0.7, 0)}), 9 - 0.49, 0.49 + 1.4});
  all.push_back({"turned box", room_with({turned(box(0.7, 0), 27, {1.5, 1.5, 0})}), 9 - 0.49, 0.49 + 1.4});
  all.push_back({"ends on a node's edge", room_with({box_faces({0.75, 0.75, 0}, {1.5, 1.5, 0.5}, 2, 0)}), 9 - 0.5625,
                 0.5625 + 1.5});
  all.push_back({"leaves a strip of a node that none of its points lies on",
                 room_with({box_faces({0.825, 0.75, 0}, {1.5, 1.5, 0.5}, 2, 0)}), 9 - 0.50625, 0.50625 + 1.425});
  all.push_back({"smaller box on a larger one",
                 room_with({box(0.8, 0), turned(box_faces({1.3, 1.4, 0.5}, {1.7, 1.8, 1}, 2, 0), 20, {1.5, 1.6, 0})}),
                 9 - 0.64, 0.16 + 0.8});
  all.push_back(
      {"larger box on a smaller one", room_with({box(0.4, 0), box(0.8, 0.5)}), 9 - 0.16, 2 * 0.64 - 0.16 + 1.6});
  all.push_back({"box at the wall", room_with({box_faces({0, 1, 1}, {0.5, 1.5, 1.5}, 2, 0)}), 9, 1.25});
  all.push_back({"box through the wall", room_with({box_faces({-0.2, 1, 1}, {0.5, 1.5, 1.5}, 2, 0)}), 9, 0.5 + 1.4});
  all.push_back({"sheet that looks up", room_with({{square(1, 1.8, 0, true)}}), 9 - 0.64, 0.64});
  all.push_back({"sheet that looks down", room_with({{square(1, 1.8, 0, false)}}), 9, 0});
  all.push_back({"two sheets that overlap", room_with({{square(1, 1.8, 0, true)}, {square(1.4, 2.2, 0, true)}}),
                 9 - 1.28 + 0.16, 0.64});
  return all;
}

TEST(CoveredArea, IsExactWhereThingsLieOnOthers) {
  for (Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const auto last = static_cast<std::uint32_t>(c.scene.objects.size() - 1);
    LinkedRadiosity links(c.scene, coarse());
    EXPECT_NEAR(open_area_of(links, 0, kFloor), c.floor, 1e-12);
    EXPECT_NEAR(open_area_of(links, last), c.last, 1e-12);
    for (const Node& node : links.tree().nodes()) {
      EXPECT_EQ(node.covered, node.open_area < node.area);
      std::vector<NodePoint> points;
      const auto n = static_cast<std::uint32_t>(&node - links.tree().nodes().data());
      links.tree().open_points(n, 2, points);
      EXPECT_EQ(points.empty(), node.open_area < 1e-3 * node.area);
      double sum = 0;
      for (const NodePoint& p : points) sum += p.weight;
      EXPECT_NEAR(sum, points.empty() ? 0 : 1, 1e-12);
    }
  }
  Case stack = cases()[4];
  LinkedRadiosity links(stack.scene, coarse());
  EXPECT_NEAR(open_area_of(links, 1, kTop), 0.64 - 0.16, 1e-12);
  EXPECT_EQ(open_area_of(links, 1, kBottom), 0);
  EXPECT_EQ(open_area_of(links, 2, kBottom), 0);
}

// Which of two sheets lies before the other is then a matter of rounding, here this one and there that; the later one
// covers the other all the same. What is seen of either has B = 2 in this furnace.
TEST(CoveredArea, OfSheetsInOnePlaneButForRounding) {
  for (const double degrees : {0.0, 33.0}) {
    SCOPED_TRACE(degrees);
    Scene scene = empty_room();
    for (Material& material : scene.materials) material = grey(0.5, 1);
    add(scene, "sheet", {square(0.5, 2, 0, true)});
    add(scene, "sheet on both", {square(1.25, 2.75, 0, true)});
    const Placement turn{rotation({1, 2, 3}, degrees), {}};
    place(scene, turn);
    LinkOptions options = coarse();
    options.eps2 = 0.2;
    options.eps1 = 0.1;
    options.smallest_area = 0.15;
    LinkedRadiosity links(scene, options), hvt(scene, options);
    for (LinkedRadiosity* each : {&links, &hvt}) each->build();
    double seen = 0, off = 0;
    for (std::uint32_t r = 0; r < links.tree().roots().size(); ++r) {
      for (const Link& link : links.links().of_receiver(r)) {
        const Root& source = links.tree().root(links.tree().node(link.source).root);
        if (link.ghost || (source.object == 0 && source.surface != kFloor)) continue;
        const double weight = links.tree().node(link.destination).open_area * link.transfer();
        seen += weight;
        off += weight * std::fabs(links.radiosity().B()[link.source] - 2);
      }
    }
    EXPECT_NEAR(seen, 9, 0.4);
    EXPECT_LT(off, 0.1 * seen);
    const std::vector<Edit> edits{move_to(2, turn({-0.5, -0.75, 0}))};
    links.update(edits, LinkMethod::direct);
    hvt.update(edits, LinkMethod::hvt);
    EXPECT_TRUE(same_bits(links.links(), hvt.links()));
    EXPECT_TRUE(same_bits(links.radiosity().B(), hvt.radiosity().B()));
  }
}

// A sheet comes to lie over all of another, which can still be seen past it by rounding: its light has to go.
TEST(CoveredArea, IsTakenBackWhereRoundingLetsItBeSeen) {
  constexpr const char* kScene = R"(
[[material]]
name = "grey"
rho = 0.5
E = 1
[[object]]
name = "moving"
material = "grey"
polygons = [[[0, 0, 0], [0, 0.25, 0], [0, 0.25, 0.75], [0, 0, 0.75]]]
two_sided = true
rotate = {axis = [0.3, -1, 0.2], degrees = 77}
translate = [-1.3413494504540178, 1.1649691371645226, 1.2118698615036398]
[[object]]
name = "covered"
material = "grey"
polygons = [[[0.75, 1.5, 1.5], [0.75, 1.75, 1.5], [0.75, 1.75, 1.75], [0.75, 1.5, 1.75]]]
two_sided = true
rotate = {axis = [0.3, -1, 0.2], degrees = 77}
translate = [-0.025601660279609764, 0.22209798023284893, 0.27389239158365913]
[[object]]
name = "room"
material = "grey"
box = {min = [0, 0, 0], max = [2, 2, 2]}
flip = true
rotate = {axis = [0.3, -1, 0.2], degrees = 77}
)";
  const ScratchFolder scratch;
  std::ofstream(scratch / "scene.toml") << kScene;
  LinkOptions options;
  options.eps2 = 0.2;
  options.eps1 = 0.1;
  options.smallest_area = 0.2;
  options.B_eps = 0;
  LinkedRadiosity links(read_dynamic_scene(scratch / "scene.toml", Emission::exitance).scene, options);
  links.build();
  const Vec3 by{0.07167015409681847, -0.005610789029253403, 0.23944082370850528};
  links.update(std::vector<Edit>{move_to(0, by)}, LinkMethod::hvt_peu);
  EXPECT_LT(error_of(links), 1e-5);
}

// Contact is only up to rounding then, and no quadrilateral is planar.
TEST(CoveredArea, IsFoundInARoomThatIsTurned) {
  Scene scene = empty_room();
  add(scene, "box", box_faces({1.1, 1.2, 0}, {1.8, 1.9, 0.5}, 2, 0));
  for (Surface& surface : scene.surfaces) {
    for (Vec3& v : surface.polygon.outer) {
      const Vec3 w{0.8 * v.x - 0.6 * v.z, v.y, 0.6 * v.x + 0.8 * v.z};
      v = Vec3{w.x, w.y * std::cos(0.7) - w.z * std::sin(0.7), w.y * std::sin(0.7) + w.z * std::cos(0.7)};
    }
  }
  LinkedRadiosity links(scene, coarse());
  EXPECT_NEAR(open_area_of(links, 0, kFloor), 9 - 0.49, 1e-9);
  EXPECT_NEAR(open_area_of(links, 1, kBottom), 0, 1e-9);
}

// All links join the smallest sub-patches, so that from each of their points all that is seen sums to 1: B = E / (1 −
// ρ) wherever anything is open, and E where nothing is. What is open absorbs what it emits.
TEST(CoveredArea, IsLeftOutInAFurnace) {
  for (Case& c : cases()) {
    if (c.name == "box through the wall") continue;  // the inside of the box is no part of the room, nor is it covered
    SCOPED_TRACE(c.name);
    for (Surface& s : c.scene.surfaces) s.material = 1;
    LinkOptions options;
    options.eps2 = options.eps1 = 0;
    options.smallest_area = 0.3;
    options.tolerance = 1e-11;
    LinkedRadiosity links(c.scene, options);
    links.build();
    for (const std::uint32_t n : links.elements()) {
      const Node& node = links.tree().node(n);
      EXPECT_NEAR(links.radiosity().B()[n], node.open_area > 0 ? 2 : 1, 1e-9);
      EXPECT_NEAR(links.radiosity().whole_B(n, 0), 1 + node.open_area / node.area, 1e-9);
    }
    for (const Root& root : links.tree().roots()) {
      const double B = links.radiosity().B()[root.node_first];
      EXPECT_NEAR(B, links.tree().node(root.node_first).open_area > 0 ? 2 : 1, 1e-9);
    }
    HierarchicalOptions solving;
    solving.links = options;
    const std::vector<std::uint8_t> moves(c.scene.objects.size());
    EXPECT_LT(solve_by_links(c.scene, solving, moves).solution.energy_balance_defect.value(), 1e-9);
  }
}

TEST(CoveredArea, FollowsEdits) {
  for (Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const auto last = static_cast<std::uint32_t>(c.scene.objects.size() - 1);
    LinkOptions options = coarse();
    options.eps2 = 0.1;
    options.eps1 = 0.06;
    options.smallest_area = 0.04;
    LinkedRadiosity direct(c.scene, options), hvt(c.scene, options), shot(c.scene, options), stays(c.scene, options);
    for (LinkedRadiosity* links : {&direct, &hvt, &shot, &stays}) links->build();
    for (const Vec3& to : {c.away, Vec3{0.05, -0.1, 0}, Vec3{}}) {
      const std::vector<Edit> edits{move_to(last, to)};
      direct.update(edits, LinkMethod::direct);
      hvt.update(edits, LinkMethod::hvt);
      shot.update(edits, LinkMethod::hvt_peu);
      ASSERT_TRUE(same_bits(direct.links(), hvt.links()));
      ASSERT_TRUE(same_bits(direct.radiosity().B(), hvt.radiosity().B()));
      EXPECT_LT(error_of(shot), 1e-3);
      for (std::size_t n = 0; n < direct.tree().nodes().size(); ++n)
        ASSERT_EQ(direct.tree().nodes()[n].open_area, shot.tree().nodes()[n].open_area);
    }
    for (std::size_t n = 0; n < direct.tree().nodes().size(); ++n)
      EXPECT_EQ(direct.tree().nodes()[n].open_area, stays.tree().nodes()[n].open_area);
    const std::vector<Edit> nothing{move_to(last, {})};
    direct.update(nothing, LinkMethod::rebuild);
    EXPECT_TRUE(same_bits(direct.links(), stays.links()));
    EXPECT_TRUE(same_bits(direct.radiosity().B(), stays.radiosity().B()));
  }
}

// The lid that lies on the floor covers it also as seen from the sides of its solid, which do not move.
TEST(CoveredArea, OfALidThatLeavesItsSolid) {
  Scene scene = empty_room();
  const std::vector<Surface> faces = box_faces({1.1, 1.2, 0}, {1.8, 1.9, 0.5}, 2, 0);
  add(scene, "sides", {faces.begin() + 1, faces.end()});
  add(scene, "lid", {faces.begin(), faces.begin() + 1});
  LinkedRadiosity direct(scene, coarse()), hvt(scene, coarse());
  for (LinkedRadiosity* links : {&direct, &hvt}) links->build();
  EXPECT_NEAR(open_area_of(direct, 0, kFloor), 9 - 0.49, 1e-12);
  for (const Operation operation : {Operation::remove, Operation::add}) {
    const std::vector<Edit> edits{{operation, 2, {}, {}, {}}};
    direct.update(edits, LinkMethod::direct);
    hvt.update(edits, LinkMethod::hvt);
    EXPECT_NEAR(open_area_of(hvt, 0, kFloor), operation == Operation::add ? 9 - 0.49 : 9, 1e-12);
    EXPECT_TRUE(same_bits(direct.links(), hvt.links())) << name_of(operation);
    EXPECT_TRUE(same_bits(direct.radiosity().B(), hvt.radiosity().B())) << name_of(operation);
  }
}

// Without a threshold all differences are shot, those of means that only weigh their parts anew, too.
TEST(CoveredArea, IsFollowedByProgressiveEnergyUpdate) {
  for (Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const auto last = static_cast<std::uint32_t>(c.scene.objects.size() - 1);
    LinkOptions options = coarse();
    options.B_eps = 0;
    options.smallest_area = 0.04;
    LinkedRadiosity links(c.scene, options);
    links.build();
    for (const Vec3& to : {c.away, Vec3{0.05, -0.1, 0}, Vec3{}}) {
      links.update(std::vector<Edit>{move_to(last, to)}, LinkMethod::hvt_peu);
      EXPECT_LT(error_of(links), 1e-7);
    }
  }
}

// What the sheet leaves open faces a bright wall from afar before it slides away, and from beside it then: neither the
// form factor from before, nor those of quarters, says what the open part receives now.
TEST(CoveredArea, CountsForProgressiveEnergyUpdateWhereOthersAreOpenThanBefore) {
  const auto strip = [](double low, double high, std::uint32_t material) {
    Surface s;
    s.polygon.outer = {{low, 0, 0}, {high, 0, 0}, {high, 1, 0}, {low, 1, 0}};
    s.material = material;
    return s;
  };
  Surface wall;
  wall.polygon.outer = {{4, 0, 0}, {4, 0, 1}, {4, 1, 1}, {4, 1, 0}};
  wall.material = 1;
  struct Slide {
    double low, high, smallest_area;  // of the sheet; the floor's quarters have 1 m²
  };
  for (const Slide& c : {Slide{2, 4, 10}, Slide{2.2, 4, 0.9}}) {
    SCOPED_TRACE(c.low);
    Scene scene = empty_room();
    scene.surfaces = {strip(0, 4, 2), wall};
    add(scene, "sheet", {strip(c.low, c.high, 2)});
    LinkOptions options = coarse();
    options.eps2 = options.eps1 = 1e-6;
    options.B_eps = 0.08;
    options.smallest_area = c.smallest_area;
    options.mesh.patch_size = 10;
    LinkedRadiosity direct(scene, options), shot(scene, options);
    for (LinkedRadiosity* links : {&direct, &shot}) links->build();
    const std::vector<Edit> edits{move_to(1, {-c.low, 0, 0})};
    direct.update(edits, LinkMethod::direct);
    shot.update(edits, LinkMethod::hvt_peu);
    std::size_t significant = 0;
    ASSERT_EQ(direct.links().of_receiver(0).size(), shot.links().of_receiver(0).size());
    for (std::size_t k = 0; k < direct.links().of_receiver(0).size(); ++k) {
      const Link &now = direct.links().of_receiver(0)[k], &link = shot.links().of_receiver(0)[k];
      if (now.ghost || now.energy <= options.B_eps) continue;
      ++significant;
      EXPECT_EQ(link.form_factor, now.form_factor);
      EXPECT_EQ(link.visibility, now.visibility);
    }
    EXPECT_GT(significant, 0);
  }
}

}  // namespace
}  // namespace exitance
