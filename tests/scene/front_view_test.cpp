#include "src/scene/front_view.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "src/scene/reader.h"
#include "tests/places.h"
#include "tests/scene/turned_scene.h"

namespace exitance {
namespace {

bool only_fronts(const std::string& name) {
  return sees_only_fronts(read_scene(source_file("data/" + name)));
}

TEST(FrontView, OfRoomsAndSolidsApart) {
  EXPECT_TRUE(only_fronts("furnace_cube.toml"));
  EXPECT_TRUE(only_fronts("box_on_floor.toml"));
}

TEST(FrontView, IsSpoiltByOpeningsAndContacts) {
  EXPECT_FALSE(only_fronts("cornell_box.toml"));
  EXPECT_FALSE(only_fronts("cornell_box_closed.toml"));
}

TEST(FrontView, IsSpoiltByWhatOnlyObstructsAndBySheetsAndTurnedSolids) {
  Scene room = read_scene(source_file("data/furnace_cube.toml"));
  const Polygon square{{{0.4, 0.4, 0.5}, {0.6, 0.4, 0.5}, {0.6, 0.6, 0.5}, {0.4, 0.6, 0.5}}, {}};
  Scene with_sheet = room;
  with_sheet.surfaces.push_back({.polygon = square});
  EXPECT_FALSE(sees_only_fronts(with_sheet));
  with_sheet.surfaces.back().obstruction_only = true;
  EXPECT_FALSE(sees_only_fronts(with_sheet));

  // The room again, shrunk within itself: as a room in the room it shows its back, turned over it is a solid.
  Scene nested = room;
  for (Surface surface : room.surfaces) {
    for (Vec3& p : surface.polygon.outer) p = {0.25 + 0.5 * p.x, 0.25 + 0.5 * p.y, 0.25 + 0.5 * p.z};
    nested.surfaces.push_back(surface);
  }
  EXPECT_FALSE(sees_only_fronts(nested));
  for (std::size_t k = room.surfaces.size(); k < nested.surfaces.size(); ++k) {
    std::ranges::reverse(nested.surfaces[k].polygon.outer);
  }
  EXPECT_TRUE(sees_only_fronts(nested));
}

/// Turned, surfaces in contact lie in one plane but for rounding.
TEST(FrontView, IsSpoiltByContactsThatRoundingHasMoved) {
  const Scene room = read_scene(source_file("data/furnace_cube.toml"));
  for (const double height : {0.0, 0.25}) {
    for (const double angle : {0.0, 0.3, 1.1, 2.2})
      EXPECT_EQ(sees_only_fronts(turned(with_solid(room, height), angle)), height > 0) << angle;
  }
}

}  // namespace
}  // namespace exitance
