#include "src/scene/furnished_room.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <stdexcept>
#include <tuple>
#include <vector>

#include "src/scene/scene_check.h"

namespace exitance {
namespace {

using Point = std::tuple<double, double, double>;

Point key(const Vec3& p) {
  return {p.x, p.y, p.z};
}

std::vector<const Surface*> surfaces_of(const Scene& scene, std::size_t object) {
  std::vector<const Surface*> found;
  for (const Surface& s : scene.surfaces)
    if (s.object == object) found.push_back(&s);
  return found;
}

std::size_t object_named(const Scene& scene, const std::string& start) {
  for (std::size_t k = 0; k < scene.objects.size(); ++k)
    if (scene.objects[k].name.starts_with(start)) return k;
  ADD_FAILURE() << "no object called " << start;
  return 0;
}

/// Six times the volume under the faces: positive when they face outward.
double volume6(const std::vector<const Surface*>& surfaces) {
  double sum = 0;
  for (const Surface* s : surfaces) sum += 2 * dot(area_vector(s->polygon), s->polygon.outer[0]);
  return sum;
}

/// How often each directed edge is used, less its reverse. Empty for a closed surface.
std::map<std::pair<Point, Point>, int> open_edges(const std::vector<std::pair<Vec3, Vec3>>& edges) {
  std::map<std::pair<Point, Point>, int> balance;
  for (const auto& [from, to] : edges) {
    const Point a = key(from), b = key(to);
    const auto place = balance.try_emplace({std::min(a, b), std::max(a, b)}, 0).first;
    place->second += a < b ? 1 : -1;
    if (place->second == 0) balance.erase(place);
  }
  return balance;
}

std::vector<std::pair<Vec3, Vec3>> edges_of(const std::vector<const Surface*>& surfaces) {
  std::vector<std::pair<Vec3, Vec3>> edges;
  for (const Surface* s : surfaces)
    for (std::size_t k = 0, n = s->polygon.outer.size(); k < n; ++k)
      edges.emplace_back(s->polygon.outer[k], s->polygon.outer[(k + 1) % n]);
  return edges;
}

/// Cuts axis-parallel edges at all vertices that lie on them.
std::vector<std::pair<Vec3, Vec3>> cut_at_vertices(const std::vector<std::pair<Vec3, Vec3>>& edges) {
  std::vector<std::pair<Vec3, Vec3>> parts;
  for (const auto& [from, to] : edges) {
    std::map<double, Vec3> on_edge{{0, from}, {1, to}};
    for (const auto& [v, unused] : edges)
      for (int axis = 0; axis < 3; ++axis) {
        const int b = (axis + 1) % 3, c = (axis + 2) % 3;
        if (from[axis] == to[axis] || from[b] != to[b] || from[c] != to[c] || v[b] != from[b] || v[c] != from[c])
          continue;
        const double t = (v[axis] - from[axis]) / (to[axis] - from[axis]);
        if (t > 0 && t < 1) on_edge[t] = v;
      }
    for (auto p = on_edge.begin(), q = std::next(p); q != on_edge.end(); ++p, ++q)
      parts.emplace_back(p->second, q->second);
  }
  return parts;
}

std::uint64_t hash_of_all_bits(const Scene& scene) {
  std::uint64_t h = 1469598103934665603u;
  const auto add = [&](std::uint64_t bits) { h = (h ^ bits) * 1099511628211u; };
  for (const Surface& s : scene.surfaces) {
    add(s.material);
    add(s.object);
    for (const Vec3& p : s.polygon.outer)
      for (int axis = 0; axis < 3; ++axis) add(std::bit_cast<std::uint64_t>(p[axis]));
  }
  return h;
}

class FurnishedRoom : public testing::TestWithParam<std::uint32_t> {};

TEST_P(FurnishedRoom, HasExactlyThePolygonsAskedFor) {
  for (const std::uint64_t seed : {1u, 2u, 3u})
    EXPECT_EQ(make_furnished_room(GetParam(), seed).surfaces.size(), GetParam()) << seed;
}

TEST_P(FurnishedRoom, EveryPieceOfFurnitureIsAClosedOutwardSolid) {
  const Scene scene = make_furnished_room(GetParam(), 7);
  std::vector<std::vector<const Surface*>> of(scene.objects.size());
  for (const Surface& s : scene.surfaces) of[s.object].push_back(&s);
  for (std::size_t k = 0; k < of.size(); ++k) {
    if (scene.objects[k].name.starts_with("room")) continue;
    EXPECT_TRUE(open_edges(edges_of(of[k])).empty()) << scene.objects[k].name;
    EXPECT_GT(volume6(of[k]), 0) << scene.objects[k].name;
  }
}

TEST_P(FurnishedRoom, TheRoomIsClosedAndFacesInward) {
  const Scene scene = make_furnished_room(GetParam(), 7);
  const auto room = surfaces_of(scene, object_named(scene, "room"));
  EXPECT_FALSE(open_edges(edges_of(room)).empty()) << "there should be T-junctions";
  EXPECT_TRUE(open_edges(cut_at_vertices(edges_of(room))).empty());
  Vec3 size;
  for (const Surface* s : room)
    for (const Vec3& p : s->polygon.outer) size = {std::max(size.x, p.x), std::max(size.y, p.y), std::max(size.z, p.z)};
  EXPECT_NEAR(volume6(room), -6 * size.x * size.y * size.z, 1e-9 * size.x * size.y * size.z);
  EXPECT_EQ(size.z, 3);
}

TEST_P(FurnishedRoom, FurnitureStaysInsideTheRoom) {
  const Scene scene = make_furnished_room(GetParam(), 7);
  Vec3 size;
  for (const Surface* s : surfaces_of(scene, object_named(scene, "room")))
    for (const Vec3& p : s->polygon.outer) size = {std::max(size.x, p.x), std::max(size.y, p.y), std::max(size.z, p.z)};
  for (const Surface& s : scene.surfaces)
    for (const Vec3& p : s.polygon.outer)
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_GE(p[axis], 0);
        EXPECT_LE(p[axis], size[axis]);
      }
}

TEST_P(FurnishedRoom, MaterialsAreInRangeAndLampsEmit) {
  const Scene scene = make_furnished_room(GetParam(), 7);
  std::set<std::uint32_t> emitting;
  for (const Surface& s : scene.surfaces) {
    const Material& m = scene.materials.at(s.material);
    for (const double rho : m.rho) EXPECT_TRUE(0.2 <= rho && rho <= 0.8) << m.name;
    if (m.E[0] > 0) emitting.insert(s.material);
  }
  EXPECT_EQ(emitting.size(), 1u);
}

INSTANTIATE_TEST_SUITE_P(Sizes, FurnishedRoom, testing::Values(100, 101, 500, 777, 5000, 60000));

using Solid = std::vector<const Surface*>;

/// Whether all of b lies beyond, or on, the plane of one of the faces of the convex solid a.
bool beyond_a_face(const Solid& a, const Solid& b) {
  return std::any_of(a.begin(), a.end(), [&](const Surface* face) {
    const Vec3 normal = normalized(area_vector(face->polygon));
    return std::all_of(b.begin(), b.end(), [&](const Surface* other) {
      return std::all_of(other->polygon.outer.begin(), other->polygon.outer.end(),
                         [&](const Vec3& p) { return dot(normal, p - face->polygon.outer[0]) >= -1e-12; });
    });
  });
}

/// The vertical cylinder around a vase: its axis' x and y, and its radius.
Vec3 cylinder(const Solid& vase) {
  Vec3 middle;
  double radius = 0, count = 0;
  for (const Surface* s : vase)
    for (const Vec3& p : s->polygon.outer) {
      middle = middle + p;
      ++count;
    }
  middle = (1 / count) * middle;
  for (const Surface* s : vase)
    for (const Vec3& p : s->polygon.outer) radius = std::max(radius, std::hypot(p.x - middle.x, p.y - middle.y));
  return {middle.x, middle.y, radius};
}

// All solids but vases are convex. Two convex bodies could also be kept apart by no plane but one along an edge of
// each; bodies that stand upright are not.
TEST(FurnishedRoomContacts, SolidsDoNotOverlap) {
  for (const std::uint32_t size : {500u, 3000u}) {
    const Scene scene = make_furnished_room(size, 11);
    std::vector<Solid> solids, vases;
    for (std::size_t k = 0; k < scene.surfaces.size();) {
      const std::uint32_t object = scene.surfaces[k].object;
      const std::string& name = scene.objects[object].name;
      // Boxes come one after the other; columns, pedestals and vases are one solid each.
      const bool boxes = !name.starts_with("column") && !name.starts_with("pedestal") && !name.starts_with("vase");
      Solid solid;
      for (; k < scene.surfaces.size() && scene.surfaces[k].object == object && (!boxes || solid.size() < 6); ++k)
        solid.push_back(&scene.surfaces[k]);
      if (!name.starts_with("room")) (name.starts_with("vase") ? vases : solids).push_back(std::move(solid));
    }
    EXPECT_GT(solids.size(), size / 15);
    EXPECT_GE(vases.size(), 3u);
    const auto name_of = [&](const Solid& solid) { return scene.objects[solid[0]->object].name; };
    for (std::size_t a = 0; a < solids.size(); ++a) {
      for (std::size_t b = 0; b < a; ++b)
        EXPECT_TRUE(beyond_a_face(solids[a], solids[b]) || beyond_a_face(solids[b], solids[a]))
            << name_of(solids[a]) << " and " << name_of(solids[b]);
      for (const Solid& vase : vases)
        EXPECT_TRUE(beyond_a_face(solids[a], vase)) << name_of(solids[a]) << " and " << name_of(vase);
    }
    for (std::size_t a = 0; a < vases.size(); ++a)
      for (std::size_t b = 0; b < a; ++b) {
        const Vec3 p = cylinder(vases[a]), q = cylinder(vases[b]);
        EXPECT_GT(std::hypot(p.x - q.x, p.y - q.y), p.z + q.z) << name_of(vases[a]) << " and " << name_of(vases[b]);
      }
  }
}

TEST(FurnishedRoomContacts, ContactsShareTheirPlaneExactly) {
  const Scene scene = make_furnished_room(500, 1);
  std::map<std::pair<int, double>, std::array<int, 2>>
      faces;  // axis-parallel planes: how many face up and down the axis
  for (const Surface& s : scene.surfaces)
    for (int axis = 0; axis < 3; ++axis) {
      bool flat = true;
      for (const Vec3& p : s.polygon.outer) flat &= p[axis] == s.polygon.outer[0][axis];
      if (flat) ++faces[{axis, s.polygon.outer[0][axis]}][area_vector(s.polygon)[axis] > 0];
    }
  int contact_planes = 0;
  for (const auto& [plane, count] : faces) contact_planes += count[0] > 0 && count[1] > 0;
  EXPECT_GE(contact_planes, 10);
  EXPECT_GT((faces[{2, 0}][0]), 10) << "things stand on the floor";
  EXPECT_GT((faces[{2, 3}][1]), 0) << "lamps hang at the ceiling";
  EXPECT_GT((faces[{1, 0}][0]), 0) << "a shelf stands at the near wall";
  EXPECT_GT((faces[{1, 4}][1]), 0) << "a cupboard stands at the far wall";
}

TEST(FurnishedRoomBits, SameSeedSameBitsAndAnotherSeedAnotherRoom) {
  const auto hash = hash_of_all_bits(make_furnished_room(5000, 42));
  EXPECT_EQ(hash, hash_of_all_bits(make_furnished_room(5000, 42)));
  EXPECT_NE(hash, hash_of_all_bits(make_furnished_room(5000, 43)));
}

TEST(FurnishedRoomBits, RefusesSizesItCannotMake) {
  EXPECT_THROW(make_furnished_room(99, 1), std::invalid_argument);
  EXPECT_THROW(make_furnished_room(1000001, 1), std::invalid_argument);
}

TEST_P(FurnishedRoom, IsClosedWithItsContacts) {
  EXPECT_TRUE(is_closed(make_furnished_room(GetParam(), 7)));
}

}  // namespace
}  // namespace exitance
