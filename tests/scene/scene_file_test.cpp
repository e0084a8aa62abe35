#include "src/scene/scene_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "src/scene/input_error.h"
#include "src/scene/reader.h"
#include "src/scene/scene_check.h"
#include "tests/scene/scene_files.h"

namespace exitance {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::string_view kWhite = "[[material]]\nname = \"white\"\nrho = 0.7\n";
constexpr std::string_view kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

class SceneFileTest : public SceneFiles {
 protected:
  Scene read(std::string_view text) const {
    return read_scene(write("scene.toml", std::string(kWhite) + std::string(text)));
  }
  // Lines are counted from the first one after the material.
  std::string error_of(std::string_view text) const {
    try {
      read(text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
};

TEST_F(SceneFileTest, EverythingAtOnce) {
  write("part.obj", std::string(kTriangle) + "usemtl wood\nf 1 2 3\nusemtl steel\nf 1 2 3\n");
  const Scene scene = read_scene(write("all.toml", R"(
name = "Everything"
unit = "lm/m^2"
[camera]
eye = [0, -5, 1.5]
target = [0, 0, 1.5]
vertical_fov = 30
[[material]]
name = "white"
rho = 0.7
[[material]]
name = "lamp"
rho = [0.1, 0.2, 0.3]
E = 2
emission = "radiance"
[[object]]
name = "room"
box = {min = [0, 0, 0], max = [3, 3, 3]}
flip = true
material = "white"
[[object]]
name = "chair"
mesh = "part.obj"
materials = {wood = "lamp"}
translate = [1, 1, 1]
[[object]]
polygons = [
  [[1, 1, 2.5], [1, 2, 2.5], [2, 2, 2.5], [2, 1, 2.5]],
  {polygon = [[0, 0, 1], [3, 0, 1], [3, 3, 1], [0, 3, 1]], holes = [[[1, 1, 1], [2, 1, 1], [2, 2, 1], [1, 2, 1]]], material = "lamp"},
]
material = "white"
obstruction_only = true
)"));
  EXPECT_EQ(scene.name, "Everything");
  EXPECT_EQ(scene.unit, "lm/m^2");
  ASSERT_TRUE(scene.camera.has_value());
  EXPECT_EQ(scene.camera->vertical_fov_degrees, 30);
  EXPECT_EQ(scene.camera->up, (Vec3{0, 0, 1}));
  EXPECT_EQ(scene.bands, 3u);
  ASSERT_EQ(scene.surfaces.size(), 10u);
  ASSERT_EQ(scene.objects.size(), 3u);
  EXPECT_EQ(scene.objects[1].name, "chair");
  const auto material = [&](std::size_t i) { return scene.materials[scene.surfaces[i].material]; };
  EXPECT_EQ(material(0).name, "white");
  EXPECT_THAT(material(0).rho, ElementsAre(0.7, 0.7, 0.7));
  EXPECT_EQ(material(6).name, "lamp");
  EXPECT_DOUBLE_EQ(material(6).E[2], 2 * std::numbers::pi);
  EXPECT_EQ(material(7).name, "steel");
  EXPECT_THAT(material(7).rho, ElementsAre(0.5, 0.5, 0.5));
  EXPECT_EQ(scene.surfaces[6].polygon.outer[1], (Vec3{2, 1, 1}));
  EXPECT_EQ(material(8).name, "white");
  EXPECT_EQ(material(9).name, "lamp");
  EXPECT_EQ(norm(area_vector(scene.surfaces[9].polygon)), 8);
  EXPECT_EQ(scene.surfaces[9].line, 29u);
  EXPECT_TRUE(scene.surfaces[9].obstruction_only);
  EXPECT_FALSE(scene.surfaces[0].obstruction_only);
}

TEST_F(SceneFileTest, ABoxLooksOutAndFlippedIsARoom) {
  const Scene box = read("[[object]]\nbox = {min = [0, 0, 0], max = [1, 2, 3]}\nmaterial = \"white\"\n");
  const Vec3 middle{0.5, 1, 1.5};
  for (const Surface& s : box.surfaces) EXPECT_GT(dot(s.polygon.outer[0] - middle, area_vector(s.polygon)), 0);
  EXPECT_FALSE(is_closed(box));
  EXPECT_TRUE(
      is_closed(read("[[object]]\nbox = {min = [0, 0, 0], max = [1, 2, 3]}\nmaterial = \"white\"\nflip = true\n")));
  EXPECT_EQ(box.bands, 1u);
}

TEST_F(SceneFileTest, ScaleThenRotateThenTranslate) {
  const Scene scene = read(
      "[[object]]\npolygons = [[[1, 0, 0], [2, 0, 0], [1, 1, 0]]]\nmaterial = \"white\"\n"
      "scale = [2, 1, 1]\nrotate = [{axis = [0, 0, 1], degrees = 90}, {axis = [1, 0, 0], degrees = 90}]\n"
      "translate = [10, 0, 0]\n");
  // (1,0,0) → (2,0,0) → (0,2,0) → (0,0,2) → (10,0,2); quarter turns are exact.
  EXPECT_EQ(scene.surfaces[0].polygon.outer[0], (Vec3{10, 0, 2}));
  EXPECT_EQ(scene.surfaces[0].polygon.outer[2], (Vec3{9, 0, 2}));
}

TEST_F(SceneFileTest, AMirrorImageKeepsItsFront) {
  const Scene scene = read(
      "[[object]]\nbox = {min = [0, 0, 0], max = [1, 1, 1]}\nmaterial = \"white\"\nscale = [-1, 1, 1]\nflip = true\n");
  EXPECT_TRUE(is_closed(scene));
}

TEST_F(SceneFileTest, TurnedBoxesStayClosed) {
  EXPECT_TRUE(
      is_closed(read("[[object]]\nbox = {min = [0.1, 0.2, 0.3], max = [1, 1, 1]}\nmaterial = \"white\"\nflip = true\n"
                     "rotate = {axis = [1, 2, 3], degrees = 33}\n")));
}

TEST_F(SceneFileTest, TwoSidedAddsEachPolygonRightAfterItself) {
  const Scene scene = read(
      "[[object]]\npolygons = [[[0,0,0],[1,0,0],[0,1,0]], [[0,0,1],[1,0,1],[0,1,1]]]\n"
      "material = \"white\"\ntwo_sided = true\n");
  ASSERT_EQ(scene.surfaces.size(), 4u);
  EXPECT_EQ(scene.surfaces[1].polygon.outer[0].z, 0);
  EXPECT_EQ(area_vector(scene.surfaces[1].polygon).z, -0.5);
}

TEST_F(SceneFileTest, ReflectancesOfMeshesCanBeLimited) {
  write("white.mtl", "newmtl bright\nKd 1 1 0.5\n");
  write("part.obj", "mtllib white.mtl\n" + std::string(kTriangle) + "usemtl bright\nf 1 2 3\n");
  EXPECT_THAT(error_of("[[object]]\nmesh = \"part.obj\"\n"), HasSubstr("white.mtl:1: "));
  const Scene scene = read("[[object]]\nmesh = \"part.obj\"\nmax_rho = 0.9\n");
  EXPECT_THAT(scene.materials.at(0).rho, ElementsAre(0.9, 0.9, 0.5));
  EXPECT_EQ(error_of("[[object]]\nmesh = \"part.obj\"\nmaterial = \"white\"\n"), "");
}

TEST_F(SceneFileTest, FurnishedRoom) {
  const Scene scene = read("[[object]]\nname = \"flat\"\nfurnished-room = {polygons = 300, seed = 1}\n");
  EXPECT_EQ(scene.surfaces.size(), 300u);
  EXPECT_THAT(scene.objects.at(0).name, testing::StartsWith("flat/"));
  EXPECT_TRUE(is_closed(scene));
}

TEST_F(SceneFileTest, RefusesKeysOfMoreTablesThanCanBeFreed) {
  std::string key = "a";
  for (int k = 0; k < 100'000; ++k) key += k % 2 ? ".a" : " . \"a=b\"";
  for (const std::string& text : {"[" + key + "]\n", "\n" + key + " = 1\n", "b = {" + key + " = 1}\n"})
    EXPECT_THAT(error_of("[[object]]\n" + text), AllOf(HasSubstr("scene.toml:"), HasSubstr("parts")));
  const std::string dots(100, '.');
  EXPECT_EQ(read("# it's " + dots + "\n[[object]]\nname = \"" + dots +
                 "\"\nmaterial = \"white\"\nbox = {min = [0.0, 0.0, 0.0], max = [1.0, 1.0, 1.0]}\n")
                .surfaces.size(),
            6u);
}

TEST_F(SceneFileTest, MistakesNameTheirLine) {
  EXPECT_THAT(error_of("[[object]\n"), HasSubstr("scene.toml:4: "));
  EXPECT_THAT(error_of("[[object]]\nbox = {min = [0,0,0], max = [1,1,1]}\ncolour = 3\n"),
              AllOf(HasSubstr("scene.toml:6: "), HasSubstr("\"colour\""), HasSubstr("two_sided")));
  EXPECT_THAT(error_of("[[happening]]\ntime = 1\n"), AllOf(HasSubstr("scene.toml:4: "), HasSubstr("\"happening\"")));
  EXPECT_THAT(error_of("[[object]]\nbox = {min = [0,0,0], max = [1,1,1]}\nflip = 1\n"),
              HasSubstr("scene.toml:6: \"flip\""));
  EXPECT_THAT(error_of("[[object]]\nbox = {min = [0,0], max = [1,1,1]}\n"), HasSubstr("scene.toml:5: "));
  EXPECT_THAT(error_of("[[object]]\nbox = {min = [0,0,2], max = [1,1,1]}\n"), HasSubstr("scene.toml:5: "));
  EXPECT_THAT(error_of("[[object]]\nbox = {min = [0,0,nan], max = [1,1,1]}\n"), HasSubstr("not a finite number"));
  EXPECT_THAT(error_of("[[object]]\nname = \"nothing\"\n"), HasSubstr("exactly one of"));
  EXPECT_THAT(error_of("[[object]]\nmesh = \"none.obj\"\n"), AllOf(HasSubstr("scene.toml:5: "), HasSubstr("missing")));
  EXPECT_THAT(error_of("[[object]]\nmesh = \"scene.toml\"\n"),
              AllOf(HasSubstr("scene.toml:5: "), HasSubstr("no mesh")));
  EXPECT_THAT(error_of("[[object]]\npolygons = [\n[[0,0,0],[1,0,0]]]\n"), HasSubstr("scene.toml:6: "));
  EXPECT_THAT(error_of("[[object]]\npolygons = [\n[[0,0,0],[2,0,0],[0,1,0],[2,1,0]]]\n"),
              AllOf(HasSubstr("scene.toml:6: "), HasSubstr("crosses")));
  EXPECT_THAT(error_of("[[object]]\nbox = {min = [0,0,0], max = [1,1,1]}\nmaterial = \"blue\"\n"),
              AllOf(HasSubstr("scene.toml:6: "), HasSubstr("'blue'")));
  EXPECT_THAT(error_of("[[object]]\nbox = {min = [0,0,0], max = [1,1,1]}\nscale = 0\n"), HasSubstr("scene.toml:6: "));
  EXPECT_THAT(error_of("[[object]]\nbox = {min = [0,0,0], max = [1,1,1]}\nscale = 1e-200\n"),
              AllOf(HasSubstr("scene.toml:5: "), HasSubstr("scale it up")));
  EXPECT_THAT(error_of("[[material]]\nname = \"hot\"\nrho = 1.0\n[[object]]\nbox = {min = [0,0,0], max = [1,1,1]}\n"
                       "material = \"hot\"\n"),
              AllOf(HasSubstr("scene.toml:4: "), HasSubstr("reflectance 1")));
  EXPECT_THAT(
      error_of("[[material]]\nname = \"a\"\nrho = [0.1, 0.2]\n[[material]]\nname = \"b\"\nrho = [0.1, 0.2, 0.3]\n"
               "[[object]]\nbox = {min = [0,0,0], max = [1,1,1]}\nmaterial = \"a\"\n"
               "[[object]]\nbox = {min = [0,0,0], max = [1,1,1]}\nmaterial = \"b\"\n"),
      HasSubstr("bands"));
  EXPECT_THAT(error_of(""), HasSubstr("no surfaces"));
}

}  // namespace
}  // namespace exitance
