// Closure in scenes where most things lie in one plane, share edges or cross: within a closed room front and back of
// all that is seen add up to 1, whatever stands in it.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "geometry/facets.h"
#include "geometry/viewpoint.h"
#include "src/stress/placement.h"
#include "tests/geometry/solids.h"

namespace exitance {
namespace {

Polygon turned_over(Polygon polygon) {
  std::reverse(polygon.outer.begin(), polygon.outer.end());
  return polygon;
}

/// Faces that look out.
Faces box(const Vec3& a, const Vec3& b) {
  const auto corner = [&](int i) { return Vec3{i & 1 ? b.x : a.x, i & 2 ? b.y : a.y, i & 4 ? b.z : a.z}; };
  Faces faces;
  for (const auto& f : {std::array{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}) {
    faces.push_back({{corner(f[0]), corner(f[1]), corner(f[2]), corner(f[3])}, {}});
  }
  return faces;
}

/// A closed room, which looks in, and what stands in it.
class Room {
 public:
  Room(const Vec3& a, const Vec3& b) {
    for (const Polygon& wall : box(a, b)) add({turned_over(wall)});
  }

  void add(const Faces& faces, Role role = Role::patch) {
    polygons_.insert(polygons_.end(), faces.begin(), faces.end());
    roles_.resize(polygons_.size(), role);
  }
  void place(const Placement& placement) {
    for (Polygon& polygon : polygons_) polygon = placement(polygon);
  }
  void place(const std::function<Vec3(const Vec3&)>& placement) {
    for (Polygon& polygon : polygons_) std::ranges::transform(polygon.outer, polygon.outer.begin(), placement);
  }

  std::size_t size() const { return polygons_.size(); }
  const Polygon& polygon(std::size_t k) const { return polygons_[k]; }
  Role role(std::size_t k) const { return roles_[k]; }
  PolygonSoup soup() const { return PolygonSoup(polygons_, roles_); }

 private:
  std::vector<Polygon> polygons_;
  std::vector<Role> roles_;
};

double front_and_back(Viewpoint& view, const PolygonSoup& soup) {
  double sum = 0;
  for (std::uint32_t f = 0; f < soup.facets().size(); ++f) sum += view.form_factor({f, {}}).F;
  return sum;
}

// The shelf of a bookcase of sweethome3d-furniture: the bent faces of a box, whose top lies in the plane of another
// face, that is earlier and faces up, too.
TEST(Closure, TheTopOfABentBoxCoversAnEarlierFaceInItsPlane) {
  Room room({0, 0, 0}, {4, 4.5, 2.6});
  room.add({{{{1.9578780995152061, 4.4883762461286603, 1.4729999999999999},
              {1.9355131228717735, 4.4883764063243845, 1.4729999999999999},
              {1.9355129728365763, 4.1713932523860313, 1.4729999999999999},
              {1.9578777194260402, 4.1713929520190485, 1.4729999999999999}},
             {}}});
  const Vec3 a{1.0544249266756713, 4.4855282364850968, 0.045821641440167427},
      b{1.9361976734618298, 4.4855281864239336, 0.045821641440167427},
      c{1.9361976034454045, 4.4818950675489679, 0.045821641440167427},
      d{1.0544247766404744, 4.4818952778058563, 0.045821641440167427},
      e{1.0544250767108685, 4.485528396680821, 1.4729999999999999},
      f{1.9361978334993732, 4.4855279761670452, 1.4729999999999999},
      g{1.9361975234266326, 4.4818949974633391, 1.4729999999999999},
      h{1.0544248866662855, 4.4818951876957609, 1.4729999999999999};
  room.add({{{a, b, c, d}, {}},
            {{e, h, g, f}, {}},
            {{a, e, f, b}, {}},
            {{b, f, g, c}, {}},
            {{c, g, h, d}, {}},
            {{e, a, d, h}, {}}});
  const PolygonSoup soup = room.soup();
  ASSERT_EQ(soup.shells().size(), 1u);
  ASSERT_TRUE(soup.shells()[0].convex);
  Viewpoint view(soup);
  for (const Receiver& receiver : {Receiver{{2, 2.2, 2.5}, {0, 0, -1}}, Receiver{{2, 2.4, 2.55}, {0, 1, 0}}}) {
    view.look_from(receiver);
    EXPECT_NEAR(front_and_back(view, soup), 1, 1e-12);
  }
}

constexpr int kSize = 4;  // of the lattice's room

/// Boxes, some without one face and some with a notch, and sheets of one or two sides, some bent by very little, with
/// corners on a small lattice; one in four only occludes.
Room lattice_room(Random& random) {
  Room room({0, 0, 0}, {kSize, kSize, kSize});
  for (int count = random.whole(1, 5); count > 0; --count) {
    const Role role = random.whole(0, 3) == 0 ? Role::sheet : Role::patch;
    Vec3 a, b;
    for (int axis = 0; axis < 3; ++axis) {
      a[axis] = random.whole(0, kSize - 1);
      b[axis] = random.whole(static_cast<int>(a[axis]) + 1, kSize);
    }
    Faces faces = box(a, b);
    const auto face = static_cast<std::size_t>(random.whole(0, 5));
    switch (random.whole(0, 5)) {
      case 0:
      case 1:
        break;
      case 5: {
        const int x0 = int(a.x), y0 = int(a.y), x1 = int(b.x), y1 = int(b.y);
        if (x1 < x0 + 2 || y1 < y0 + 2) break;
        const int x = random.whole(x0 + 1, x1 - 1), y = random.whole(y0 + 1, y1 - 1);
        faces = prism({{x0, y0}, {x1, y0}, {x1, y}, {x, y}, {x, y1}, {x0, y1}}, int(a.z), int(b.z));
        break;
      }
      case 2:
        faces.erase(faces.begin() + static_cast<std::ptrdiff_t>(face));
        break;
      default: {
        Polygon sheet = faces[face];
        if (random.whole(0, 2) == 0) {
          const auto axis = 2 - static_cast<int>(face) / 2;
          double& height = sheet.outer[static_cast<std::size_t>(random.whole(0, 3))][axis];
          height += (height < kSize / 2 ? 1 : -1) * (random.whole(0, 1) == 0 ? 0x1p-6 : 0x1p-46);
        }
        faces = random.whole(0, 1) == 0 ? Faces{sheet} : Faces{sheet, turned_over(sheet)};
      }
    }
    room.add(faces, role);
  }
  return room;
}

/// Whether a polygon lies in a wall of the lattice's room, bent or not: rounded, it may come to lie outside.
bool lies_in_a_wall(const Polygon& polygon) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double wall : {0, kSize}) {
      if (std::ranges::all_of(polygon.outer, [&](const Vec3& v) { return std::fabs(v[axis] - wall) <= 0x1p-6; }))
        return true;
    }
  }
  return false;
}

class ClosureOnALattice : public testing::TestWithParam<Placement> {};

TEST_P(ClosureOnALattice, HoldsEverywhere) {
  constexpr int kRooms = 60;
  const Placement& placement = GetParam();
  Random random(placement.name);
  int asked = 0;
  for (int k = 0; k < kRooms; ++k) {
    Room room = lattice_room(random);
    std::vector<std::size_t> receivers;
    for (std::size_t p = 0; p < room.size(); ++p) {
      if (room.role(p) == Role::patch && (p < 6 || !lies_in_a_wall(room.polygon(p)))) receivers.push_back(p);
    }
    room.place(placement);
    const PolygonSoup soup = room.soup();
    Viewpoint view(soup);
    for (int point = 0; point < 3; ++point) {
      const auto p = receivers[static_cast<std::size_t>(random.whole(0, static_cast<int>(receivers.size()) - 1))];
      const Loop facet = cut_into_facets(room.polygon(p)).front();
      Vec3 sum;
      double weights = 0;
      for (const Vec3& v : facet) {
        const double weight = random.real(0.1, 1);
        sum = sum + weight * (v - facet[0]);
        weights += weight;
      }
      const Receiver receiver{facet[0] + (1 / weights) * sum, normalized(area_vector(facet)),
                              soup.first_facet(static_cast<std::uint32_t>(p))};
      view.look_from(receiver);
      if (view.covered()) continue;
      ++asked;
      EXPECT_NEAR(front_and_back(view, soup), 1, 1e-12) << "room " << k << ", polygon " << p;
    }
    const auto within = [&] { return random.real(0.1, kSize - 0.1); };
    const Vec3 x = placement({within(), within(), within()});
    const Vec3 normal{random.real(-1, 1), random.real(-1, 1), random.real(-1, 1)};
    view.look_from({x, normal});
    EXPECT_NEAR(front_and_back(view, soup), 1, 1e-12) << "room " << k << ", in the open";
  }
  EXPECT_GT(asked, kRooms);
}

/// From points of every polygon only fronts are seen, and they fill the hemisphere.
void expect_only_fronts(const Room& room, const std::string& what) {
  const PolygonSoup soup = room.soup();
  Viewpoint view(soup);
  for (std::uint32_t p = 0; p < room.size(); ++p) {
    const Loop facet = cut_into_facets(room.polygon(p)).front();
    for (const double way : {0.08, 0.31, 0.47}) {
      const Vec3 at = facet[0] + way * (facet[1] - facet[0]) + 0.5 * way * (facet[2] - facet[0]);
      view.look_from({at, normalized(area_vector(facet)), soup.first_facet(p)});
      EXPECT_FALSE(view.covered()) << what << ", polygon " << p;
      double sum = 0;
      for (std::uint32_t f = 0; f < soup.facets().size(); ++f) {
        const PointFormFactor seen = view.form_factor({f, {}});
        EXPECT_TRUE(seen.F == 0 || seen.side == Side::front) << what << ": polygon " << p << " sees the back of " << f;
        sum += seen.F;
      }
      EXPECT_NEAR(sum, 1, 1e-12) << what << ", polygon " << p;
    }
  }
}

Faces turned_over(Faces faces) {
  for (Polygon& face : faces) face = turned_over(face);
  return faces;
}

// A box of sheets: sides that look in and sides that look out, none of which bounds a solid.
TEST_P(ClosureOnALattice, AClosedSheetHidesNothingOfEitherSide) {
  Room room({0, 0, 0}, {3, 3, 3});
  const Faces sides = box({1, 1, 1}, {2, 2, 1.5});
  room.add(sides);
  Faces others = turned_over(sides);
  for (Polygon& side : others) std::ranges::rotate(side.outer, side.outer.begin() + 1);
  room.add(others);
  room.place(GetParam());
  expect_only_fronts(room, "closed sheet");
}

// A wall that two rooms share, of which each has its own side: neither is buried in what is behind the other. Only
// where coordinates are exact: turned walls of different corners lie one before the other by roundings.
TEST(Closure, ThinWallsBetweenRoomsHideNothing) {
  for (const bool turn : {false, true}) {
    Faces faces = turned_over(box({1, 0, 0}, {2, 1.5, 1}));
    for (const Polygon& face : turned_over(box({0.25, 1, 0.25}, {0.75, 2, 1.5}))) faces.push_back(face);
    Room rooms({0, 0, 0}, {1, 1, 1});
    rooms.add(faces);
    if (turn) rooms.place([](const Vec3& p) { return Vec3{3 * p.x - 4 * p.y, 4 * p.x + 3 * p.y, 5 * p.z}; });
    expect_only_fronts(rooms, turn ? "turned by 3, 4, 5" : "rooms");
  }
}

INSTANTIATE_TEST_SUITE_P(Placements, ClosureOnALattice, testing::ValuesIn(placements("closure")),
                         [](const auto& placement) {
                           std::string name = placement.param.name;
                           std::ranges::replace_if(
                               name, [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); }, '_');
                           return name;
                         });

}  // namespace
}  // namespace exitance
