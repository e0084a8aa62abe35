#include "src/scene/reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <numbers>

#include "src/scene/input_error.h"
#include "tests/scene/scene_files.h"

namespace exitance {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsSupersetOf;
using testing::StartsWith;

template <typename T>
void append(std::string& bytes, T value, std::endian order) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  for (std::size_t i = 0; i < sizeof(T); ++i) bytes += raw[order == std::endian::native ? i : sizeof(T) - 1 - i];
}

class Reader : public SceneFiles {
 protected:
  std::string error_of(const std::string& name, std::string_view content, const ReadOptions& options = {}) const {
    return error_of(write(name, content), options);
  }
  static std::string error_of(const std::filesystem::path& file, const ReadOptions& options = {}) {
    try {
      read_scene(file, options);
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      return error.what();
    }
    return "";
  }
};

constexpr std::string_view kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

std::string square(std::string_view faces) {
  return std::string(kSquare) + std::string(faces);
}

TEST_F(Reader, ObjKeepsPolygonsInFileOrderWithExactCoordinates) {
  const Scene scene = read_scene(write("a.obj",
                                       "# comment\r\n"
                                       "v 0.1 +2e-3 -0.30000000000000004\r\n"
                                       "v 1 0 0 # trailing\n"
                                       "v 1 1 0\n"
                                       "v 0 \\\n 1 0\n"
                                       "v .5 2 0\n"
                                       "vt 0 0\nvn 0 0 1\ns off\n"
                                       "f 1 2 3 4\n"
                                       "f 1/1 2/1 3/1\n"
                                       "f 1//1 2//1 3//1\n"
                                       "f 1/1/1 2/1/1 \\\n 3/1/1\n"
                                       "f -5 -4 -3 -1 -2"));
  ASSERT_EQ(scene.surfaces.size(), 5u);
  EXPECT_EQ(scene.surfaces[0].polygon.outer,
            (std::vector<Vec3>{{0.1, 2e-3, -0.30000000000000004}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}));
  for (int i : {1, 2, 3}) EXPECT_EQ(scene.surfaces[static_cast<std::size_t>(i)].polygon.outer.size(), 3u);
  EXPECT_EQ(scene.surfaces[4].polygon.outer[3], (Vec3{.5, 2, 0}));
  EXPECT_EQ(scene.surfaces[0].line, 11u);
  EXPECT_EQ(scene.surfaces[4].line, 16u);
  EXPECT_EQ(scene.objects.at(0).name, "a");
}

TEST_F(Reader, ObjReadsMaterialsAndObjects) {
  write("my colours.mtl", "newmtl red wall\nKd 0.6 0.1 0.05\nnewmtl lamp\nKd 0.5\nKe 1 2 3\nNs 10\n");
  const Scene scene =
      read_scene(write("room.obj", "mtllib my colours.mtl\no walls\n" +
                                       square("usemtl red wall\nf 1 2 3\no light\nusemtl lamp\nf 1 3 4\n")));
  ASSERT_EQ(scene.materials.size(), 2u);
  EXPECT_THAT(scene.materials[scene.surfaces[0].material].rho, ElementsAre(0.6, 0.1, 0.05));
  EXPECT_THAT(scene.materials[scene.surfaces[0].material].E, ElementsAre(0, 0, 0));
  EXPECT_THAT(scene.materials[scene.surfaces[1].material].rho, ElementsAre(0.5, 0.5, 0.5));
  EXPECT_THAT(scene.materials[scene.surfaces[1].material].E, ElementsAre(1, 2, 3));
  EXPECT_EQ(scene.objects[scene.surfaces[1].object].name, "light");
  EXPECT_EQ(scene.bands, 3u);
  EXPECT_THAT(scene.warnings, ElementsAre());
}

TEST_F(Reader, RadianceIsPiTimesLessThanExitance) {
  write("a.mtl", "newmtl lamp\nKd 0.5\nKe 1 2 3\n");
  const auto file = write("a.obj", "mtllib a.mtl\n" + square("usemtl lamp\nf 1 2 3\n"));
  const Scene scene = read_scene(file, {.emission = Emission::radiance});
  EXPECT_DOUBLE_EQ(scene.materials[0].E[1], 2 * std::numbers::pi);
}

TEST_F(Reader, ObjectsAreGroupsOnlyWhereNoObjectIsNamed) {
  const Scene groups = read_scene(write("g.obj", square("g one\nf 1 2 3\ng two\nf 1 3 4\n")));
  EXPECT_EQ(groups.objects.size(), 2u);
  const Scene objects = read_scene(write("o.obj", square("o all\ng one\nf 1 2 3\ng two\nf 1 3 4\n")));
  ASSERT_EQ(objects.objects.size(), 1u);
  EXPECT_EQ(objects.objects[0].name, "all");
}

TEST_F(Reader, WhatHasNoMaterialGetsTheDefaultAndAWarning) {
  const Scene scene = read_scene(write("a.obj", "mtllib gone.mtl\n" + square("usemtl nowhere\nf 1 2 3\nl 1 2\n")));
  EXPECT_THAT(scene.materials.at(0).rho, ElementsAre(0.5, 0.5, 0.5));
  EXPECT_THAT(scene.warnings,
              ElementsAre(HasSubstr("gone.mtl"), HasSubstr("1 lines and points"), HasSubstr("'nowhere'")));
}

TEST_F(Reader, LibrariesThatAreNoFilesAreMissing) {
  const std::string long_name(300, 'x');  // longer than names may be
  const Scene scene =
      read_scene(write("a.obj", "mtllib " + long_name + " /dev/zero .\n" + square("f 1 2 3\n")), {.keep_faults = true});
  EXPECT_THAT(scene.warnings, IsSupersetOf({HasSubstr(long_name), HasSubstr("/dev/zero"), HasSubstr("a.obj:1: ")}));
}

TEST_F(Reader, FlipAndTwoSided) {
  const auto file = write("a.obj", square("f 1 2 3 4\nf 1 2 3\n"));
  const Scene flipped = read_scene(file, {.flip = true});
  EXPECT_EQ(flipped.surfaces[0].polygon.outer, (std::vector<Vec3>{{0, 0, 0}, {0, 1, 0}, {1, 1, 0}, {1, 0, 0}}));
  const Scene doubled = read_scene(file, {.two_sided = true});
  ASSERT_EQ(doubled.surfaces.size(), 4u);
  EXPECT_GT(area_vector(doubled.surfaces[0].polygon).z, 0);
  EXPECT_EQ(area_vector(doubled.surfaces[1].polygon).z, -1);
  EXPECT_EQ(doubled.surfaces[1].polygon.outer.size(), 4u);
}

constexpr std::string_view kPlyText =
    "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
    "z\n"
    "property uchar red\nelement edge 1\nproperty int a\nelement face 2\nproperty list uchar int vertex_indices\n"
    "property uchar flag\nend_header\n"
    "0.1 0 0 255\n1 0 0 255\n1 1 0 255\n0 1 0 255\n7\n4 0 1 2 3 9\n3 0 1 2 9\n";

TEST_F(Reader, PlyText) {
  const Scene scene = read_scene(write("a.PLY", kPlyText));
  ASSERT_EQ(scene.surfaces.size(), 2u);
  EXPECT_EQ(scene.surfaces[0].polygon.outer, (std::vector<Vec3>{{0.1, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}));
  EXPECT_EQ(scene.surfaces[1].line, 21u);
}

template <typename Coordinate, typename Index>
std::string binary_ply(std::endian order, std::string_view coordinate, std::string_view index) {
  std::string bytes =
      "ply\nformat binary_" + std::string(order == std::endian::little ? "little" : "big") + "_endian 1.0\n";
  for (const char* part :
       {"element vertex 3\n", "property X x\n", "property X y\n", "property uchar grey\n", "property X z\n",
        "element face 1\n", "property list uchar I vertex_index\n", "end_header\n"}) {
    std::string line = part;
    if (const auto at = line.find('X'); at != std::string::npos) line.replace(at, 1, coordinate);
    if (const auto at = line.find('I'); at != std::string::npos) line.replace(at, 1, index);
    bytes += line;
  }
  for (const Vec3& p : {Vec3{0.1, 0, 0}, Vec3{1, 0, -2}, Vec3{1, 1, 0}}) {
    append(bytes, static_cast<Coordinate>(p.x), order);
    append(bytes, static_cast<Coordinate>(p.y), order);
    append(bytes, std::uint8_t{7}, order);
    append(bytes, static_cast<Coordinate>(p.z), order);
  }
  append(bytes, std::uint8_t{3}, order);
  for (int i : {0, 1, 2}) append(bytes, static_cast<Index>(i), order);
  return bytes;
}

TEST_F(Reader, PlyBinaryOfEitherOrder) {
  const Scene doubles =
      read_scene(write("a.ply", binary_ply<double, std::int32_t>(std::endian::little, "double", "int")));
  EXPECT_EQ(doubles.surfaces.at(0).polygon.outer, (std::vector<Vec3>{{0.1, 0, 0}, {1, 0, -2}, {1, 1, 0}}));
  const Scene floats =
      read_scene(write("b.ply", binary_ply<float, std::uint16_t>(std::endian::big, "float32", "uint16")));
  EXPECT_EQ(floats.surfaces.at(0).polygon.outer,
            (std::vector<Vec3>{{static_cast<double>(0.1f), 0, 0}, {1, 0, -2}, {1, 1, 0}}));
}

TEST_F(Reader, TruncatedPly) {
  const std::string whole = binary_ply<double, std::int32_t>(std::endian::little, "double", "int");
  EXPECT_THAT(error_of("a.ply", whole.substr(0, whole.size() - 1)), HasSubstr("truncated"));
  EXPECT_THAT(error_of("b.ply", std::string(kPlyText).substr(0, kPlyText.size() - 5)), HasSubstr("truncated"));
  EXPECT_THAT(error_of("c.ply", "ply\nformat ascii 1.0\nelement vertex 3\n"), HasSubstr("truncated"));
}

TEST_F(Reader, Off) {
  const Scene scene = read_scene(write("a.off",
                                       "COFF # colours\n4 2 0\n0.1 0 0 1 0 0 1\n1 0 0 1 0 0 1\n\n1 1 0 1 0 0 1\n"
                                       "0 1 0 1 0 0 1\n4 0 1 2 3 0.5 0.5 0.5\n3 0 1 2\n"));
  ASSERT_EQ(scene.surfaces.size(), 2u);
  EXPECT_EQ(scene.surfaces[0].polygon.outer, (std::vector<Vec3>{{0.1, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}));
  EXPECT_EQ(scene.surfaces[1].line, 9u);
  EXPECT_THAT(error_of("b.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n"), HasSubstr("after 2 of 3 vertices"));
  EXPECT_THAT(error_of("c.off", "OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"),
              AllOf(HasSubstr("c.off:5: "), HasSubstr("vertex 3")));
}

constexpr std::string_view kStlText =
    "solid a thing\nfacet normal 0 0 1\nouter loop\nvertex 0.1 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
    "endsolid a thing\n";

TEST_F(Reader, Stl) {
  const Scene text = read_scene(write("a.stl", kStlText));
  EXPECT_EQ(text.surfaces.at(0).polygon.outer, (std::vector<Vec3>{{0.1, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  EXPECT_EQ(text.surfaces[0].line, 2u);
  EXPECT_EQ(text.objects.at(0).name, "a thing");
  EXPECT_THAT(error_of("b.stl", kStlText.substr(0, 80)), HasSubstr("b.stl:6: "));

  std::string bytes(80, ' ');
  bytes.replace(0, 5, "solid");
  append(bytes, std::uint32_t{1}, std::endian::little);
  for (const float x : {0.f, 0.f, 1.f, 0.1f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f})
    append(bytes, x, std::endian::little);
  append(bytes, std::uint16_t{0}, std::endian::little);
  const Scene binary = read_scene(write("c.stl", bytes));
  EXPECT_EQ(binary.surfaces.at(0).polygon.outer,
            (std::vector<Vec3>{{static_cast<double>(0.1f), 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  bytes[0] = 'x';
  bytes.pop_back();
  EXPECT_THAT(error_of("d.stl", bytes), HasSubstr("truncated"));
}

TEST_F(Reader, BadInputIsOneClearLine) {
  EXPECT_THAT(error_of(path("none.obj")),
              AllOf(StartsWith(path("none.obj").string() + ": "), HasSubstr("no such file")));
  EXPECT_THAT(error_of("a.xyz", ""), HasSubstr("extension"));
  EXPECT_THAT(error_of("empty.obj", ""), HasSubstr("no faces"));
  EXPECT_THAT(error_of("nan.obj", "v 0 0 0\nv nan 0 0\nv 1 1 0\nf 1 2 3\n"),
              AllOf(HasSubstr("nan.obj:2: "), HasSubstr("not a finite number")));
  EXPECT_THAT(error_of("inf.obj", "v 0 0 0\nv 1 0 0\nv 1 -inf 0\nf 1 2 3\n"), HasSubstr("inf.obj:3: "));
  EXPECT_THAT(error_of("huge.obj", "v 0 0 1e999\n"), AllOf(HasSubstr("huge.obj:1: "), HasSubstr("range")));
  EXPECT_THAT(error_of("two.obj", square("f 1 2\n")), AllOf(HasSubstr("two.obj:5: "), HasSubstr("2 vertices")));
  EXPECT_THAT(error_of("range.obj", square("f 1 2 3\nf 1 2 9\n")),
              AllOf(HasSubstr("range.obj:6: "), HasSubstr("vertex 9"), HasSubstr("has 4")));
  EXPECT_THAT(error_of("zero.obj", square("f 0 1 2\n")), HasSubstr("zero.obj:5: "));
  EXPECT_THAT(error_of("before.obj", square("f -5 1 2\n")), HasSubstr("before.obj:5: "));
  EXPECT_THAT(error_of("word.obj", "v 0 zero 0\n"), AllOf(HasSubstr("word.obj:1: "), HasSubstr("\"zero\"")));
  EXPECT_THAT(error_of("short.obj", "v 0 0\n"), HasSubstr("short.obj:1: "));
  EXPECT_THAT(error_of("corner.obj", square("f 1,1 2 3\n")), HasSubstr("corner.obj:5: "));
}

TEST_F(Reader, BadMaterialsNameTheirOwnFile) {
  write("bright.mtl", "newmtl ok\nKd 0.5\nnewmtl bright\nKd 0.5 1 0.5\n");
  const auto used = write("used.obj", "mtllib bright.mtl\n" + square("usemtl bright\nf 1 2 3\n"));
  EXPECT_THAT(error_of(used), AllOf(HasSubstr("bright.mtl:3: "), HasSubstr("reflectance 1")));
  EXPECT_EQ(error_of("unused.obj", "mtllib bright.mtl\n" + square("usemtl ok\nf 1 2 3\n")), "");
  EXPECT_THAT(read_scene(used, {.keep_faults = true}).materials.at(0).rho, ElementsAre(0.5, 1, 0.5));
  write("dark.mtl", "newmtl dark\nKd 0.5\nKe -1 0 0\n");
  EXPECT_THAT(error_of("dark.obj", "mtllib dark.mtl\n" + square("usemtl dark\nf 1 2 3\n")), HasSubstr("dark.mtl:1: "));
  write("word.mtl", "newmtl word\nKd red\n");
  EXPECT_THAT(error_of("word.obj", "mtllib word.mtl\n" + square("usemtl word\nf 1 2 3\n")), HasSubstr("word.mtl:2: "));
}

double total_area(const Scene& scene) {
  double sum = 0;
  for (const Surface& s : scene.surfaces) sum += norm(area_vector(s.polygon));
  return sum;
}

TEST_F(Reader, NGonWithABridgedHoleBecomesAPolygonWithAHole) {
  const Scene scene = read_scene(write("hole.obj",
                                       "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nv 1 1 0\nv 1 3 0\nv 3 3 0\nv 3 1 0\n"
                                       "f 1 2 3 4 1 5 6 7 8 5\n"));
  ASSERT_EQ(scene.surfaces.size(), 1u);
  EXPECT_EQ(scene.surfaces[0].polygon.holes.size(), 1u);
  EXPECT_EQ(find_defect(scene.surfaces[0].polygon), PolygonDefect::none);
  EXPECT_EQ(total_area(scene), 12);
  EXPECT_THAT(scene.warnings.at(0), AllOf(HasSubstr("hole.obj:9"), HasSubstr("1 faces")));
}

TEST_F(Reader, CrossedFaceOfAMeshBecomesItsFan) {
  const Scene scene = read_scene(write("bow.obj", "v 0 0 0\nv 2 0 0\nv 0 1 0\nv 2 1 0\nf 1 2 3 4\n"));
  EXPECT_EQ(scene.surfaces.size(), 2u);
  for (const Surface& s : scene.surfaces) EXPECT_EQ(find_defect(s.polygon), PolygonDefect::none);
}

TEST_F(Reader, FacesWithoutAreaStayAndAreCounted) {
  const Scene scene = read_scene(write("flat.obj", square("f 1 2 2\nf 1 2 3\nf 1 1 1\n")));
  EXPECT_EQ(scene.surfaces.size(), 3u);
  EXPECT_THAT(scene.warnings.at(0), AllOf(HasSubstr("flat.obj:5"), HasSubstr("2 faces")));
}

}  // namespace
}  // namespace exitance
