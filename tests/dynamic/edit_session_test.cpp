#include "src/dynamic/edit_session.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "src/dynamic/converged_reference.h"
#include "src/scene/trespass.h"
#include "tests/dynamic/rooms.h"
#include "tests/output/scratch_folder.h"

namespace exitance {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pointwise;

SessionOptions options_with(UpdateMethod method, Strategy strategy, ImportanceOptions::Kind importance) {
  SessionOptions options;
  options.mesh = {1.5, 1};
  options.method = method;
  options.strategy = strategy;
  options.importance.kind = importance;
  options.tolerance = 1e-13;
  return options;
}

SessionOptions gathering() {
  SessionOptions options =
      options_with(UpdateMethod::redistribute, Strategy::interleave, ImportanceOptions::Kind::exact);
  options.object_terms = ObjectTerms::gathered;
  return options;
}

SessionOptions plain() {
  return options_with(UpdateMethod::redistribute, Strategy::redistribute_first, ImportanceOptions::Kind::estimated);
}

SessionOptions shooting() {
  SessionOptions options = plain();
  options.object_terms = ObjectTerms::shot;
  return options;
}

double distance(const DynamicRadiosity& state) {
  const std::vector<double> reference = converged_reference(state), B = state.element_B();
  double largest = 0;
  for (std::size_t i = 0; i < B.size(); ++i) largest = std::max(largest, std::fabs(B[i] - reference[i]));
  return largest;
}

Edit moved(std::uint32_t object, const Vec3& by) {
  return {Operation::move, object, Placement{{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}, by}, {}, {}};
}

TEST(EditSession, EveryMethodStrategyAndImportanceConvergesToTheSame) {
  using Kind = ImportanceOptions::Kind;
  for (const SessionOptions& options :
       {options_with(UpdateMethod::scratch, Strategy::interleave, Kind::estimated),
        options_with(UpdateMethod::restart, Strategy::interleave, Kind::estimated),
        options_with(UpdateMethod::redistribute, Strategy::redistribute_first, Kind::estimated),
        options_with(UpdateMethod::redistribute, Strategy::redistribute_first, Kind::exact),
        options_with(UpdateMethod::redistribute, Strategy::interleave, Kind::estimated),
        options_with(UpdateMethod::redistribute, Strategy::interleave, Kind::exact), gathering(), shooting()}) {
    EditSession session(test_room(), options);
    EXPECT_TRUE(session.work({}).finished);
    session.apply(moved(1, {0.25, 0.5, 0}));
    session.apply({Operation::add, 3, {}, {}, {}});
    const SessionWork work = session.work({});
    EXPECT_TRUE(work.finished);
    EXPECT_THAT(session.log(), IsEmpty());
    EXPECT_LT(distance(session.solution()), 1e-10);
    if (options.method == UpdateMethod::scratch) {
      EXPECT_EQ(work.redistributions, 0u);
    }
  }
}

TEST(EditSession, ABudgetOfZeroShootsNothingAndLeavesAllInTheLog) {
  EditSession session(test_room(), plain());
  session.work({});
  session.apply(moved(1, {0.5, 0, 0}));
  Budget nothing;
  nothing.shots = 0;
  const SessionWork work = session.work(nothing);
  EXPECT_EQ(work.propagations + work.redistributions, 0u);
  EXPECT_FALSE(work.finished);
  ASSERT_EQ(session.log().size(), 1u);
  EXPECT_EQ(session.log()[0].name, "move box");
  EXPECT_GT(session.log()[0].patches, 10u);
  EXPECT_GT(session.redistribution_left(), 0);
  EXPECT_GT(session.log()[0].largest_energy, 0);
  nothing = {};
  nothing.seconds = 0;
  EXPECT_EQ(session.work(nothing).redistributions, 0u);
  session.work({});
  EXPECT_THAT(session.log(), IsEmpty());
  EXPECT_LT(distance(session.solution()), 1e-10) << "worked off later, nothing is lost";
}

// Ranked by all that patches have shot, which is B − ΔB of the solution before the edit.
TEST(EditSession, TheLogIsRankedThoughNothingWasShotSince) {
  SessionOptions options =
      options_with(UpdateMethod::restart, Strategy::redistribute_first, ImportanceOptions::Kind::total);
  EditSession session(test_room(), options);
  session.work({});
  const DynamicRadiosity before = session.solution();
  const std::vector<double> weights = luminance_weights(before.bands());
  double largest = 0;
  std::uint32_t strongest = 0;
  for (std::uint32_t p = 0; p < before.version().patches(); ++p) {
    double luminance = 0;
    for (std::uint32_t b = 0; b < before.bands(); ++b) {
      const std::size_t i = std::size_t{p} * before.bands() + b;
      luminance += weights[b] * std::fabs(before.patch_B()[i] - before.unshot()[i]);
    }
    const double energy = before.version().mesh().patches[p].area * luminance;
    if (energy > largest * (1 + 1e-9)) {
      largest = energy;
      strongest = p;
    }
  }
  session.apply(moved(1, {0.5, 0, 0}));
  Budget nothing;
  nothing.shots = 0;
  session.work(nothing);
  ASSERT_EQ(session.log().size(), 1u);
  EXPECT_NEAR(session.log()[0].largest_energy, largest, 1e-9 * largest);
  EXPECT_EQ(session.log()[0].patch, strongest);
}

TEST(EditSession, TheLogIsRankedWhereEmittersCameFirstOrAnObjectIsHeld) {
  EditSession session(test_room(), plain());
  session.work({});
  session.apply({Operation::add, 3, {}, {}, {}});
  Budget six;
  six.shots = 6;
  session.work(six);
  ASSERT_EQ(session.log().size(), 1u);
  EXPECT_GT(session.log()[0].largest_energy, 0);
  EXPECT_EQ(session.log()[0].largest_energy, session.redistribution_left());
  session.work({});
  session.apply({Operation::select, 1, {}, {}, {}});
  Budget nothing;
  nothing.shots = 0;
  session.work(nothing);
  const auto log = session.log();
  ASSERT_EQ(log.size(), 1u) << "taken out and put back at once";
  EXPECT_GT(log[0].largest_energy, 0);
}

TEST(EditSession, AskingForTheLogChangesNoShot) {
  for (const SessionOptions& options : {plain(), gathering(), shooting()}) {
    EditSession asked(test_room(), options);
    asked.work({});
    asked.apply(moved(1, {0.5, 0, 0}));
    EditSession other = asked;
    Budget some;
    for (some.shots = 0; *some.shots < 12; *some.shots += 3) {
      asked.work(some);
      asked.log();
      other.work(some);
    }
    EXPECT_EQ(asked.solution().element_B(), other.solution().element_B());
  }
}

TEST(EditSession, WhatWasForgottenIsSaidUntilTheSolutionStartsOver) {
  SessionOptions options = plain();
  options.log = false;
  EditSession session(test_room(), options);
  session.work({});
  session.apply(moved(1, {0.25, 0, 0}));
  EXPECT_FALSE(session.solution().has_forgotten()) << "nothing was left of what came before";
  Budget five;
  five.shots = 5;
  session.work(five);
  session.apply(moved(2, {-0.25, 0, 0.3}));
  EXPECT_TRUE(session.solution().has_forgotten());
  EXPECT_TRUE(session.work({}).finished);
  EXPECT_GT(distance(session.solution()), 1e-4);
  EXPECT_TRUE(session.solution().has_forgotten()) << "however long it works";
  options.method = UpdateMethod::scratch;
  EditSession anew(session, options);
  anew.apply(moved(2, {-0.25, 0, 0.2}));
  EXPECT_FALSE(anew.solution().has_forgotten());
  anew.work({});
  EXPECT_LT(distance(anew.solution()), 1e-10);
}

TEST(EditSession, ABudgetOfJustTheShotsThatAreNeededFinishes) {
  EditSession session(test_room(), plain());
  session.work({});
  session.apply(moved(1, {0.25, 0, 0}));
  EditSession again = session;
  Budget just;
  just.shots = session.work({}).shots();
  EXPECT_TRUE(again.work(just).finished);
  EXPECT_EQ(again.work({}).shots(), 0u);
}

TEST(EditSession, ShotsThatWereCountedReplayBitForBit) {
  const auto run = [](const std::vector<std::uint64_t>& shots, std::vector<std::uint64_t>* counted) {
    EditSession session(test_room(), plain());
    session.work({});
    std::vector<double> B;
    for (std::size_t k = 0; k < 4; ++k) {
      session.apply(moved(2, {-0.2 * static_cast<double>(k), 0.1, 0.3}));
      Budget budget;
      int polls = 0;
      if (shots.empty()) {
        budget.interrupted = [&] { return ++polls == static_cast<int>(5 + 7 * k); };
      } else {
        budget.shots = shots[k];
      }
      const SessionWork work = session.work(budget);
      if (counted != nullptr) {
        EXPECT_TRUE(work.interrupted);
        counted->push_back(work.shots());
      }
      B = session.solution().element_B();
    }
    return B;
  };
  std::vector<std::uint64_t> counted;
  const auto first = run({}, &counted);
  EXPECT_THAT(counted, ElementsAre(5, 12, 19, 26));
  EXPECT_EQ(first, run(counted, nullptr));
}

TEST(EditSession, EmittersOnAnAddedObjectPropagateFirst) {
  EditSession session(test_room(), plain());
  session.work({});
  session.apply({Operation::add, 3, {}, {}, {}});
  Budget six;
  six.shots = 6;
  const SessionWork work = session.work(six);
  EXPECT_EQ(work.propagations, 6u) << "the lamp's six patches";
}

TEST(EditSession, AnEditedObjectGathersFirstAndEachPatchIsAShot) {
  EditSession session(test_room(), gathering());
  session.work({});
  session.apply(moved(1, {0.5, 0, 0}));
  Budget four;
  four.shots = 4;
  SessionWork work = session.work(four);
  EXPECT_EQ(work.gatherings, 4u);
  EXPECT_EQ(work.shots(), 4u);
  const std::uint32_t patches = session.solution().version().slot(1).patch_count;
  work = session.work({});
  EXPECT_EQ(work.gatherings, patches - 4);
  EXPECT_GT(work.redistributions, 10u);
  EXPECT_LT(distance(session.solution()), 1e-10);
}

// Whichever brings more: a shot of one of the four patches of light, or what all others bring to a patch of the box.
TEST(EditSession, TheStrongestShotsComeBeforeWhatIsGathered) {
  Scene dim = test_room();
  dim.materials[0].rho = {0.05, 0.05, 0.05};
  EditSession session(dim, plain());
  session.work({});
  session.apply(moved(1, {0.5, 0, 0}));
  ASSERT_EQ(session.solution().version().slot(1).patch_count, 6u);
  Budget one;
  one.shots = 1;
  std::string kinds;
  while (kinds.empty() || kinds.back() != 'p') {
    const SessionWork work = session.work(one);
    kinds += work.redistributions > 0 ? 'r' : work.gatherings > 0 ? 'g' : 'p';
  }
  EXPECT_THAT(kinds, testing::StartsWith("rrrr"));
  EXPECT_THAT(kinds, HasSubstr("rggggggr")) << "the others then go to the shadows";
  EXPECT_THAT(kinds, testing::EndsWith("rp"));
  session.work({});
  EXPECT_LT(distance(session.solution()), 1e-10);
}

TEST(EditSession, StrategyOneRedistributesBeforeItPropagates) {
  SessionOptions options = plain();
  options.threshold = 0;
  EditSession session(test_room(), options);
  session.work({});
  session.apply({Operation::remove, 1, {}, {}, {}});
  Budget some;
  some.shots = 20;
  EXPECT_EQ(session.work(some).redistributions, 20u);
}

// Only what had been shot when the change came is redistributed: a change before anything was shot leaves nothing to
// do.
TEST(EditSession, NothingIsRedistributedOfWhatWasNotShot) {
  EditSession session(test_room(), plain());
  session.apply(moved(1, {0.5, 0, 0}));
  EXPECT_THAT(session.log(), IsEmpty());
  Budget three;
  three.shots = 3;
  EXPECT_EQ(session.work(three).propagations, 3u);
  session.apply(moved(1, {0.25, 0, 0}));
  ASSERT_EQ(session.log().size(), 1u);
  EXPECT_LE(session.log()[0].patches, 3u);
  const SessionWork work = session.work({});
  EXPECT_LE(work.redistributions, 3u);
  EXPECT_LT(distance(session.solution()), 1e-10);
}

TEST(EditSession, ASelectedObjectsMovesBecomeOneRemovalAndOneAddition) {
  EditSession session(test_room(), plain());
  session.work({});
  session.apply({Operation::select, 1, {}, {}, {}});
  Budget few;
  few.shots = 6;
  for (int k = 0; k < 8; ++k) {
    session.apply(moved(1, {0.1 * k, 0.05 * k, 0}));
    session.work(few);
    EXPECT_TRUE(session.solution().version().slot(1).present) << "it is shown where it is";
    EXPECT_LE(session.log().size(), 2u);
  }
  EXPECT_THROW(session.apply(moved(2, {0, 0, 0.5})), InvalidEdit) << "only what is selected can be edited";
  session.apply({Operation::deselect, 1, {}, {}, {}});
  EXPECT_LE(session.log().size(), 2u);
  EXPECT_TRUE(session.work({}).finished);
  EXPECT_LT(distance(session.solution()), 1e-10);
  EXPECT_THROW(session.apply({Operation::deselect, 1, {}, {}, {}}), InvalidEdit);
  // What is removed while it is selected is gone.
  session.apply({Operation::select, 2, {}, {}, {}});
  session.work(few);
  session.apply({Operation::remove, 2, {}, {}, {}});
  session.work({});
  EXPECT_FALSE(session.solution().version().slot(2).present);
  EXPECT_LT(distance(session.solution()), 1e-10);
}

TEST(EditSession, WhatASelectedObjectChangesIsErasedWhenItChangesAgain) {
  EditSession session(test_room(), plain());
  session.work({});
  session.apply({Operation::select, 1, {}, {}, {}});
  session.work({});
  const std::vector<double> without = [&] {
    std::vector<double> B = session.solution().element_B();
    const std::vector<double> change = session.temporary_change();
    EXPECT_EQ(B.size(), change.size());
    for (std::size_t i = 0; i < B.size(); ++i) B[i] -= change[i];
    return B;
  }();
  session.apply(moved(1, {0.25, 0.5, 0}));
  EXPECT_THAT(session.temporary_change(), IsEmpty());
  const std::vector<double> now = session.solution().element_B();
  for (std::size_t i = 0; i < now.size(); ++i) ASSERT_NEAR(now[i], without[i], 1e-12);
}

TEST(EditSession, WithoutTheLogWhatWasInterruptedStaysWrong) {
  SessionOptions options = plain();
  options.log = false;
  EditSession session(test_room(), options);
  session.work({});
  Budget few;
  few.shots = 4;
  for (int k = 1; k < 4; ++k) {
    session.apply(moved(1, {0.2 * k, 0.1, 0}));
    session.work(few);
    EXPECT_LE(session.log().size(), 1u) << "only the latest change is redistributed";
  }
  EXPECT_TRUE(session.work({}).finished);
  EXPECT_GT(distance(session.solution()), 1e-4);
}

// 0.1 + 0.2 is an ulp more than 0.3: the sheet lies in the lamp's plane but for rounding, and covers it.
TEST(EditSession, WhatComesToLieOnALampButForRoundingCoversIt) {
  ASSERT_NE(0.1 + 0.2, 0.3);
  Scene scene = test_room();
  Surface lamp;
  lamp.polygon.outer = {{0.2, 0.2, 0.3}, {0.9, 0.2, 0.3}, {0.9, 0.9, 0.3}, {0.2, 0.9, 0.3}};
  lamp.material = 1;
  scene.surfaces.insert(scene.surfaces.begin() + 6, lamp);
  Surface sheet = lamp;
  for (Vec3& v : sheet.polygon.outer) v.z = 0.1;
  sheet.object = static_cast<std::uint32_t>(scene.objects.size());
  sheet.material = 2;
  scene.objects.push_back({"sheet on the lamp", ""});
  scene.surfaces.push_back(sheet);
  for (const SessionOptions& options : {plain(), shooting()}) {
    EditSession session(scene, options);
    session.work({});
    const double before = session.solution().element_B()[0];
    session.apply(moved(sheet.object, {0, 0, 0.2}));
    EXPECT_TRUE(session.work({}).finished);
    EXPECT_LT(distance(session.solution()), 1e-10);
    EXPECT_NE(session.solution().element_B()[0], before);
  }
}

/// Random edits, some of an object that is selected, with few shots after each.
class RandomSession {
 public:
  RandomSession(std::uint64_t seed, const SessionOptions& options) : session(test_room(), options), random_(seed) {}

  void edit() {
    const EditedScene& scene = session.scene();
    const auto selected = scene.selected();
    const std::uint32_t object = 1 + random_.pick(4);
    Edit edit;
    if (selected && random_.pick(4) == 0) {
      edit = {Operation::deselect, *selected, {}, {}, {}};
    } else if (random_.pick(6) == 0 && scene.is_present(object)) {
      edit = {Operation::select, object, {}, {}, {}};
    } else {
      edit = random_.next(scene);
      while (selected && edit.object != *selected) edit = random_.next(scene);
    }
    edits.push_back(edit);
    session.apply(edit);
    Budget budget;
    budget.shots = random_.pick(12) * random_.pick(3);
    session.work(budget);
  }

  EditSession session;
  std::vector<Edit> edits;  ///< so far

 private:
  RandomEdits random_;
};

TEST(EditSession, AHundredRandomEditsOfAnySessionEqualSolvingFromScratch) {
  for (const SessionOptions& options : {plain(), shooting()}) {
    RandomSession random(17, options);
    std::size_t most_pending = 0;
    for (int k = 0; k < 100; ++k) {
      random.edit();
      most_pending = std::max(most_pending, random.session.log().size());
      if (k % 25 != 24) continue;
      EXPECT_TRUE(random.session.work({}).finished);
      EXPECT_LT(distance(random.session.solution()), 1e-10) << "edit " << k;
    }
    EXPECT_GT(most_pending, 5u) << "several changes were open at a time";
  }
}

/// The session as it is written in the middle of a stretch of work, taken up and gone on with.
class TakenUp : public testing::TestWithParam<SessionOptions> {};

TEST_P(TakenUp, GoesOnAsIfNothingHadHappened) {
  const ScratchFolder folder;
  RandomSession random(29, GetParam());
  std::size_t most_pending = 0, held = 0;
  for (int k = 0; k < 40; ++k) {
    random.edit();
    if (k % 4 != 3) continue;
    most_pending = std::max(most_pending, random.session.log().size());
    held += random.session.scene().selected().has_value();
    EditSession whole = random.session;
    Budget budget;
    budget.shots = 5;
    SessionWork first;
    budget.after_shot = [&](const SessionWork& work) {
      first = work;
      if (work.shots() != 2) return;
      ArchiveWriter file(folder / "session.h5", "session");
      whole.write(file, "of_");
      file.publish();
    };
    if (whole.work(budget).shots() < 2) continue;
    const ArchiveReader file(folder / "session.h5", "session");
    EditSession again = EditSession::taken_up(test_room(), GetParam(), random.edits, file, "of_");
    SessionWork so_far;
    so_far.propagations = 2;
    Budget rest;
    rest.shots = first.shots();
    const SessionWork work = again.work(rest, so_far);
    EXPECT_EQ(work.shots(), first.shots());
    EXPECT_EQ(again.solution().element_B(), whole.solution().element_B()) << k;
    EXPECT_EQ(again.solution().unshot(), whole.solution().unshot()) << k;
    EXPECT_EQ(again.solution().has_forgotten(), whole.solution().has_forgotten());
    ASSERT_EQ(again.log().size(), whole.log().size()) << k;
    for (std::size_t c = 0; c < again.log().size(); ++c) {
      EXPECT_EQ(again.log()[c].name, whole.log()[c].name);
      EXPECT_EQ(again.log()[c].largest_energy, whole.log()[c].largest_energy);
    }
    EXPECT_EQ(again.temporary_change(), whole.temporary_change());
    again.work({});
    whole.work({});
    const std::vector<double> B = again.solution().element_B(), of_whole = whole.solution().element_B();
    if (GetParam().object_terms == ObjectTerms::shot) {
      EXPECT_EQ(B, of_whole) << k << ", worked off";
    } else {  // columns that were brought up to date by rows have other last bits than those that are made anew
      EXPECT_THAT(B, Pointwise(DoubleNear(1e-11), of_whole)) << k << ", worked off";
    }
  }
  if (GetParam().method != UpdateMethod::scratch && GetParam().log) {
    EXPECT_GT(most_pending, 2u);
  }
  EXPECT_GT(held, 0u);
}

SessionOptions without_log() {
  SessionOptions options = shooting();
  options.log = false;
  return options;
}

INSTANTIATE_TEST_SUITE_P(
    Sessions, TakenUp,
    testing::Values(plain(), gathering(), shooting(), without_log(),
                    options_with(UpdateMethod::restart, Strategy::interleave, ImportanceOptions::Kind::total),
                    options_with(UpdateMethod::scratch, Strategy::interleave, ImportanceOptions::Kind::total)));

TEST(EditSession, OfOtherEditsIsNotTakenUp) {
  const ScratchFolder folder;
  EditSession session(test_room(), plain());
  const std::vector<Edit> edits = {moved(1, {0.2, 0.1, 0}), moved(2, {-0.1, 0, 0})};
  for (const Edit& edit : edits) session.apply(edit);
  {
    ArchiveWriter file(folder / "session.h5", "session");
    session.write(file, "");
    file.publish();
  }
  const ArchiveReader file(folder / "session.h5", "session");
  EXPECT_THROW(EditSession::taken_up(test_room(), plain(), std::span(edits).first(1), file, ""), DamagedFile);
  SessionOptions finer = plain();
  finer.mesh.patch_size = 1;
  EXPECT_THROW(EditSession::taken_up(test_room(), finer, edits, file, ""), DamagedFile);
  EXPECT_NO_THROW(EditSession::taken_up(test_room(), plain(), edits, file, ""));
}

TEST(EditSession, AnyNumberOfThreadsGivesTheSameBits) {
  const auto run = [](std::size_t threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    RandomSession random(23, plain());
    for (int k = 0; k < 20; ++k) random.edit();
    return random.session.solution().element_B();
  };
  const auto one = run(1);
  EXPECT_EQ(one, run(2));
  EXPECT_EQ(one, run(5));
}

TEST(FrameReferences, ByShotsAreThoseByGathering) {
  EditSession session(test_room(), plain());
  FrameReferences gathers(test_room(), plain(), session.solution(), std::uint64_t{1} << 40),
      shoots(test_room(), plain(), session.solution(), 0, 1e-12);
  ASSERT_TRUE(gathers.gathers());
  ASSERT_FALSE(shoots.gathers());
  const Edit edit = moved(1, {0.5, 0, 0});
  session.apply(edit);
  gathers.apply(edit);
  shoots.apply(edit);
  const auto never = [] { return false; };
  const auto a = gathers.find(session.solution(), never), b = shoots.find(session.solution(), never);
  ASSERT_TRUE(a && b);
  for (std::size_t i = 0; i < a->size(); ++i) ASSERT_NEAR((*a)[i], (*b)[i], 1e-9);
  EXPECT_FALSE(shoots.find(session.solution(), never)->empty());
}

TEST(EditSession, WhatStaysInTheUmbraIsKept) {
  Scene scene = test_room();
  // A box that leaves only a slit below the light hides nearly all of it from the floor, wherever it is shifted to.
  const auto shape = box_surfaces({0.25, 0.25, 2.5}, {2.75, 2.75, 2.75}, 1, 0, false);
  std::copy(shape.begin(), shape.end(), scene.surfaces.begin() + 6);
  EditSession session(std::move(scene), plain());
  session.work({});
  session.apply(moved(1, {0.03125, 0, 0}));
  const SessionWork work = session.work({});
  EXPECT_GT(work.redistribution.kept, 10u);
  EXPECT_LT(distance(session.solution()), 1e-10);
}

std::vector<std::string> trespass_of(const EditedScene& scene, const SceneVersion& version, std::uint32_t object) {
  return find_trespass(scene, version.soup(), version.facet_ranges(), object);
}

TEST(Trespass, SaysWhatNoObjectCanDo) {
  EditedScene scene(test_room());
  const auto said = [&](const Vec3& by) {
    scene.apply(moved(1, by));
    const SceneVersion version(scene, {1.5, 1});
    return trespass_of(scene, version, 1);
  };
  EXPECT_THAT(said({0, 0, 0}), IsEmpty());
  EXPECT_THAT(said({1.25, 0, 0}), IsEmpty()) << "against the wall";
  EXPECT_THAT(said({1.5, 0, 0}), ElementsAre(HasSubstr("passes through 'room'")));
  EXPECT_THAT(said({9, 0, 0}), ElementsAre(HasSubstr("has left the scene")));
  EXPECT_THAT(said({0.5, -0.5, 0}), ElementsAre(HasSubstr("passes through 'L'")));
}

TEST(Trespass, SaysNothingOfAnObjectThatIsAlone) {
  Scene scene = test_room();
  std::erase_if(scene.surfaces, [](const Surface& s) { return s.object != 1; });
  const EditedScene edited(scene);
  EXPECT_THAT(trespass_of(edited, SceneVersion(edited, {1.5, 1}), 1), IsEmpty());
}

// Versions that edits make know where objects are without looking at them all.
TEST(Trespass, SaysTheSameAfterEditsAsOfASceneMadeAnew) {
  RandomEdits random(7);
  EditedScene scene(test_room());
  auto version = std::make_shared<const SceneVersion>(scene, MeshOptions{1.5, 1});
  std::size_t said = 0;
  for (int k = 0; k < 30; ++k) {
    Edit edit = random.next(scene);
    if (k % 3 == 0 && edit.placement) edit.placement->translation = edit.placement->translation + Vec3{1, 0, 0};
    if (k % 7 == 6 && edit.placement) edit.placement->translation = edit.placement->translation + Vec3{9, 0, 0};
    if (!scene.apply(edit).geometry) continue;
    version = std::make_shared<const SceneVersion>(*version, scene, MeshOptions{1.5, 1}, edit.object);
    const auto after = trespass_of(scene, *version, edit.object);
    EXPECT_EQ(after, trespass_of(scene, SceneVersion(scene, {1.5, 1}), edit.object)) << k;
    said += after.size();
  }
  EXPECT_GT(said, 3u);
}

TEST(Trespass, SaysNothingOfWhatHasNoArea) {
  EditedScene scene(test_room());
  Edit edit{Operation::reshape, 1, {}, {}, {}};
  Surface line;
  line.polygon.outer = {{1, 1, 1}, {2, 1, 1}, {1.5, 1, 1}};
  edit.shape = {line};
  scene.apply(edit);
  EXPECT_THAT(trespass_of(scene, SceneVersion(scene, {1.5, 1}), 1), IsEmpty());
}

}  // namespace
}  // namespace exitance
