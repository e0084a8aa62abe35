#include "src/output/ply.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

#include "tests/output/scratch_folder.h"

namespace exitance {
namespace {

struct Vertex {
  double x, y, z;
  std::array<std::uint8_t, 3> colour;
};

struct Ply {
  std::string header;
  std::vector<Vertex> vertices;
  std::vector<std::vector<std::int32_t>> faces;
};

// Reads back what the header announces; throws when bytes are missing or left over.
Ply read(const std::string& bytes) {
  Ply ply;
  std::size_t at = bytes.find("end_header\n") + 11;
  ply.header = bytes.substr(0, at);
  const auto count = [&](const std::string& of) {
    return std::stoul(ply.header.substr(ply.header.find("element " + of + " ") + 9 + of.size()));
  };
  const auto take = [&]<typename T>(T& value) {
    if (at + sizeof(T) > bytes.size()) throw std::runtime_error("too short");
    std::memcpy(&value, bytes.data() + at, sizeof(T));
    at += sizeof(T);
  };
  ply.vertices.resize(count("vertex"));
  for (Vertex& v : ply.vertices) {
    take(v.x);
    take(v.y);
    take(v.z);
    take(v.colour);
  }
  ply.faces.resize(count("face"));
  for (auto& face : ply.faces) {
    std::uint32_t corners = 0;
    take(corners);
    face.resize(corners);
    for (std::int32_t& corner : face) take(corner);
  }
  if (at != bytes.size()) throw std::runtime_error("too long");
  return ply;
}

// A strip of two squares of one surface, one red, one green, and a light.
class PlyFile : public testing::Test {
 protected:
  PlyFile() : faces(1e-9) {
    faces.add(0, 0, 0, std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
    faces.add(0, 0, 1, std::vector<Vec3>{{1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}});
    faces.add(1, 1, 2, std::vector<Vec3>{{0, 0, 1e6 + 1e-9}, {0, 1, 3}, {1, 0, 3}});
  }
  Faces faces;
  std::vector<double> B{1, 0, 0, 0, 1, 0, 900, 900, 900};
  std::vector<std::uint8_t> emits{0, 0, 1};
  ScratchFolder folder;
};

TEST_F(PlyFile, ConstantGivesEachFaceItsColour) {
  write_ply(folder / "s.ply", faces, {3, B, emits, {}}, Shading::constant);
  const Ply ply = read(contents(folder / "s.ply"));
  EXPECT_THAT(ply.header, testing::StartsWith("ply\nformat binary_little_endian 1.0\n"));
  ASSERT_EQ(ply.vertices.size(), 11u);
  EXPECT_EQ(ply.vertices[8].z, 1e6 + 1e-9);
  EXPECT_THAT(ply.faces[1], testing::ElementsAre(4, 5, 6, 7));
  EXPECT_THAT(ply.faces[2], testing::ElementsAre(8, 9, 10));
  const auto red = ply.vertices[0].colour, green = ply.vertices[4].colour;
  EXPECT_TRUE(red[0] > 100 && red[1] == 0 && red[2] == 0);
  EXPECT_TRUE(green[1] > 100 && green[0] == 0 && green[2] == 0);
  EXPECT_THAT(ply.vertices[8].colour, testing::ElementsAre(255, 255, 255));
}

TEST_F(PlyFile, SmoothSharesVerticesAndMixesColours) {
  write_ply(folder / "s.ply", faces, {3, B, emits, {}}, Shading::smooth);
  const Ply ply = read(contents(folder / "s.ply"));
  ASSERT_EQ(ply.vertices.size(), 9u);
  EXPECT_THAT(ply.faces[0], testing::ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(ply.faces[1], testing::ElementsAre(1, 4, 5, 2));
  const auto red = ply.vertices[0].colour, between = ply.vertices[1].colour;
  EXPECT_TRUE(between[0] > 0 && between[1] > 0 && between[0] < red[0]);
}

}  // namespace
}  // namespace exitance
