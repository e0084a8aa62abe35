#include "src/links/linked_radiosity.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <atomic>
#include <cmath>
#include <cstring>
#include <memory>
#include <numbers>

#include "src/scene/input_error.h"
#include "src/solve/scene_solution.h"
#include "tests/links/linked_rooms.h"

namespace exitance {
namespace {

double worst_of(const LinkedRadiosity& links, double B) {
  double worst = 0;
  for (const std::uint32_t n : links.elements()) worst = std::max(worst, std::fabs(links.radiosity().B()[n] - B));
  return worst;
}

TEST(LinkedRadiosity, FurnaceComesNearTheTruthAsThresholdsFall) {
  Scene scene = empty_room();
  for (Surface& s : scene.surfaces) s.material = 1;
  double before = 0.2;  // of B = 2
  for (const double eps : {0.3, 0.1, 0.03}) {
    LinkOptions options;
    options.eps2 = eps;
    options.eps1 = eps / 2;
    options.smallest_area = 0.036;
    options.tolerance = 1e-12;
    LinkedRadiosity links(scene, options);
    const LinkUpdate update = links.build();
    EXPECT_TRUE(update.exchange.converged);
    EXPECT_LE(update.exchange.error_bound, 1e-12);
    const double worst = worst_of(links, 2);
    EXPECT_LT(worst, before);
    before = worst;
  }
  EXPECT_LT(before, 1e-9);  // all links join the smallest sub-patches
}

/// From a point of a facet that looks along `normal`, to a convex node: by the midpoints of n × n parts.
double summed_form_factor(const Vec3& point, const Vec3& normal, const Node& source, const Vec3& its_normal) {
  constexpr int n = 24;
  const Vec3& last = source.corner[source.corners - 1];
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const double u = (i + 0.5) / n, v = (j + 0.5) / n;
      const Vec3 at =
          (1 - u) * ((1 - v) * source.corner[0] + v * last) + u * ((1 - v) * source.corner[1] + v * source.corner[2]);
      const Vec3 d = at - point;
      const double square = dot(d, d), to = dot(normal, d), from = -dot(its_normal, d);
      if (to > 0 && from > 0) sum += to * from / (std::numbers::pi * square * square);
    }
  }
  return source.area / (n * n) * sum;
}

TEST(LinkedRadiosity, NoLinkThatCouldBeDividedBringsAnyPointMoreThanEps2) {
  LinkedRadiosity links(room_with_things(), coarse());
  EXPECT_FALSE(links.build().stopped);
  const PolygonSoup& soup = links.obstacles().soup();
  const auto normal = [&](const Node& node) { return normalized(soup.facets()[node.facet].plane.normal); };
  double most = 0;
  for (std::uint32_t r = 0; r < links.links().roots(); ++r) {
    for (const Link& link : links.links().of_receiver(r)) {
      const Node &to = links.tree().node(link.destination), &from = links.tree().node(link.source);
      if (link.ghost || link.blocked || (!to.has_children() && !from.has_children())) continue;
      for (const Vec3& corner : to.loop()) {
        const double F = summed_form_factor(corner, normal(to), from, normal(from));
        most = std::max(most, links.radiosity().luminance()[link.source] * F);
      }
    }
  }
  const double eps2 = links.options().eps2 * 2;  // of the lamp
  EXPECT_LT(most, 1.01 * eps2);
  EXPECT_GT(most, 0.1 * eps2);
}

TEST(LinkedRadiosity, HvtLeavesWhatDirectLeavesBitForBit) {
  std::mt19937_64 random(1);
  for (int k = 0; k < 10; ++k) {
    Scene scene = empty_room();
    const int things = 2 + static_cast<int>(random() % 3);
    for (int t = 0; t < things; ++t) {
      const Vec3 low{uniform(random, 0.2, 2), uniform(random, 0.2, 2), t % 2 ? 0 : uniform(random, 0.3, 1.5)};
      const Vec3 size{uniform(random, 0.2, 0.8), uniform(random, 0.2, 0.8), uniform(random, 0.2, 0.8)};
      add(scene, "thing", box_faces(low, low + size, t == 1 ? 3 : 2, 0));
    }
    LinkOptions options;
    options.eps2 = 0.1;
    options.eps1 = 0.06;
    options.smallest_area = 0.02;
    LinkedRadiosity direct(scene, options), hvt(scene, options);
    direct.build();
    hvt.build();
    ASSERT_TRUE(same_bits(direct.links(), hvt.links()));
    for (int e = 0; e < 4; ++e) {
      std::vector<Edit> edits;
      const int n = 1 + static_cast<int>(random() % 2);
      for (int i = 0; i < n; ++i) {
        edits.push_back(move_to(1 + static_cast<std::uint32_t>(i),
                                {uniform(random, -0.2, 0.2), uniform(random, -0.2, 0.2), 0},
                                e % 2 ? 0 : 90.0 * (e / 2)));
      }
      const LinkUpdate d = direct.update(edits, LinkMethod::direct), h = hvt.update(edits, LinkMethod::hvt);
      EXPECT_LT(h.work.links_updated, d.work.links_updated);
      ASSERT_TRUE(same_bits(direct.links(), hvt.links())) << k << ", " << e;
      EXPECT_EQ(
          std::memcmp(direct.radiosity().B().data(), hvt.radiosity().B().data(), direct.radiosity().B().size_bytes()),
          0);
    }
  }
}

/// Two walls that face each other, finely linked, and a screen beside them.
Scene two_walls() {
  Scene scene;
  scene.bands = 1;
  scene.materials = {grey(0.5, 0), grey(0.5, 1)};
  add(scene, "light", {box_faces({-1, 0, 0}, {0, 1, 1}, 1, 0)[5]});
  add(scene, "wall", {box_faces({2, 0, 0}, {3, 1, 1}, 0, 0)[4]});
  add(scene, "screen", box_faces({0.9, 3, -1}, {1.1, 6, 2}, 0, 0));
  return scene;
}

// Many links are then blocked of which only one above is asked about.
TEST(LinkedRadiosity, AScreenMovesBetweenTwoWallsAndBack) {
  LinkOptions options;
  options.eps2 = 0.01;
  options.eps1 = 5e-3;
  options.smallest_area = 0.01;
  options.B_eps = 1e-5;
  for (const double covers : {-4.0, -2.6, -5.5}) {  // all of them, or a part from either side
    LinkedRadiosity direct(two_walls(), options), hvt(two_walls(), options), peu(two_walls(), options);
    for (LinkedRadiosity* links : {&direct, &hvt, &peu}) links->build();
    for (const double y : {covers, 0.0}) {
      const std::vector<Edit> edits{move_to(2, {0, y, 0})};
      direct.update(edits, LinkMethod::direct);
      hvt.update(edits, LinkMethod::hvt);
      peu.update(edits, LinkMethod::hvt_peu);
      EXPECT_TRUE(same_bits(direct.links(), hvt.links())) << covers << ", " << y;
      EXPECT_LT(error_of(peu), 1e-4) << covers << ", " << y;
    }
  }
}

TEST(LinkedRadiosity, ASolidThatTwoObjectsCloseChangesWithEither) {
  Scene scene = empty_room();
  const std::vector<Surface> faces = box_faces({1, 1, 1}, {2, 2, 2}, 2, 0);
  add(scene, "sides", {faces.begin() + 2, faces.end()});
  add(scene, "lids", {faces.begin(), faces.begin() + 2});
  LinkedRadiosity direct(scene, coarse()), hvt(scene, coarse()), shot(scene, coarse());
  for (LinkedRadiosity* links : {&direct, &hvt, &shot}) links->build();
  for (const Operation operation : {Operation::remove, Operation::add}) {
    const std::vector<Edit> edits{{operation, 2, {}, {}, {}}};
    direct.update(edits, LinkMethod::direct);
    EXPECT_GT(hvt.update(edits, LinkMethod::hvt).work.links_updated, 0u);
    shot.update(edits, LinkMethod::hvt_peu);
    EXPECT_TRUE(same_bits(direct.links(), hvt.links())) << name_of(operation);
    EXPECT_LT(error_of(shot), 1e-3) << name_of(operation);
  }
}

/// An empty room that a bulb lights, object 1.
Scene dim_room() {
  Scene scene = empty_room();
  scene.surfaces[1].material = 0;
  add(scene, "bulb", box_faces({0.1, 0.1, 0.1}, {0.11, 0.11, 0.11}, 3, 0));
  return scene;
}

/// Moves an object, and then switches a lamp on, by PEU.
void move_and_light(LinkedRadiosity& links, const Edit& move, std::uint32_t lamp) {
  links.build();
  links.update(std::vector<Edit>{move}, LinkMethod::hvt_peu);
  links.update(std::vector<Edit>{{Operation::change, lamp, {}, {}, {{MaterialChange::kEvery, 3}}}},
               LinkMethod::hvt_peu);
}

LinkOptions with_threshold(double B_eps) {
  LinkOptions options = coarse();
  options.B_eps = B_eps;
  return options;
}

// A move while there is little light is not worth looking at, until a lamp is switched on.
TEST(LinkedRadiosity, LightThatComesLaterFindsWhatWasSkippedBefore) {
  Scene scene = dim_room();
  add(scene, "box", box_faces({0.8, 0.8, 1}, {1.8, 1.8, 1.6}, 2, 0));
  Surface lamp;
  lamp.polygon.outer = {{1, 1, 2.99}, {1, 2, 2.99}, {2, 2, 2.99}, {2, 1, 2.99}};
  lamp.material = 2;
  add(scene, "lamp", {lamp});
  LinkedRadiosity links(scene, with_threshold(1e-4));
  move_and_light(links, move_to(2, {0.4, 0.4, 0.2}), 3);
  EXPECT_LT(error_of(links), 1e-3);
}

// A tile comes close to a small lamp that is dark then: its form factor from before says nothing of what it receives
// once the lamp is on.
TEST(LinkedRadiosity, LightThatComesLaterFindsWhatCameNearBefore) {
  const auto square = [](double low, double high, double z) {
    Surface s;
    s.polygon.outer = {{low, low, z}, {high, low, z}, {high, high, z}, {low, high, z}};
    s.material = 2;
    return s;
  };
  Scene scene = dim_room();
  Surface lamp = square(1.49, 1.51, 2.9);
  std::ranges::reverse(lamp.polygon.outer);
  add(scene, "lamp", {lamp});
  add(scene, "tile", {square(1.4, 1.6, 0.1)});
  LinkedRadiosity links(scene, with_threshold(1e-4));
  move_and_light(links, move_to(3, {0, 0, 2.77}), 2);
  const std::vector<double> truth = links.converged();
  for (const Root& root : links.tree().roots()) {
    if (root.object != 3) continue;
    EXPECT_GT(truth[root.node_first], 1e-3);
    EXPECT_NEAR(links.radiosity().B()[root.node_first], truth[root.node_first], 1e-2 * truth[root.node_first]);
  }
}

TEST(LinkedRadiosity, RefinementEndsWhenAskedAndWhereMemoryEnds) {
  LinkOptions options = coarse();
  LinkedRadiosity whole(room_with_things(), options), part(room_with_things(), options);
  EXPECT_FALSE(whole.build().stopped);
  std::atomic<int> left = 20;
  const LinkUpdate update = part.build({[&] { return left-- <= 0; }, LinkOrder::any, {}});
  EXPECT_TRUE(update.stopped);
  const std::vector<std::uint8_t> moves(4);
  EXPECT_LT(part.links().count(part.tree(), moves).links(), whole.links().count(whole.tree(), moves).links());
  EXPECT_TRUE(update.exchange.converged);
  options.most_rounds = 1;  // of several
  LinkedRadiosity once(room_with_things(), options);
  EXPECT_TRUE(once.build().stopped);
  options.mesh.memory_limit = 100'000;
  EXPECT_THROW(LinkedRadiosity(room_with_things(), options).build(), LimitError);
}

TEST(LinkedRadiosity, TheOnlyLightGoesOut) {
  Scene scene = empty_room();
  scene.surfaces[1].material = 0;
  add(scene, "lamp", box_faces({1.2, 1.2, 2.8}, {1.9, 1.9, 2.9}, 3, 0));
  LinkedRadiosity links(scene, coarse());
  links.build();
  const std::vector<double> lit(links.radiosity().B().begin(), links.radiosity().B().end());
  const LinkUpdate off = links.update(std::vector<Edit>{{Operation::change, 1, {}, {}, {{MaterialChange::kEvery, 2}}}},
                                      LinkMethod::hvt_peu);
  EXPECT_TRUE(off.exchange.converged);
  const ConvergenceError error =
      link_error(links.tree(), links.elements(), 1, links.converged(), lit, links.radiosity().B());
  EXPECT_LT(error.all, 1e-6);
  EXPECT_LT(error.worst_1_percent, 1e-6);
}

// The smallest sub-patches are the patches of gathering: what remains is the quadrature of four points.
TEST(LinkedRadiosity, ConvergesToGatheringAsThresholdsFall) {
  Scene scene = empty_room();
  add(scene, "box", box_faces({0.75, 0.75, 0.75}, {1.5, 1.5, 1.5}, 2, 0));
  SolveOptions gathering;
  gathering.receivers = Receivers::area;
  gathering.form_factor_tolerance = 1e-4;
  gathering.mesh.patch_size = 0.76;
  const SceneSolution reference = solve_scene(scene, gathering);
  std::vector<double> mean(scene.surfaces.size()), areas(scene.surfaces.size());
  for (std::size_t p = 0; p < reference.mesh.patches.size(); ++p) {
    const Patch& patch = reference.mesh.patches[p];
    mean[patch.surface] += patch.area * reference.patches.B[p];
    areas[patch.surface] += patch.area;
  }
  double before = 1;
  for (const double eps : {0.3, 0.1, 0.03, 0.0}) {
    LinkOptions options = coarse();
    options.eps2 = options.eps1 = eps;
    options.smallest_area = 0.3;
    LinkedRadiosity links(scene, options);
    links.build();
    double missed = 0, all = 0;
    std::vector<double> linked(scene.surfaces.size());
    for (const Root& root : links.tree().roots()) {
      const std::uint32_t surface = links.scene().surfaces_of(root.object).first + root.surface;
      linked[surface] += links.tree().node(root.node_first).area * links.radiosity().B()[root.node_first];
    }
    for (std::size_t k = 0; k < mean.size(); ++k) {
      missed += (linked[k] - mean[k]) * (linked[k] - mean[k]) / areas[k];
      all += mean[k] * mean[k] / areas[k];
    }
    const double error = std::sqrt(missed / all);
    EXPECT_LE(error, before) << eps;
    before = error;
  }
  EXPECT_LT(before, 2e-3);
}

/// In O(log n), as links are in the order of their codes.
const Link* find(const LinkIndex& links, std::uint32_t receiver, std::uint32_t source, LinkCode code) {
  const std::span<const Link> between = links.between(receiver, source);
  const auto at = std::ranges::lower_bound(between, code, {}, &Link::code);
  return at != between.end() && at->code == code ? &*at : nullptr;
}

TEST(LinkedRadiosity, AnyLinkIsFoundByItsCode) {
  LinkedRadiosity links(room_with_things(), coarse());
  links.build();
  const LinkCounts counts = links.links().count(links.tree(), std::vector<std::uint8_t>{0, 0, 1, 0});
  EXPECT_GT(counts.mixed, 0u);
  EXPECT_EQ(counts.dynamic, 0u);
  EXPECT_EQ(counts.environment + counts.mixed, counts.links());
  std::size_t found = 0;
  for (std::uint32_t r = 0; r < links.links().roots(); ++r) {
    for (const Link& link : links.links().of_receiver(r)) {
      const std::uint32_t source = links.tree().node(link.source).root;
      ASSERT_EQ(find(links.links(), r, source, link.code), &link);
      std::uint32_t p = links.tree().root(r).node_first, q = links.tree().root(source).node_first;
      for (unsigned k = 0; k < link.code.steps(); ++k) {
        std::uint32_t& end = link.code.end(k) == LinkCode::End::receiver ? p : q;
        end = links.tree().node(end).first_child + link.code.child(k);
      }
      ASSERT_EQ(p, link.destination);
      ASSERT_EQ(q, link.source);
      found += link.ghost ? 0 : 1;
    }
  }
  EXPECT_EQ(found, counts.links());
  const LinkCode below = LinkCode().descend(LinkCode::End::receiver, 0).descend(LinkCode::End::receiver, 0);
  EXPECT_EQ(find(links.links(), 0, 1, below.descend(LinkCode::End::receiver, 0)), nullptr);
}

TEST(LinkedRadiosity, MaterialsTouchNoVisibilityButOfLinksThatAreRefined) {
  for (const LinkMethod method : {LinkMethod::direct, LinkMethod::hvt, LinkMethod::hvt_peu}) {
    LinkedRadiosity links(room_with_things(), coarse());
    links.build();
    Edit edit;
    edit.operation = Operation::change;
    edit.object = 2;
    edit.materials = {{MaterialChange::kEvery, 4}};  // the lamp goes out
    const LinkUpdate off = links.update({&edit, 1}, method);
    EXPECT_GT(off.work.unrefined, 0u);
    EXPECT_EQ(off.work.links_updated, off.work.unrefined);
    EXPECT_LT(error_of(links), 1e-5);
    edit.materials = {{MaterialChange::kEvery, 3}};
    const LinkUpdate on = links.update({&edit, 1}, method);
    EXPECT_GT(on.work.refined, 0u);
    EXPECT_LT(error_of(links), 1e-5);
  }
}

TEST(LinkedRadiosity, ObjectsComeAndGo) {
  for (const LinkMethod method : {LinkMethod::rebuild, LinkMethod::direct, LinkMethod::hvt, LinkMethod::hvt_peu}) {
    LinkOptions options = coarse();
    options.B_eps = 0;
    LinkedRadiosity links(room_with_things(), options);
    links.build();
    SCOPED_TRACE(static_cast<int>(method));
    const std::vector<double> before(links.radiosity().B().begin(), links.radiosity().B().end());
    std::vector<Edit> edits(2);
    edits[0].operation = edits[1].operation = Operation::remove;
    edits[0].object = 1;
    edits[1].object = 2;
    links.update(edits, method);
    EXPECT_LT(error_of(links), 1e-5);
    for (Edit& edit : edits) edit.operation = Operation::add;
    links.update(edits, method);
    EXPECT_LT(error_of(links), 1e-5);
    double worst = 0;
    for (const std::uint32_t n : links.elements())
      worst = std::max(worst, std::fabs(links.radiosity().B()[n] - before[n]));
    EXPECT_LT(worst, 0.1);  // refinement looks at B as it stood: not the same links everywhere
  }
}

// What PEU leaves undone is known, and a later update without a threshold finishes it.
TEST(LinkedRadiosity, WhatPeuLeavesIsWorkedOff) {
  LinkOptions options = coarse();
  options.B_eps = 0.02;
  LinkedRadiosity links(room_with_things(), options);
  links.build();
  const Edit there = move_to(1, {0.4, 0.2, 0}), stays = move_to(3, {0, 0, 0});
  const LinkUpdate peu = links.update({&there, 1}, LinkMethod::hvt_peu);
  EXPECT_GT(peu.work.skipped, 0u);
  const double left = error_of(links);
  EXPECT_GT(left, 1e-6);
  EXPECT_LT(left, 0.05);
  const std::vector<double> converged = links.converged(), most = links.left_as_it_was();
  const double largest = *std::ranges::max_element(most), furthest = [&] {
    double distance = 0;
    for (std::size_t n = 0; n < converged.size(); ++n)
      distance = std::max(distance, std::fabs(converged[n] - links.radiosity().B()[n]));
    return distance;
  }();
  EXPECT_GT(largest, 0);
  EXPECT_LE(furthest, largest / (1 - 0.6));  // of which so much is reflected at most
  links.update({&stays, 1}, LinkMethod::hvt);
  EXPECT_LT(error_of(links), 1e-7);
  EXPECT_TRUE(links.left_as_it_was().empty());
}

// Shots take back the light of a lamp that goes to within rounding, here a little more than all of it.
TEST(LinkedRadiosity, PeuWithoutAThresholdSkipsNothingInTheDark) {
  Scene scene = room_with_things();
  scene.surfaces[1].material = 0;  // the ceiling
  LinkOptions options = coarse();
  options.B_eps = 0;
  LinkedRadiosity direct(scene, options), peu(scene, options);
  direct.build();
  peu.build();
  Edit lamp_goes, lamp_comes;
  lamp_goes.object = lamp_comes.object = 2;
  lamp_goes.operation = Operation::remove;
  lamp_comes.operation = Operation::add;
  const std::vector<std::uint8_t> moves(scene.objects.size());
  bool below_0 = false;
  for (const Edit& edit : {lamp_goes, move_to(1, {0.3, 0.1, 0}), move_to(3, {-0.4, 0.5, 0.1}), lamp_comes}) {
    direct.update({&edit, 1}, LinkMethod::direct);
    EXPECT_EQ(peu.update({&edit, 1}, LinkMethod::hvt_peu).work.skipped, 0u);
    EXPECT_TRUE(peu.left_as_it_was().empty());
    const LinkCounts expected = direct.links().count(direct.tree(), moves),
                     found = peu.links().count(peu.tree(), moves);
    EXPECT_EQ(found.active, expected.active);
    EXPECT_EQ(found.shadow, expected.shadow);
    EXPECT_EQ(found.ghost, expected.ghost);
    below_0 = below_0 || std::ranges::any_of(peu.radiosity().luminance(), [](double Y) { return Y < 0; });
  }
  EXPECT_TRUE(below_0) << "else this shows nothing";
}

// What moves into the shaft of a link that brings nothing, or out of that of one that is not hidden, changes neither.
TEST(LinkedRadiosity, PeuMarksNoLinkThatCannotHaveChanged) {
  LinkOptions options = coarse();
  options.B_eps = 1e-12;
  LinkedRadiosity links(room_with_things(), options);
  links.build();
  for (const Vec3& to : {Vec3{0.4, 0.2, 0}, Vec3{-0.1, 0.3, 0.2}}) {
    const Edit edit = move_to(1, to);
    links.update({&edit, 1}, LinkMethod::hvt_peu);
    for (const double left : links.left_as_it_was()) EXPECT_LT(left, 1e-8);
    EXPECT_LT(error_of(links), 1e-6);
  }
}

TEST(LinkedRadiosity, AnyNumberOfThreadsGivesTheSameBits) {
  std::vector<std::unique_ptr<LinkedRadiosity>> all;
  for (const std::size_t threads : {1, 2}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    LinkedRadiosity& links = *all.emplace_back(std::make_unique<LinkedRadiosity>(room_with_things(), coarse()));
    links.build();
    const Edit edit = move_to(1, {0.3, 0.1, 0.1}, 20);
    links.update({&edit, 1}, LinkMethod::hvt_peu);
  }
  EXPECT_TRUE(same_bits(all[0]->links(), all[1]->links()));
  EXPECT_EQ(
      std::memcmp(all[0]->radiosity().B().data(), all[1]->radiosity().B().data(), all[0]->radiosity().B().size_bytes()),
      0);
}

TEST(LinkedRadiosity, RefusesOptionsOutOfRange) {
  LinkOptions options = coarse();
  options.eps1 = 2 * options.eps2;
  EXPECT_THROW(LinkedRadiosity(room_with_things(), options), std::invalid_argument);
}

}  // namespace
}  // namespace exitance
