#include "src/form_factor/visual_events.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <optional>

#include "src/form_factor/edge_event.h"
#include "src/stress/placement.h"
#include "tests/form_factor/hard_pairs.h"

namespace exitance {
namespace {

using Loop = std::vector<Vec3>;

Loop rectangle(double z, double x0, double y0, double x1, double y1) {
  return {{x0, y0, z}, {x1, y0, z}, {x1, y1, z}, {x0, y1, z}};
}
Loop facing_down(Loop loop) {
  std::ranges::reverse(loop);
  return loop;
}

std::vector<std::uint32_t> all_occluders(const PolygonSoup& soup) {
  std::vector<std::uint32_t> items;
  for (std::uint32_t f = 2; f < soup.facets().size(); ++f) {
    if (soup.facets()[f].shell == kNone || !soup.shells()[soup.facets()[f].shell].convex) items.push_back(f);
  }
  for (std::uint32_t s = 0; s < soup.shells().size(); ++s) {
    if (soup.shells()[s].convex) items.push_back(static_cast<std::uint32_t>(soup.facets().size()) + s);
  }
  return items;
}

/// Events whose trace on the plane z = 0 runs along x, at this y; by where they start.
std::vector<std::array<double, 2>> stretches_at(const KnownPair& pair, double y) {
  const PolygonSoup soup = soup_of(pair);
  std::vector<std::array<double, 2>> stretches;
  for (const VisualEvent& e : visual_events(soup, {0, {}}, {1, {}}, all_occluders(soup))) {
    if (std::fabs(e.along.y) > 1e-9) continue;
    const double t = -e.plane.point.z / e.plane.normal.y * e.plane.normal.z;
    if (std::fabs(e.plane.point.y - t - y) > 1e-9) continue;
    std::array ends{e.plane.point.x + e.along.x * e.stretch.from, e.plane.point.x + e.along.x * e.stretch.to};
    std::ranges::sort(ends);
    stretches.push_back(ends);
  }
  std::ranges::sort(stretches);
  return stretches;
}

/// No edge of this source is parallel to one of a plate.
KnownPair past(std::vector<ConvexBody> plates) {
  return {rectangle(0, -4, -4, 4, 4), facing_down({{0, 0, 1}, {1, 0.3, 1}, {0.2, 1, 1}}), std::move(plates)};
}
const ConvexBody kPlate{rectangle(0.5, 0.25, 0.25, 0.75, 0.75)};

/// A plate's edge from x = 0.25 to 0.75 halfway up to a vertex of the source at x = 1 shows from −0.5 to 0.5.
TEST(VisualEvents, MatterWhereALineOfSightRunsThroughWhatMakesThem) {
  const auto open = stretches_at(past({kPlate}), 0.2);
  ASSERT_EQ(open.size(), 1u);
  EXPECT_NEAR(open[0][0], -0.5, 1e-7);
  EXPECT_NEAR(open[0][1], 0.5, 1e-7);
}

/// A second plate under the first, from x = −2, ends where a line of sight from 0.2 meets it, or hides all of the edge.
TEST(VisualEvents, DoNotMatterWhereSomethingElseHidesThem) {
  const auto some = stretches_at(past({kPlate, {rectangle(0.125, -2, -2, 0.3, 3)}}), 0.2);
  ASSERT_EQ(some.size(), 1u);
  EXPECT_NEAR(some[0][0], 0.2, 1e-5);
  EXPECT_NEAR(some[0][1], 0.5, 1e-7);
  EXPECT_TRUE(stretches_at(past({kPlate, {rectangle(0.125, -2, -2, 3, 3)}}), 0.2).empty());
}

/// A box hangs from the source's plane: a vertex that touches the source is seen against it past an edge below,
/// wherever that is seen.
TEST(VisualEvents, OfAVertexThatTouchesTheSourceMatterAllAlong) {
  const Vec3 vertex{0.75, 0.25, 1};
  for (const Vec3& turn : {Vec3{}, Vec3{0.125, -0.25, 0}}) {
    const KnownPair pair{rectangle(0, -4, -4, 4, 4),
                         facing_down({{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}),
                         {{{vertex, vertex + Vec3{-0.5, 0, 0}, vertex + Vec3{-0.25, 0.125, -0.125}}},
                          {{Vec3{-3, -1, 0.5}, Vec3{3, 0.25, 0.5} + turn, Vec3{3, -2, 0.5}}}}};
    const PolygonSoup soup = soup_of(pair);
    const CutPlane expected{cross(pair.occluders[1][0][0] - vertex, pair.occluders[1][0][1] - vertex), vertex};
    const std::vector<VisualEvent> events = visual_events(soup, {0, {}}, {1, {}}, all_occluders(soup));
    // The edge's trace from the vertex: wherever a line through the vertex meets the edge first.
    EXPECT_TRUE(std::ranges::any_of(events, [&](const VisualEvent& e) {
      const auto lies_on = [&](const Vec3& foot) {
        const double t = dot(e.along, foot - e.plane.point);
        return std::fabs(e.plane.at(foot)) < 1e-12 && t >= e.stretch.from && t <= e.stretch.to;
      };
      const auto foot = [&](double share) {
        const Vec3 at = pair.occluders[1][0][0] + share * (pair.occluders[1][0][1] - pair.occluders[1][0][0]);
        return vertex + 2.0 * (at - vertex);
      };
      return lies_on(foot(0.4)) && lies_on(foot(0.6)) &&
             norm(cross(e.plane.normal, expected.normal)) < 1e-12 * norm(e.plane.normal) * norm(expected.normal);
    }));
  }
}

/// The first two outlines between these points that differ, next to each other; nothing if they agree at both ends.
struct Change {
  Vec3 here, there;
  std::vector<SeenEdge> from_here, from_there;
};

class Observer {
 public:
  explicit Observer(const PolygonSoup& soup) : soup_(soup), items_(all_occluders(soup)), view_(soup) {}

  std::optional<Change> change_between(Vec3 here, Vec3 there) {
    const std::uint64_t first = outline(here);
    if (outline(there) == first) return {};
    for (int k = 0; k < 20; ++k) {
      const Vec3 middle = here + 0.5 * (there - here);
      (outline(middle) == first ? here : there) = middle;
    }
    return Change{here, there, edges(here), edges(there)};
  }
  std::vector<VisualEvent> events() const { return visual_events(soup_, {0, {}}, {1, {}}, items_); }

 private:
  std::uint64_t outline(const Vec3& x) {
    view_.look_from({x, soup_.facets()[0].plane.normal, 0});
    return view_.form_factor({1, {}}, items_, 1).side == Side::front ? view_.outline() : 0;
  }
  std::vector<SeenEdge> edges(const Vec3& x) { return outline(x) != 0 ? view_.seen_edges() : std::vector<SeenEdge>{}; }

  const PolygonSoup& soup_;
  std::vector<std::uint32_t> items_;
  Viewpoint view_;
};

bool explains(const VisualEvent& event, const Change& c) {
  const double here = event.plane.at(c.here), there = event.plane.at(c.there),
               near = 1e-4 * norm(event.plane.normal) * norm(c.there - c.here);
  if (here * there > 0 && std::min(std::fabs(here), std::fabs(there)) > near) return false;
  const double t = dot(event.along, c.here - event.plane.point), slack = norm(c.there - c.here);
  return t >= event.stretch.from - slack && t <= event.stretch.to + slack;
}

/// Wherever the outline changes from one point to the next, an event that was kept is the reason, or one of three edges
/// that no straight line knows of, or one at the horizon.
TEST(VisualEvents, NoneIsLeftOutThatChangesWhatIsSeen) {
  int changes = 0, curved = 0;
  for (const std::string_view family : {"boxes", "thin", "slivers", "plates", "rooms"}) {
    for (int number = 0; number < 40; ++number) {
      // Where turned rooms are in contact, rounding tells what is seen.
      if (family == "rooms" && number % 2 != 0) continue;
      const KnownPair pair = hard_pair(family, number);
      const PolygonSoup soup = soup_of(pair);
      // Receiver and source as facets 0 and 1.
      if (soup.first_facet(1) != 1 || soup.first_facet(2) != 2) continue;
      Observer observer(soup);
      const std::vector<VisualEvent> events = observer.events();
      const Loop& loop = pair.receiver;
      Random random("visual events " + std::string(family) + std::to_string(number));
      const auto place = [&] {
        double s = random.real(0.01, 0.99), t = random.real(0.01, 0.99);
        if (loop.size() == 3 && s + t > 1) s = 1 - s, t = 1 - t;
        return loop[0] + s * (loop[1] - loop[0]) + t * (loop.back() - loop[0]);
      };
      for (int k = 0; k < 30; ++k) {
        const std::optional<Change> change = observer.change_between(place(), place());
        if (!change) continue;
        ++changes;
        if (std::ranges::any_of(events, [&](const VisualEvent& e) { return explains(e, *change); })) continue;
        const auto by_three = events_between(change->from_here, change->from_there);
        const Plane& receiver = soup.facets()[0].plane;
        const auto at_horizon = [&](const EdgeEvent& e) {
          return std::fabs(dot(receiver.normal, e.plane()->point - receiver.origin)) < 1e-12 * norm(receiver.normal);
        };
        EXPECT_TRUE(std::ranges::any_of(by_three,
                                        [&](const EdgeEvent& e) {
                                          return (!e.plane() || at_horizon(e)) &&
                                                 e.at(change->here) * e.at(change->there) <= 0;
                                        }))
            << family << ' ' << number << " from " << change->here.x << ' ' << change->here.y << ' ' << change->here.z;
        ++curved;
      }
    }
  }
  EXPECT_GT(changes, 500);
  EXPECT_LT(curved, changes / 4);
}

}  // namespace
}  // namespace exitance
