// Soups that edits make from one another, against soups of the same polygons made afresh.

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <random>
#include <vector>

#include "geometry/polygon_soup.h"
#include "geometry/viewpoint.h"
#include "tests/geometry/solids.h"

namespace exitance {
namespace {

using Rank = PolygonSoup::Rank;
using Range = PolygonSoup::PolygonRange;

/// The objects that are there, with their polygons; in order of their numbers.
struct Objects {
  std::vector<std::optional<Faces>> faces;

  struct List {
    Faces polygons;
    std::vector<Role> roles;
    std::vector<Rank> ranks;
    std::vector<Range> of_object;
    PolygonSoup::Arrival arrival() const { return {polygons, roles, ranks}; }
  };
  List list(std::uint32_t first, std::uint32_t last) const {
    List list;
    for (std::uint32_t k = first; k < last; ++k) {
      const auto from = static_cast<std::uint32_t>(list.polygons.size());
      for (std::size_t i = 0; faces[k] && i < faces[k]->size(); ++i) {
        list.polygons.push_back((*faces[k])[i]);
        list.roles.push_back(Role::patch);
        list.ranks.push_back((Rank{k} << 32) + i);
      }
      list.of_object.push_back({from, static_cast<std::uint32_t>(list.polygons.size())});
    }
    return list;
  }
  List all() const { return list(0, static_cast<std::uint32_t>(faces.size())); }
};

PolygonSoup fresh(const Objects::List& list, Planes planes = Planes::as_written) {
  return PolygonSoup(list.polygons, list.roles, list.ranks, 400, planes);
}

/// One soup's facets in another, of the same objects.
std::vector<std::uint32_t> facet_map(const PolygonSoup& from, const std::vector<Range>& in_from, const PolygonSoup& to,
                                     const std::vector<Range>& in_to) {
  std::vector<std::uint32_t> map(from.facets().size(), kNone);
  for (std::size_t k = 0; k < in_from.size(); ++k) {
    if (in_from[k].first == in_from[k].last) continue;
    const std::uint32_t a = from.first_facet(in_from[k].first), b = to.first_facet(in_to[k].first);
    const std::uint32_t count = from.first_facet(in_from[k].last) - a;
    EXPECT_EQ(count, to.first_facet(in_to[k].last) - b);
    for (std::uint32_t i = 0; i < count; ++i) map[a + i] = b + i;
  }
  return map;
}

std::vector<std::uint32_t> found_in(const PolygonSoup& soup, const Box& box) {
  std::vector<std::uint32_t> items, found;
  soup.index().find(box, items);
  for (const std::uint32_t item : items) {
    if (item < soup.facets().size()) {
      found.push_back(item);
    } else {
      const auto& facets = soup.shells()[item - soup.facets().size()].facets;
      found.insert(found.end(), facets.begin(), facets.end());
    }
  }
  std::erase_if(found, [&](std::uint32_t f) {
    Box own;
    for (const Corner& c : soup.corners(soup.facets()[f])) own.extend(c.at);
    return !own.overlaps(box);
  });
  std::ranges::sort(found);
  return found;
}

void expect_same(const PolygonSoup& edited, const PolygonSoup& made_anew, const std::vector<std::uint32_t>& map,
                 std::mt19937& random) {
  const auto mapped = [&](std::span<const std::uint32_t> facets) {
    std::vector<std::uint32_t> result;
    for (const std::uint32_t f : facets) result.push_back(map[f]);
    std::ranges::sort(result);
    return result;
  };
  std::uniform_real_distribution<double> place(0, 4);
  for (std::uint32_t f = 0; f < map.size(); ++f) {
    ASSERT_EQ(edited.is_present(f), map[f] != kNone);
    if (map[f] == kNone) continue;
    const Facet &a = edited.facets()[f], &b = made_anew.facets()[map[f]];
    ASSERT_EQ(a.count, b.count);
    for (std::uint32_t k = 0; k < a.count; ++k) {
      ASSERT_EQ(edited.corners(a)[k].at, made_anew.corners(b)[k].at);
      const std::uint32_t n = edited.corners(a)[k].neighbour;
      ASSERT_EQ(n == kNone ? kNone : map[n], made_anew.corners(b)[k].neighbour);
    }
    ASSERT_EQ(a.shell == kNone, b.shell == kNone);
    if (a.shell != kNone) {
      ASSERT_EQ(edited.shells()[a.shell].convex, made_anew.shells()[b.shell].convex);
      ASSERT_EQ(mapped(edited.shells()[a.shell].facets), made_anew.shells()[b.shell].facets);
    }
    const auto there = made_anew.coplanar(map[f]);
    ASSERT_EQ(mapped(edited.coplanar(f)), std::vector<std::uint32_t>(there.begin(), there.end()));
    ASSERT_TRUE(std::ranges::is_sorted(edited.coplanar(f)));
    for (const std::uint32_t t : edited.coplanar(f)) {
      ASSERT_EQ(edited.covers(t, f), made_anew.covers(map[t], map[f]));
      ASSERT_EQ(edited.covers_back(t, f), made_anew.covers_back(map[t], map[f]));
    }
  }
  for (int k = 0; k < 20; ++k) {
    Box box;
    box.extend(Vec3{place(random), place(random), place(random)});
    box.extend(Vec3{place(random), place(random), place(random)});
    ASSERT_EQ(mapped(found_in(edited, box)), found_in(made_anew, box));
  }
  Viewpoint from_edited(edited), from_anew(made_anew);
  for (int k = 0; k < 3; ++k) {
    const Receiver receiver{{place(random), place(random), place(random)}, {place(random) - 2, place(random) - 2, 1}};
    from_edited.look_from(receiver);
    from_anew.look_from(receiver);
    for (std::uint32_t f = 0; f < map.size(); ++f) {
      if (map[f] == kNone) continue;
      const PointFormFactor a = from_edited.form_factor({f, {}}), b = from_anew.form_factor({map[f], {}});
      ASSERT_EQ(a.side, b.side);
      ASSERT_LE(std::abs(a.F - b.F), a.error + b.error);
    }
  }
}

Faces placed(const Faces& faces, double turn, const Vec3& to) {
  Faces result = faces;
  for (Polygon& face : result) {
    for (Vec3& p : face.outer)
      p = Vec3{std::cos(turn) * p.x - std::sin(turn) * p.y, std::sin(turn) * p.x + std::cos(turn) * p.y, p.z} + to;
  }
  return result;
}

/// About the axis of x.
Faces tilted(Faces faces, double angle) {
  for (Polygon& face : faces) {
    for (Vec3& p : face.outer)
      p = {p.x, std::cos(angle) * p.y - std::sin(angle) * p.z, std::sin(angle) * p.y + std::cos(angle) * p.z};
  }
  return faces;
}

/// A room 4 × 4 × 4 (object 0), an open cover (a box without its bottom, 1), a table (2) on its floor, and four solids
/// that come and go: two boxes, an L, a vase.
class EditedRoom : public testing::Test {
 protected:
  EditedRoom() {
    Faces room = prism({{0, 0}, {4, 0}, {4, 4}, {0, 4}}, 0, 4);
    for (Polygon& face : room) std::ranges::reverse(face.outer);
    const Faces table = placed(prism({{0, 0}, {1, 0}, {1, 1}, {0, 1}}, 0, 1), 0, {1.5, 1.5, 0});
    objects_.faces = {room, std::nullopt, table, std::nullopt, std::nullopt, std::nullopt, std::nullopt};
  }

  Faces shape(std::uint32_t object) const {
    const Faces box = prism({{0, 0}, {1, 0}, {1, 1}, {0, 1}}, 0, 1);
    if (object == 1) return Faces(box.begin() + 1, box.end());
    if (object == 5) return prism({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}, 0, 1);
    if (object == 6) return vase(5, 3, 0);
    return box;
  }

  /// On the floor, on the table's top, or in the air; on the lattice or turned; in other things, too.
  Faces random_place(std::uint32_t object, std::mt19937& random) const {
    std::uniform_real_distribution<double> anywhere(0.6, 3);
    std::uniform_int_distribution<int> choice(0, 2);
    const int how = choice(random);
    const double z = how == 0 ? 0 : how == 1 ? 1 : anywhere(random);
    Vec3 to{anywhere(random), anywhere(random), z};
    const bool on_lattice = choice(random) == 0;
    if (on_lattice) to = {0.5 * std::floor(2 * to.x), 0.5 * std::floor(2 * to.y), z};
    Faces faces = placed(shape(object), on_lattice ? 0 : anywhere(random), {});
    for (Polygon& face : faces) {
      for (Vec3& p : face.outer) p = 0.5 * p + to;
    }
    return faces;
  }

  void expect_edits_to_equal_those_made_anew(std::uint32_t seed, Planes planes, double tilt) const {
    std::mt19937 random(seed);
    Objects objects = objects_;
    for (auto& faces : objects.faces) {
      if (faces) faces = tilted(*faces, tilt);
    }
    Objects::List all = objects.all();
    std::optional<PolygonSoup> soup(fresh(all, planes));
    std::vector<Range> ranges = all.of_object;
    int shared = 0;
    for (int k = 0; k < 40; ++k) {
      const std::uint32_t object = std::uniform_int_distribution<std::uint32_t>(1, 6)(random);
      if (object == 2) continue;
      const bool goes = objects.faces[object] && std::uniform_int_distribution<int>(0, 3)(random) == 0;
      objects.faces[object] = goes ? std::nullopt : std::optional(tilted(random_place(object, random), tilt));
      all = objects.all();
      PolygonSoup anew = fresh(all, planes);
      auto edited = PolygonSoup::edited(*soup, ranges[object], objects.list(object, object + 1).arrival());
      if (!edited) {
        soup.emplace(std::move(anew));
        ranges = all.of_object;
        continue;
      }
      ++shared;
      EXPECT_TRUE(edited->shares_with(*soup));
      soup.emplace(std::move(*edited));
      ranges[object] = soup->arrived();
      const auto map = facet_map(*soup, ranges, anew, all.of_object);
      expect_same(*soup, anew, map, random);
      if (HasFatalFailure()) FAIL() << "seed " << seed << ", edit " << k;
    }
    EXPECT_GE(shared, 10);
  }

  Objects objects_;
};

TEST_F(EditedRoom, EqualsOneMadeAnewAfterRandomEdits) {
  for (const std::uint32_t seed : {1u, 2u, 3u}) expect_edits_to_equal_those_made_anew(seed, Planes::as_written, 0);
}

TEST_F(EditedRoom, EqualsOneMadeAnewWhereItIsTurned) {
  for (const std::uint32_t seed : {4u, 5u, 6u})
    expect_edits_to_equal_those_made_anew(seed, Planes::rounded, 0.3 + 0.1 * seed);
}

/// Two edits of one soup know nothing of each other, and the soup stays as it was.
TEST_F(EditedRoom, BranchesAreIndependent) {
  const Objects::List all = objects_.all();
  const PolygonSoup base = fresh(all);
  Objects one = objects_, other = objects_;
  one.faces[3] = placed(shape(3), 0.3, {0.5, 0.5, 2});
  other.faces[4] = placed(shape(4), 0.4, {0.5, 0.5, 2.2});
  auto first = PolygonSoup::edited(base, {}, one.list(3, 4).arrival());
  auto second = PolygonSoup::edited(base, {}, other.list(4, 5).arrival());
  ASSERT_TRUE(first && second);
  std::mt19937 random(1);
  const auto check = [&](const PolygonSoup& soup, std::vector<Range> ranges, const Objects& objects) {
    const Objects::List list = objects.all();
    const PolygonSoup anew = fresh(list);
    expect_same(soup, anew, facet_map(soup, ranges, anew, list.of_object), random);
  };
  std::vector<Range> ranges = all.of_object;
  check(base, ranges, objects_);
  ranges[3] = first->arrived();
  check(*first, ranges, one);
  ranges = all.of_object;
  ranges[4] = second->arrived();
  check(*second, ranges, other);
}

/// What soups that are gone have brought, and those that were given up, makes room for others; what is left is as it
/// was.
TEST_F(EditedRoom, SoupsThatAreGoneMakeRoomForOthers) {
  const Objects::List all = objects_.all();
  const PolygonSoup base = fresh(all);
  Objects kept = objects_;
  kept.faces[3] = placed(shape(3), 0.3, {0.5, 0.5, 2});
  const auto first = PolygonSoup::edited(base, {}, kept.list(3, 4).arrival());
  ASSERT_TRUE(first);
  std::mt19937 random(1);
  const auto check = [&](const PolygonSoup& soup, std::uint32_t object, const Objects& objects) {
    const Objects::List list = objects.all();
    std::vector<Range> ranges = all.of_object;
    if (object != 0) ranges[object] = soup.arrived();
    const PolygonSoup anew = fresh(list);
    expect_same(soup, anew, facet_map(soup, ranges, anew, list.of_object), random);
  };
  Objects moved = objects_;
  std::size_t facets = 0;
  for (int k = 0; k < 300; ++k) {
    moved.faces[4] = placed(shape(4), 0.01 * k, {0.5, 0.5, 2.2});
    facets += moved.faces[4]->size();
    const auto soup = PolygonSoup::edited(base, {}, moved.list(4, 5).arrival());
    ASSERT_TRUE(soup) << k;
    if (k % 100 == 99) check(*soup, 4, moved);
  }
  EXPECT_GT(facets, 800u) << "more than there is room for";
  check(*first, 3, kept);
  check(base, 0, objects_);
}

TEST_F(EditedRoom, MustBeMadeAnewWhereAnEditConcernsOthers) {
  const PolygonSoup base = fresh(objects_.all());
  const auto comes = [&](std::uint32_t object, const Faces& faces) {
    Objects objects = objects_;
    objects.faces[object] = faces;
    return PolygonSoup::edited(base, {}, objects.list(object, object + 1).arrival()).has_value();
  };
  EXPECT_TRUE(comes(3, placed(shape(3), 0.3, {0.5, 0.5, 1})));
  EXPECT_TRUE(comes(3, placed(shape(3), 0.3, {0.5, 0.5, 0})));     // stands on the floor
  EXPECT_FALSE(comes(3, placed(shape(3), 0, {2.5, 1.5, 0})));      // shares edges with the table
  EXPECT_FALSE(comes(3, placed(shape(3), 0, {2.5, 1.75, 0})));     // runs along one of its edges
  EXPECT_FALSE(comes(1, placed(shape(1), 0.3, {0.5, 2.2, 0})));    // ends on the floor, which closes it
  EXPECT_TRUE(comes(1, placed(shape(1), 0.3, {0.5, 2.2, 2})));     // ends nowhere
  EXPECT_FALSE(comes(3, placed(shape(3), 0.3, {3.5, 3.5, 3.5})));  // reaches out of the extent
  std::vector<Polygon> many(401, shape(3)[0]);
  const std::vector<Role> roles(many.size(), Role::patch);
  const std::vector<Rank> ranks(many.size(), Rank{3} << 32);
  EXPECT_FALSE(PolygonSoup::edited(base, {}, {many, roles, ranks}));  // no room

  // What was begun and given up leaves nothing behind.
  Objects objects = objects_;
  objects.faces[5] = placed(shape(5), 0.3, {0.7, 0.7, 2});
  const auto after = PolygonSoup::edited(base, {}, objects.list(5, 6).arrival());
  ASSERT_TRUE(after);
  const Objects::List list = objects.all();
  const PolygonSoup anew = fresh(list);
  std::vector<Range> ranges = objects_.all().of_object;
  ranges[5] = after->arrived();
  std::mt19937 random(1);
  expect_same(*after, anew, facet_map(*after, ranges, anew, list.of_object), random);
}

/// Two boxes on the table, of which one is level with its top and with the other, and these two are not.
TEST_F(EditedRoom, MustBeMadeAnewWhereAPileChanges) {
  constexpr double kStep = 0.9 * 0x1p-47 * 4;
  Objects objects = objects_;
  objects.faces[3] = placed(shape(3), 0.3, {1.8, 1.6, 1 + kStep});
  const Objects::List pair = objects.all();
  const PolygonSoup base = fresh(pair, Planes::rounded);
  const auto comes = [&](int steps) {
    Objects with = objects;
    with.faces[4] = placed(shape(4), 0.4, {1.9, 1.7, 1 + steps * kStep});
    return PolygonSoup::edited(base, {}, with.list(4, 5).arrival()).has_value();
  };
  EXPECT_TRUE(comes(1));
  EXPECT_FALSE(comes(2));
  objects.faces[4] = placed(shape(4), 0.4, {1.9, 1.7, 1 + 2 * kStep});
  const Objects::List three = objects.all();
  const PolygonSoup pile = fresh(three, Planes::rounded);
  EXPECT_FALSE(PolygonSoup::edited(pile, three.of_object[3], {}));
  EXPECT_TRUE(PolygonSoup::edited(base, pair.of_object[3], {}));
}

/// Four planks about a square, each over the next one's end, and the last a little too high over the first: a chain of
/// all joins these two.
TEST_F(EditedRoom, MustBeMadeAnewWhereAChainOfFourCloses) {
  constexpr double kStep = 0.9 * 0x1p-47 * 4;
  const auto plank = [&](double x, double y, double width, double depth, int step) {
    Faces faces = shape(3);
    for (Polygon& face : faces) {
      for (Vec3& p : face.outer) p = {width * p.x, depth * p.y, 0.5 * p.z};
    }
    return placed(faces, 0.01 * (step + 1), {x, y, 2 + step * kStep});
  };
  Objects objects = objects_;
  objects.faces[3] = plank(1, 1, 1.6, 0.4, 0);
  objects.faces[4] = plank(1.1, 2.2, 1.5, 0.5, 2);
  objects.faces[5] = plank(0.9, 1.05, 0.4, 1.45, 3);
  const Faces link = plank(2.2, 1.1, 0.5, 1.5, 1);
  const Objects::List open = objects.all();
  const auto lowest = [](const PolygonSoup& soup, const Objects::List& list, std::uint32_t object) {
    return soup.first_facet(list.of_object[object].first);
  };
  const auto joined = [&](const PolygonSoup& soup, const Objects::List& list) {
    return std::ranges::binary_search(soup.coplanar(lowest(soup, list, 3)), lowest(soup, list, 5));
  };
  const PolygonSoup base = fresh(open, Planes::rounded);
  ASSERT_FALSE(joined(base, open));
  objects.faces[6] = link;
  const Objects::List closed = objects.all();
  const PolygonSoup anew = fresh(closed, Planes::rounded);
  ASSERT_TRUE(joined(anew, closed));
  EXPECT_FALSE(PolygonSoup::edited(base, {}, objects.list(6, 7).arrival()));
  EXPECT_FALSE(PolygonSoup::edited(anew, closed.of_object[6], {}));
  objects.faces[6] = placed(link, 0, {0, 0, 1});  // far from all of them
  const auto once = PolygonSoup::edited(base, {}, objects.list(6, 7).arrival());
  ASSERT_TRUE(once);
  EXPECT_TRUE(PolygonSoup::edited(*once, once->arrived(), {}));
  objects.faces[6] = link;
  EXPECT_FALSE(PolygonSoup::edited(*once, {}, objects.list(6, 7).arrival()));
}

TEST(EditedSoup, TheFirstPatchThatLiesAgainstAnotherIsNoneOfIt) {
  Objects objects;
  Faces room = prism({{0, 0}, {4, 0}, {4, 4}, {0, 4}}, 0, 4);
  for (Polygon& face : room) std::ranges::reverse(face.outer);
  objects.faces = {room, std::nullopt};
  const PolygonSoup base = fresh(objects.all());
  const auto comes = [&](double z) {
    objects.faces[1] = placed(prism({{0, 0}, {1, 0}, {1, 1}, {0, 1}}, 0, 1), 0.3, {1.5, 1.5, z});
    return PolygonSoup::edited(base, {}, objects.list(1, 2).arrival()).has_value();
  };
  EXPECT_TRUE(comes(1));
  EXPECT_FALSE(comes(0));
}

}  // namespace
}  // namespace exitance
