#include "src/output/obj.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <stdexcept>

#include "src/scene/furnished_room.h"
#include "src/scene/input_error.h"
#include "tests/output/scratch_folder.h"

namespace exitance {
namespace {

TEST(WriteObj, ReadsBackToTheSameBits) {
  const Scene scene = make_furnished_room(500, 5);
  const ScratchFolder folder;
  write_obj(scene, folder / "room.obj");
  std::ifstream file(folder / "room.obj");
  std::vector<Vec3> vertices;
  std::size_t face = 0;
  std::string line, material;
  while (std::getline(file, line)) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "v") {
      std::string x, y, z;
      words >> x >> y >> z;
      vertices.push_back({std::stod(x), std::stod(y), std::stod(z)});
    } else if (word == "usemtl") {
      words >> material;
    } else if (word == "f") {
      ASSERT_LT(face, scene.surfaces.size());
      const Surface& s = scene.surfaces[face++];
      EXPECT_EQ(material, scene.materials[s.material].name);
      std::size_t index, corner = 0;
      while (words >> index) {
        ASSERT_LT(corner, s.polygon.outer.size());
        EXPECT_EQ(vertices.at(index - 1), s.polygon.outer[corner++]);
      }
      EXPECT_EQ(corner, s.polygon.outer.size());
    }
  }
  EXPECT_EQ(face, scene.surfaces.size());
  EXPECT_EQ(folder.files(), 2u);
}

TEST(WriteObj, BothFilesOrNone) {
  const Scene scene = make_furnished_room(100, 5);
  const ScratchFolder folder;
  std::filesystem::create_directory(folder / "a.obj");
  std::filesystem::create_directory(folder / "b.mtl");
  for (const char* name : {"a.obj", "b.obj", "missing/c.obj"})
    EXPECT_THROW(write_obj(scene, folder / name), InputError) << name;
  EXPECT_THROW(write_obj(scene, folder / "d.mtl"), std::invalid_argument);
  EXPECT_EQ(folder.files(), 2u);
}

}  // namespace
}  // namespace exitance
