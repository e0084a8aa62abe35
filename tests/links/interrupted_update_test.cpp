// Updates that end before all is done: by a limit, and go on later, or by an exception, and leave what was.

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <limits>
#include <stdexcept>

#include "src/scene/input_error.h"
#include "src/scene/scene_file.h"
#include "tests/links/linked_rooms.h"
#include "tests/places.h"

namespace exitance {
namespace {

/// Ends after so many questions.
LinkInterruption after(int questions, LinkOrder order = LinkOrder::importance) {
  return {[questions]() mutable { return questions-- <= 0; }, order, {}};
}

/// Of links that are in both and active or in shadow in either. How many there are.
std::size_t expect_same_values_of_shared(const LinkIndex& a, const LinkIndex& b) {
  std::size_t shared = 0;
  for (std::uint32_t r = 0; r < a.roots(); ++r) {
    a.for_each_source(r, [&](std::uint32_t source, std::span<const Link> x) {
      const auto y = b.between(r, source);
      for (const Link& link : x) {
        const auto same = std::ranges::lower_bound(y, link.code, {}, &Link::code);
        if (link.ghost || same == y.end() || same->code != link.code || same->ghost) continue;
        EXPECT_EQ(same->form_factor, link.form_factor);
        EXPECT_EQ(same->visibility, link.visibility);
        ++shared;
      }
    });
  }
  return shared;
}

/// A stored scene with many patches and few links.
struct Stored {
  DynamicScene given = read_dynamic_scene(source_file("data/cube.toml"), Emission::exitance);
  LinkOptions options = coarse();

  Stored() {
    options.mesh.patch_size = 1;
    options.smallest_area = 0.1;
    options.eps2 = 0.1;
    options.eps1 = 0.05;
  }
  std::vector<Edit> edits(std::size_t event) const { return {given.events[event].edit}; }
};

/// What links bring at most is as exact as B is, which may have been exchanged in other parts.
void expect_same_links(const LinkIndex& a, const LinkIndex& b) {
  ASSERT_EQ(a.roots(), b.roots());
  for (std::uint32_t r = 0; r < a.roots(); ++r) {
    const auto x = a.of_receiver(r), y = b.of_receiver(r);
    ASSERT_EQ(x.size(), y.size());
    for (std::size_t k = 0; k < x.size(); ++k) {
      ASSERT_EQ(x[k].code, y[k].code);
      ASSERT_EQ(x[k].ghost, y[k].ghost);
      ASSERT_EQ(x[k].stale, y[k].stale);
      ASSERT_EQ(x[k].form_factor, y[k].form_factor);
      ASSERT_EQ(x[k].visibility, y[k].visibility);
      ASSERT_NEAR(x[k].energy, y[k].energy, 1e-6);
    }
  }
}

TEST(InterruptedUpdate, LeavesWhenContinuedWhatTheWholeOneLeaves) {
  const Stored stored;
  for (const LinkMethod method : {LinkMethod::direct, LinkMethod::hvt}) {
    LinkedRadiosity whole(stored.given.scene, stored.options), parts(stored.given.scene, stored.options);
    whole.build();
    parts.build();
    for (std::size_t event = 0; event < stored.given.events.size(); ++event) {
      SCOPED_TRACE(event);
      const LinkUpdate all = whole.update(stored.edits(event), method);
      EXPECT_EQ(all.pairs_left, 0u);
      LinkUpdate part = parts.update(stored.edits(event), method, after(2));
      EXPECT_GT(part.pairs_left, 0u);
      EXPECT_FALSE(same_bits(whole.links(), parts.links()));
      std::uint64_t updated = part.work.links_updated, before = part.pairs_left;
      part = parts.work_off(after(3, LinkOrder::index));
      EXPECT_LT(part.pairs_left, before);
      updated += part.work.links_updated;
      part = parts.work_off();
      updated += part.work.links_updated;
      EXPECT_EQ(part.pairs_left, 0u);
      EXPECT_EQ(updated, all.work.links_updated);
      EXPECT_EQ(parts.work_off().work.links_updated, 0u);
      EXPECT_EQ(part.exchange.iterations, all.exchange.iterations);
      EXPECT_TRUE(same_bits(whole.radiosity().B(), parts.radiosity().B()));
      EXPECT_TRUE(same_bits(whole.links(), parts.links()));
    }
  }
}

// Links of what goes, comes to other places and shines anew, at once, of which the last are looked at last.
TEST(InterruptedUpdate, OfSeveralThingsLeavesInTheEndWhatTheWholeOneLeaves) {
  std::vector<Edit> edits{move_to(1, {0.4, 0.2, 0}), {Operation::remove, 3, {}, {}, {}}};
  edits.push_back({Operation::change, 2, {}, {}, {{MaterialChange::kEvery, 4}}});
  for (const LinkMethod method : {LinkMethod::direct, LinkMethod::hvt}) {
    LinkedRadiosity whole(room_with_things(), coarse()), parts(room_with_things(), coarse());
    whole.build();
    parts.build();
    whole.update(edits, method);
    LinkUpdate part = parts.update(edits, method, after(0));
    EXPECT_GT(part.pairs_left, 0u);
    while (part.pairs_left > 0) {
      EXPECT_FALSE(same_bits(whole.radiosity().B(), parts.radiosity().B()));
      part = parts.work_off(after(1));
    }
    EXPECT_TRUE(same_bits(whole.radiosity().B(), parts.radiosity().B()));
    EXPECT_TRUE(same_bits(whole.links(), parts.links()));
  }
}

TEST(InterruptedUpdate, ByProgressiveEnergyUpdateComesNearTheWholeOne) {
  Stored stored;
  stored.options.B_eps = 0;
  LinkedRadiosity whole(stored.given.scene, stored.options), parts(stored.given.scene, stored.options);
  whole.build();
  parts.build();
  for (std::size_t event = 0; event < stored.given.events.size(); ++event) {
    whole.update(stored.edits(event), LinkMethod::hvt_peu);
    EXPECT_GT(parts.update(stored.edits(event), LinkMethod::hvt_peu, after(2)).pairs_left, 0u);
    parts.work_off();
    EXPECT_LT(error_of(parts), 1e-6);
    const auto elements = whole.elements();
    EXPECT_LT(
        link_error(whole.tree(), elements, whole.radiosity().bands(), whole.radiosity().B(), {}, parts.radiosity().B())
            .all,
        1e-6);
  }
}

// Each part by one question, of things that move, come, and change their light, alone and at once. What is skipped is
// known in the end, whichever part skipped it, and new light counts as if it had not come in parts.
TEST(InterruptedUpdate, ByProgressiveEnergyUpdateSkipsWhatTheWholeOneSkips) {
  LinkOptions options = coarse();
  options.B_eps = 0.02;
  const Edit box = move_to(1, {0.4, 0.2, 0}), shelf_stays = move_to(3, {0, 0, 0});
  const Edit lamp_goes{Operation::remove, 2, {}, {}, {}}, lamp_comes{Operation::add, 2, {}, {}, {}};
  const Edit lamp_off{Operation::change, 2, {}, {}, {{MaterialChange::kEvery, 4}}};
  const Edit lamp_on{Operation::change, 2, {}, {}, {{MaterialChange::kEvery, 3}}};
  const std::vector<std::pair<std::vector<Edit>, std::vector<Edit>>> cases = {
      {{}, {box}}, {{lamp_goes}, {lamp_comes}}, {{lamp_off}, {box, lamp_on}}, {{box, lamp_on}, {lamp_off}}};
  for (std::size_t of = 0; of < cases.size(); ++of) {
    SCOPED_TRACE(of);
    const auto& [first, edits] = cases[of];
    LinkedRadiosity whole(room_with_things(), options), parts(room_with_things(), options);
    for (LinkedRadiosity* links : {&whole, &parts}) {
      links->build();
      if (!first.empty()) links->update(first, LinkMethod::hvt);
    }
    whole.update(edits, LinkMethod::hvt_peu);
    LinkUpdate part = parts.update(edits, LinkMethod::hvt_peu, after(0));
    EXPECT_GT(part.pairs_left, 0u);
    while (part.pairs_left > 0) part = parts.work_off(after(1));
    expect_same_links(whole.links(), parts.links());
    EXPECT_LT(error_of(whole), 0.05);
    EXPECT_NEAR(error_of(parts), error_of(whole), 1e-6);
    parts.update({&shelf_stays, 1}, LinkMethod::hvt);
    EXPECT_LT(error_of(parts), 1e-6);
  }
}

// What is left when another edit comes is stale and found by it. Which links are refined follows the B that there was
// at each edit; what they bring does not.
TEST(InterruptedUpdate, IsWorkedOffByLaterUpdates) {
  const Stored stored;
  for (const LinkMethod method : {LinkMethod::direct, LinkMethod::hvt, LinkMethod::hvt_peu}) {
    LinkOptions options = stored.options;
    options.B_eps = 0;
    LinkedRadiosity whole(stored.given.scene, options), parts(stored.given.scene, options);
    whole.build();
    parts.build();
    for (std::size_t event = 0; event < stored.given.events.size(); ++event) {
      whole.update(stored.edits(event), method);
      const bool last = event + 1 == stored.given.events.size();
      parts.update(stored.edits(event), method, last ? LinkInterruption{} : after(1));
      EXPECT_EQ(error_of(parts) < 1e-6, last) << event;
    }
    const std::vector<std::uint8_t> moves(stored.given.scene.objects.size());
    const LinkCounts counts = whole.links().count(whole.tree(), moves);
    EXPECT_EQ(parts.links().count(parts.tree(), moves).patch_pairs, counts.patch_pairs);
    EXPECT_GT(expect_same_values_of_shared(whole.links(), parts.links()), counts.links() / 2);
  }
}

// The same number of links, or more, in the order of the index: what matters most is not yet done then.
TEST(InterruptedUpdate, HasDoneTheMostImportantPart) {
  const Stored stored;
  LinkedRadiosity whole(stored.given.scene, stored.options);
  whole.build();
  const std::vector<double> before(whole.radiosity().B().begin(), whole.radiosity().B().end());
  const std::uint64_t all = whole.update(stored.edits(0), LinkMethod::hvt).work.links_updated;
  const auto elements = whole.elements();
  const auto error = [&](const LinkedRadiosity& links) {
    return link_error(whole.tree(), elements, whole.radiosity().bands(), whole.radiosity().B(), before,
                      links.radiosity().B())
        .all;
  };
  const auto interrupted = [&](int questions, LinkOrder order) {
    auto links = std::make_unique<LinkedRadiosity>(stored.given.scene, stored.options);
    links->build();
    const LinkUpdate update = links->update(stored.edits(0), LinkMethod::hvt, after(questions, order));
    return std::pair(error(*links), update.work.links_updated);
  };
  const auto [by_importance, links] = interrupted(6, LinkOrder::importance);
  EXPECT_LT(links, all / 2);
  for (int questions = 1;; ++questions) {
    const auto [by_index, as_many] = interrupted(questions, LinkOrder::index);
    if (as_many < links) continue;
    EXPECT_LT(by_importance, by_index) << links << " and " << as_many << " of " << all;
    break;
  }
}

TEST(InterruptedUpdate, InAnyOrderLeavesTheSameInTheEnd) {
  const Stored stored;
  for (const LinkMethod method : {LinkMethod::direct, LinkMethod::hvt, LinkMethod::hvt_peu}) {
    LinkedRadiosity whole(stored.given.scene, stored.options), parts(stored.given.scene, stored.options);
    whole.build();
    parts.build();
    for (std::size_t event = 0; event < stored.given.events.size(); ++event) {
      const LinkUpdate all = whole.update(stored.edits(event), method);
      std::atomic<int> questions = 20;
      const LinkInterruption early{[&] { return questions-- <= 0; }, LinkOrder::any, {}};
      const LinkUpdate part = parts.update(stored.edits(event), method, early);
      EXPECT_GT(part.pairs_left, 0u);
      EXPECT_GT(part.work.links_updated, 0u);
      EXPECT_LT(part.work.links_updated, all.work.links_updated);
      const LinkUpdate rest = parts.work_off({[] { return false; }, LinkOrder::any, {}});
      EXPECT_EQ(rest.pairs_left, 0u);
      expect_same_links(whole.links(), parts.links());
      if (method == LinkMethod::hvt_peu) continue;  // its shots come in other parts
      EXPECT_TRUE(same_bits(whole.radiosity().B(), parts.radiosity().B()));
      EXPECT_TRUE(same_bits(whole.links(), parts.links()));
    }
  }
}

TEST(InterruptedUpdate, RebuildingEndsEarlyAsBuildingDoes) {
  LinkedRadiosity links(room_with_things(), coarse()), whole(room_with_things(), coarse());
  links.build();
  const Edit box = move_to(1, {0.4, 0.2, 0});
  EXPECT_TRUE(links.update({&box, 1}, LinkMethod::rebuild, {[] { return true; }, {}, {}}).stopped);
  EXPECT_FALSE(links.update({&box, 1}, LinkMethod::rebuild, {[] { return false; }, {}, {}}).stopped);
  whole.build();
  whole.update({&box, 1}, LinkMethod::rebuild);
  EXPECT_TRUE(same_bits(links.links(), whole.links()));
}

/// Everything that can be seen of a solution.
struct Seen {
  explicit Seen(const LinkedRadiosity& of)
      : links(of.links()), B(of.radiosity().B().begin(), of.radiosity().B().end()) {}

  LinkIndex links;
  std::vector<double> B;
};

TEST(InterruptedUpdate, ByAnExceptionLeavesWhatWas) {
  for (const LinkMethod method : {LinkMethod::direct, LinkMethod::hvt, LinkMethod::hvt_peu, LinkMethod::rebuild}) {
    LinkOptions options = coarse();
    options.mesh.memory_limit = 1 << 26;
    LinkedRadiosity links(room_with_things(), options), never_failed(room_with_things(), options);
    links.build();
    never_failed.build();
    const Seen before(links);
    const auto unchanged = [&] {
      return same_bits(before.links, links.links()) && same_bits(before.B, links.radiosity().B()) &&
             links.scene().is_present(2);
    };
    std::vector<Edit> edits{move_to(1, {0.4, 0.2, 0}), {Operation::remove, 2, {}, {}, {}}};
    edits.push_back({Operation::change, 1, {}, {}, {{MaterialChange::kEvery, 4}}});

    edits.push_back({Operation::add, 3, {}, {}, {}});  // is there
    EXPECT_THROW(links.update(edits, method), InvalidEdit);
    EXPECT_TRUE(unchanged());
    edits.pop_back();

    Edit vast{Operation::reshape, 3, {}, box_faces({-1e4, -1e4, -1e4}, {1e4, 1e4, 1e4}, 2, 3), {}};
    edits.push_back(vast);  // its sub-patches have no room
    EXPECT_THROW(links.update(edits, method), LimitError);
    EXPECT_TRUE(unchanged());
    edits.pop_back();

    if (method != LinkMethod::rebuild) {
      LinkInterruption failing;
      failing.stop = [questions = 2]() mutable -> bool {
        if (questions-- == 0) throw std::runtime_error("failed");
        return false;
      };
      EXPECT_THROW(links.update(edits, method, failing), std::runtime_error);
      EXPECT_TRUE(unchanged());
    }

    links.update(edits, method);
    never_failed.update(edits, method);
    EXPECT_TRUE(same_bits(links.links(), never_failed.links()));
    EXPECT_TRUE(same_bits(links.radiosity().B(), never_failed.radiosity().B()));
  }
}

// While pairs are sought, links are found and energy is exchanged: where it is asked for the k-th time.
TEST(InterruptedUpdate, AbandonedAnywhereLeavesWhatWas) {
  const Edit box = move_to(1, {0.4, 0.2, 0});
  for (const LinkMethod method : {LinkMethod::direct, LinkMethod::hvt, LinkMethod::hvt_peu, LinkMethod::rebuild}) {
    for (const LinkOrder order : {LinkOrder::importance, LinkOrder::any}) {
      SCOPED_TRACE(static_cast<int>(method));
      LinkedRadiosity links(room_with_things(), coarse()), never_abandoned(room_with_things(), coarse());
      links.build();
      never_abandoned.build();
      const Seen before(links);
      int k = 0;
      for (bool done = false; !done; k += k / 2 + 1) {
        std::atomic<int> asked = 0;
        try {
          links.update({&box, 1}, method, {[] { return false; }, order, [&] { return asked++ == k; }});
          done = true;
        } catch (const Abandoned&) {
          ASSERT_TRUE(same_bits(before.links, links.links()) && same_bits(before.B, links.radiosity().B())) << k;
        }
      }
      EXPECT_GT(k, 30);
      never_abandoned.update({&box, 1}, method, {[] { return false; }, order, {}});
      EXPECT_TRUE(same_bits(links.links(), never_abandoned.links()));
      EXPECT_TRUE(same_bits(links.radiosity().B(), never_abandoned.radiosity().B()));
    }
  }
}

}  // namespace
}  // namespace exitance
