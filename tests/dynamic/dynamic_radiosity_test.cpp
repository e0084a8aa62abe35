#include "src/dynamic/dynamic_radiosity.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "src/dynamic/converged_reference.h"
#include "src/scene/furnished_room.h"
#include "tests/dynamic/rooms.h"

namespace exitance {
namespace {

constexpr MeshOptions kMesh{1.5, 1};

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = a.size() == b.size() ? 0 : INFINITY;
  for (std::size_t i = 0; i < a.size() && i < b.size(); ++i) largest = std::max(largest, std::fabs(a[i] - b[i]));
  return largest;
}

/// A scene, and a solution that follows its edits.
class Followed {
 public:
  explicit Followed(Scene scene, MeshOptions mesh = kMesh)
      : edited(std::move(scene)), mesh_(mesh), state(std::make_shared<SceneVersion>(edited, mesh), edited.scene()) {}

  void apply(const Edit& edit) {
    const EditedScene::Effect effect = edited.apply(edit);
    if (effect.geometry) {
      state.change_geometry(std::make_shared<SceneVersion>(state.version(), edited, mesh_, edit.object), edited.scene(),
                            edit.object, "");
    }
    if (effect.materials) state.change_materials(edited.scene(), edit.object);
  }
  /// Up to so many shots, the strongest of any kind first.
  void shoot(int shots, double until = 1e-13) {
    for (; shots > 0; --shots) {
      if (gathers && state.patches_to_gather() > 0) {
        state.gather();
        continue;
      }
      const auto change = state.strongest_change();
      const auto unshot = state.strongest();
      if (change.energy >= unshot.energy) {
        const DynamicShot shot = state.redistribute(change.change, change.patch, search);
        work += shot.work;
      } else if (state.error_bound() > until) {
        state.propagate(unshot.patch);
      } else if (change.energy >= 0) {
        work += state.redistribute(change.change, change.patch, search).work;
      } else {
        return;
      }
    }
  }
  void finish() {
    shoot(100000);
    ASSERT_EQ(state.pending_changes(), 0u);
  }

  EditedScene edited;
  MeshOptions mesh_;
  DynamicRadiosity state;
  VersionDifference::Search search = VersionDifference::Search::shadow_volumes;
  bool gathers = false;
  ChangeWork work;
};

/// Sums of a column and of the rows of each element, by searches of their own from every point.
void expect_columns_equal_rows(const Scene& scene, const MeshOptions& mesh) {
  const EditedScene edited(scene);
  const auto version = std::make_shared<const SceneVersion>(edited, mesh);
  std::vector<PointRow> rows;
  for (std::uint32_t e = 0; e < version->elements(); ++e) rows.push_back(version->row(e));
  std::vector<std::size_t> next(rows.size());
  for (std::uint32_t p = 0; p < version->patches(); ++p) {
    std::uint64_t tests = 0;
    const FormFactorColumn column = make_column(version, p, tests);
    auto at = column.element.begin();
    for (std::uint32_t e = 0; e < rows.size(); ++e) {
      double F = 0, F_row = 0, error = 1e-13;
      if (at != column.element.end() && *at == e) F = column.F[static_cast<std::size_t>(at++ - column.element.begin())];
      if (next[e] < rows[e].column.size() && rows[e].column[next[e]] == p) {
        F_row = rows[e].F[next[e]];
        error += 2 * rows[e].F_error[next[e]++];
      }
      ASSERT_NEAR(F, F_row, error) << "element " << e << ", patch " << p;
    }
  }
}

TEST(FormFactorColumn, EqualsTheRowsThatLookFromEachPoint) {
  Scene scene = test_room();
  Surface frame;  // not convex, with a hole: patches of several pieces
  frame.polygon.outer = {{0.25, 1, 1.75},   {2.25, 1, 1.75},    {2.25, 2.5, 1.75},
                         {1.25, 2.5, 1.75}, {1.25, 1.75, 1.75}, {0.25, 1.75, 1.75}};
  frame.polygon.holes = {{{0.5, 1.25, 1.75}, {0.5, 1.5, 1.75}, {1, 1.5, 1.75}, {1, 1.25, 1.75}}};
  frame.object = 4;
  scene.surfaces.push_back(frame);
  std::reverse(frame.polygon.outer.begin(), frame.polygon.outer.end());
  std::reverse(frame.polygon.holes[0].begin(), frame.polygon.holes[0].end());
  scene.surfaces.push_back(frame);
  expect_columns_equal_rows(scene, {0.7, 2});
  expect_columns_equal_rows(make_furnished_room(100, 3), {2.5, 1});
}

TEST(DynamicRadiosity, NothingDependsOnWhichColumnsAreKept) {
  const auto solve = [](std::uint64_t memory) {
    RandomEdits random(3);
    EditedScene edited(test_room());
    DynamicRadiosity state(std::make_shared<SceneVersion>(edited, kMesh), edited.scene(), memory);
    for (int k = 0; k < 200; ++k) {
      if (k % 40 == 39) {
        const Edit edit = random.next(edited);
        if (edited.apply(edit).geometry)
          state.change_geometry(std::make_shared<SceneVersion>(state.version(), edited, kMesh, edit.object),
                                edited.scene(), edit.object, "");
        state.change_materials(edited.scene(), edit.object);
      }
      const auto change = state.strongest_change();
      if (change.energy >= 0 && k % 2 == 0) {
        state.redistribute(change.change, change.patch, VersionDifference::Search::shadow_volumes);
      } else {
        state.propagate(state.strongest().patch);
      }
    }
    return state.element_B();
  };
  const auto all = solve(DynamicRadiosity::kColumnMemory);
  EXPECT_LT(largest_difference(all, solve(0)), 1e-12);
  EXPECT_LT(largest_difference(all, solve(20'000)), 1e-12) << "some";
}

TEST(DynamicRadiosity, WithoutEditsItIsProgressiveRefinement) {
  Followed room(test_room());
  room.finish();
  EXPECT_LT(largest_difference(room.state.element_B(), converged_reference(room.state)), 1e-11);
}

TEST(DynamicRadiosity, EachKindOfEditEqualsSolvingFromScratch) {
  std::vector<Edit> edits;
  Edit move{Operation::move, 1, Placement{}, {}, {}};
  move.placement->translation = {0.5, 0.25, 0.5};
  edits.push_back(move);
  edits.push_back({Operation::add, 3, {}, {}, {}});
  edits.push_back({Operation::remove, 2, {}, {}, {}});
  edits.push_back({Operation::change, 1, {}, {}, {{MaterialChange::kEvery, 2}}});
  edits.push_back({Operation::change, 3, {}, {}, {{3, 0}}});
  edits.push_back({Operation::reshape, 1, {}, box_surfaces({0.5, 0.5, 0}, {2, 1.5, 1.5}, 1, 1, false), {}});
  Edit turn{Operation::move, 4, Placement{rotation({1, 0, 0.2}, 30), {0, 1, 0.4}}, {}, {}};
  edits.push_back(turn);
  edits.push_back({Operation::remove, 4, {}, {}, {}});
  edits.push_back({Operation::add, 2, {}, {}, {}});
  for (const bool gathers : {false, true}) {
    Followed room(test_room());
    room.gathers = gathers;
    room.finish();
    for (const Edit& edit : edits) {
      room.apply(edit);
      room.finish();
      EXPECT_LT(largest_difference(room.state.element_B(), converged_reference(room.state)), 1e-10)
          << name_of(edit.operation) << " object " << edit.object << (gathers ? ", gathered" : ", shot");
    }
  }
}

// R_i of eq. 5, by Figure 2 and by the section before it.
TEST(DynamicRadiosity, GatheredTermsAreThoseThatAllShotsBring) {
  for (const bool lamp : {false, true}) {
    Followed shot(test_room());
    shot.shoot(60);
    Edit move{Operation::move, 2, Placement{rotation({0, 0, 1}, 20), {-0.5, 0.25, 0.25}}, {}, {}};
    shot.apply(move);
    shot.shoot(7);
    shot.apply(lamp ? Edit{Operation::add, 3, {}, {}, {}} : Edit{Operation::move, 1, move.placement, {}, {}});
    ASSERT_EQ(shot.state.pending_changes(), 2u);
    Followed gathered = shot;
    const ObjectSlot slot = gathered.state.version().slot(lamp ? 3 : 1);
    std::uint32_t count = 0;
    while (gathered.state.patches_to_gather() > 0) {
      EXPECT_EQ(gathered.state.gather().patch, slot.patch_first + count++);
    }
    EXPECT_EQ(count, slot.patch_count);
    const auto expect_same_on_object = [&](double tolerance) {
      const auto a = shot.state.element_B(), b = gathered.state.element_B();
      for (std::size_t i = std::size_t{slot.element_first} * 3; i < (slot.element_first + slot.element_count) * 3; ++i)
        ASSERT_NEAR(a[i], b[i], tolerance);
    };
    const auto at_once = gathered.state.element_B();
    for (Followed* room : {&shot, &gathered}) {
      while (room->state.pending_changes() > 0) {
        const auto change = room->state.strongest_change();
        const DynamicShot done =
            room->state.redistribute(change.change, change.patch, VersionDifference::Search::shadow_volumes);
        EXPECT_EQ(done.kind, DynamicShot::Kind::redistribution);
      }
    }
    expect_same_on_object(1e-12);
    const auto in_the_end = gathered.state.element_B();
    double most = 0;
    for (std::size_t i = std::size_t{slot.element_first} * 3; i < (slot.element_first + slot.element_count) * 3; ++i) {
      EXPECT_NEAR(at_once[i], in_the_end[i], 1e-12) << "shots bring nothing more";
      most = std::max(most, in_the_end[i]);
    }
    EXPECT_GT(most, 0.1);
    EXPECT_EQ(gathered.state.patches_to_gather(), 0u);
  }
}

/// B of an object's elements, by band.
std::vector<double> B_of(const DynamicRadiosity& state, std::uint32_t object) {
  const std::vector<double> B = state.element_B();
  const ObjectSlot& slot = state.version().slot(object);
  const auto first = B.begin() + static_cast<std::ptrdiff_t>(std::size_t{slot.element_first} * state.bands());
  return {first, first + static_cast<std::ptrdiff_t>(std::size_t{slot.element_count} * state.bands())};
}

TEST(DynamicRadiosity, WhatIsGatheredLastsUntilTheObjectItselfChanges) {
  Followed room(test_room());
  room.shoot(60);
  room.apply({Operation::add, 3, {}, {}, {}});
  const auto dark = B_of(room.state, 3);
  while (room.state.patches_to_gather() > 1) room.state.gather();
  const auto gathered = B_of(room.state, 3);
  EXPECT_GT(largest_difference(gathered, dark), 1e-3);
  // Something else changes, what was gathered for it is shot in part, a third thing goes.
  room.apply({Operation::move, 4, Placement{rotation({1, 0, 0.2}, 30), {0, 1, 0.4}}, {}, {}});
  EXPECT_EQ(B_of(room.state, 3), gathered);
  EXPECT_EQ(room.state.patches_to_gather(), room.state.version().slot(4).patch_count) << "the lamp gathers no more";
  room.state.gather();
  for (int k = 0; k < 10; ++k) {
    const auto change = room.state.strongest_change();
    room.state.redistribute(change.change, change.patch, VersionDifference::Search::shadow_volumes);
  }
  room.apply({Operation::remove, 2, {}, {}, {}});
  Followed other = room;
  room.finish();
  EXPECT_LT(largest_difference(room.state.element_B(), converged_reference(room.state)), 1e-10);
  other.apply({Operation::move, 3, Placement{rotation({0, 0, 1}, 20), {0.25, 0, 0}}, {}, {}});
  EXPECT_EQ(B_of(other.state, 3), dark) << "its emission";
  other.finish();
  EXPECT_LT(largest_difference(other.state.element_B(), converged_reference(other.state)), 1e-10);
}

TEST(DynamicRadiosity, ASolidThatTwoObjectsCloseChangesWithEither) {
  Scene scene = test_room();
  const std::vector<Surface> faces = box_surfaces({1, 1, 1}, {2, 2, 2}, 1, 2, false);
  std::erase_if(scene.surfaces, [](const Surface& s) { return s.object == 1 || s.object == 2; });
  for (std::size_t k = 0; k < faces.size(); ++k) {
    scene.surfaces.push_back(faces[k]);
    scene.surfaces.back().object = k < 2 ? 2 : 1;
  }
  std::ranges::stable_sort(scene.surfaces, {}, &Surface::object);
  Followed room(scene);
  room.finish();
  for (const Operation operation : {Operation::remove, Operation::add}) {
    room.apply({operation, 2, {}, {}, {}});
    room.finish();
    EXPECT_LT(largest_difference(room.state.element_B(), converged_reference(room.state)), 1e-10) << name_of(operation);
  }
}

/// Whether all sample points are those of a mesh that was made of the scene as it is now.
void expect_samples_of_a_new_mesh(const EditedScene& edited, const SceneVersion& version, const MeshOptions& mesh) {
  const SceneVersion fresh(edited, mesh);
  for (std::uint32_t k = 0; k < version.objects(); ++k) {
    const ObjectSlot &slot = version.slot(k), &there = fresh.slot(k);
    ASSERT_EQ(slot.present, there.present);
    for (std::uint32_t e = 0; slot.present && e < slot.element_count; ++e) {
      const Element &own = version.mesh().elements[slot.element_first + e],
                    &new_one = fresh.mesh().elements[there.element_first + e];
      ASSERT_EQ(own.sample, new_one.sample) << "object " << k << ", element " << e;
    }
  }
}

/// The test room, turned.
Scene turned_test_room(double degrees) {
  Scene scene = test_room();
  const Placement turn{rotation({1, 2, 3}, degrees), {}};
  for (auto* surfaces : {&scene.surfaces, &scene.absent}) {
    for (Surface& surface : *surfaces) {
      for (Vec3& corner : surface.polygon.outer) corner = turn(corner);
    }
  }
  return scene;
}

// Elements of 0.75 m have centres at odd multiples of 0.375 m: edges of the moved box pass through some of the floor.
TEST(DynamicRadiosity, SamplePointsMakeWayForEdgesAndGoBack) {
  for (const double degrees : {0.0, 25.0}) {
    Followed room(turned_test_room(degrees), {1.5, 2});
    const auto first = room.state.shared_version();
    const auto move = [&](const Vec3& by) {
      Edit edit{Operation::move, 1, Placement{}, {}, {}};
      edit.placement->translation = Placement{rotation({1, 2, 3}, degrees), {}}(by);
      room.apply(edit);
    };
    room.shoot(100);
    for (const bool gathers : {false, true}) {
      room.gathers = gathers;
      move({0.125, 0.125, 0});  // from 1.125 to 1.875: two edges, and a corner, on centres
      EXPECT_GE(room.state.version().resampled_since(*first).size(), 4u) << degrees;
      expect_samples_of_a_new_mesh(room.edited, room.state.version(), {1.5, 2});
      room.finish();
      EXPECT_LT(largest_difference(room.state.element_B(), converged_reference(room.state)), 1e-10) << degrees;
      move({0, 0, 0});
      EXPECT_THAT(room.state.version().resampled_since(*first), testing::IsEmpty());
      room.shoot(20);
    }
    room.finish();
    EXPECT_LT(largest_difference(room.state.element_B(), converged_reference(room.state)), 1e-10) << degrees;
  }
}

// The most important test: 100 random edits, interrupted anywhere.
TEST(DynamicRadiosity, AHundredRandomEditsInterruptedAnywhereEqualSolvingFromScratch) {
  RandomEdits random(5);
  Followed room(test_room());
  std::size_t most_pending = 0;
  for (int k = 0; k < 100; ++k) {
    room.gathers = k % 3 != 0;
    room.shoot(static_cast<int>(random.pick(k % 10 == 0 ? 400 : 12)));
    room.apply(random.next(room.edited));
    most_pending = std::max(most_pending, room.state.pending_changes());
    if (k % 25 != 24) continue;
    room.finish();
    expect_samples_of_a_new_mesh(room.edited, room.state.version(), kMesh);
    EXPECT_LT(largest_difference(room.state.element_B(), converged_reference(room.state)), 1e-10) << "edit " << k;
  }
  EXPECT_GT(most_pending, 5u) << "several changes were open at a time";
}

TEST(DynamicRadiosity, ShadowVolumesMissNothingThatLookingEverywhereFinds) {
  RandomEdits random(11);
  EditedScene edited(test_room());
  auto version = std::make_shared<const SceneVersion>(edited, MeshOptions{1.0, 1});
  std::uint64_t changed = 0, resampled = 0;
  for (int k = 0; k < 20; ++k) {
    const Edit edit = random.next(edited);
    if (!edited.apply(edit).geometry) continue;
    const auto next = std::make_shared<const SceneVersion>(*version, edited, MeshOptions{1.0, 1}, edit.object);
    expect_samples_of_a_new_mesh(edited, *next, {1.0, 1});
    resampled += next->resampled_since(*version).size();
    const VersionDifference difference(version, next);
    for (std::uint32_t p = 0; p < version->patches(); ++p) {
      if (version->object_of_patch(p) == SceneVersion::kVoid) continue;
      ChangeWork all, some;
      const auto everywhere = difference.column(p, VersionDifference::Search::everywhere, nullptr, {}, all);
      const auto found = difference.column(p, VersionDifference::Search::shadow_volumes, nullptr, {}, some);
      auto at = found.begin();
      for (const FormFactorChange& c : everywhere) {
        if (std::fabs(c.after - c.before) <= c.error + 1e-15) continue;
        ++changed;
        while (at != found.end() && at->element < c.element) ++at;
        ASSERT_TRUE(at != found.end() && at->element == c.element)
            << "edit " << k << ", patch " << p << ", element " << c.element << ": " << c.before << " to " << c.after;
        EXPECT_NEAR(at->after - at->before, c.after - c.before, 1e-12);
      }
    }
    version = next;
  }
  EXPECT_GT(changed, 1000u);
  EXPECT_GT(resampled, 0u);
}

TEST(DynamicRadiosity, AnyNumberOfThreadsGivesTheSameBits) {
  const auto solve = [](std::size_t threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    RandomEdits random(3);
    Followed room(test_room());
    room.gathers = true;
    for (int k = 0; k < 6; ++k) {
      room.shoot(40);
      room.apply(random.next(room.edited));
    }
    room.shoot(60);
    return room.state.element_B();
  };
  const auto one = solve(1);
  EXPECT_EQ(one, solve(2));
  EXPECT_EQ(one, solve(5));
}

}  // namespace
}  // namespace exitance
