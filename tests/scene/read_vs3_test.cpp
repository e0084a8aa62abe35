#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "src/form_factor/area_form_factors.h"
#include "src/scene/input_error.h"
#include "src/scene/placement.h"
#include "src/scene/reader.h"
#include "src/scene/scene_check.h"
#include "tests/scene/scene_files.h"

namespace exitance {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

class Vs3 : public SceneFiles {
 protected:
  std::string error_of(std::string_view content, const ReadOptions& options = {}) const {
    try {
      read_scene(write("a.vs3", content), options);
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      return error.what();
    }
    return "";
  }
  std::string error_after_square(std::string_view line, const ReadOptions& options = {}) const {
    return error_of(std::string(kSquare) + std::string(line), options);
  }

  static constexpr std::string_view kSquare =
      "V 1 0 0 0\nV 2 1 0 0\nV 3 1 1 0\nV 4 0 1 0\nS 1 1 2 3 4 0 0 0.5 floor\n";  // 5 lines
};

std::vector<double> areas(const Scene& scene) {
  std::vector<double> found;
  for (const Surface& s : scene.surfaces) found.push_back(norm(area_vector(s.polygon)));
  return found;
}

TEST_F(Vs3, ReadsWhatTheManualDescribes) {
  const Scene scene = read_scene(write("two.VS3",
                                       "t Two squares \r\n"
                                       "! art |\\\n"
                                       "/ and more\n"
                                       "C  eps=1.e-4 maxU = 8, encl= 0\n"
                                       "\n"
                                       "F  3\r\n"
                                       "V  1   0.1   +0. 0.  ! a corner\n"
                                       "v  2   1,0,0\n"
                                       "V  3   1.\t1. 0.\n"
                                       "V  4   0.   1.   0.\n"
                                       "Surface 1 1 2 3 4 0 0 0.25 floor/1 / trailing\n"
                                       "s 2 4 3 2 0 0 0 1.0\n"
                                       "O 3 1 2 3 0\n"
                                       "o 4 1 2 3 4 0 0 0.5 shade\n"
                                       "End of data\n"
                                       "S nonsense\n"));
  EXPECT_EQ(scene.name, "Two squares");
  EXPECT_EQ(scene.bands, 1u);
  ASSERT_EQ(scene.surfaces.size(), 4u);
  EXPECT_EQ(scene.surfaces[0].polygon.outer, (std::vector<Vec3>{{0.1, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}));
  EXPECT_EQ(scene.surfaces[1].polygon.outer, (std::vector<Vec3>{{0, 1, 0}, {1, 1, 0}, {1, 0, 0}}));
  EXPECT_EQ(scene.surfaces[1].line, 12u);
  EXPECT_THAT(scene.materials[scene.surfaces[0].material].rho, ElementsAre(0.75));
  EXPECT_THAT(scene.materials[scene.surfaces[0].material].E, ElementsAre(0));
  EXPECT_THAT(scene.materials[scene.surfaces[1].material].rho, ElementsAre(0));
  std::vector<std::string> names;
  for (const Surface& s : scene.surfaces) names.push_back(scene.objects[s.object].name);
  EXPECT_THAT(names, ElementsAre("floor/1", "surface 2", "surface 3", "shade"));
  std::vector<bool> obstructs;
  for (const Surface& s : scene.surfaces) obstructs.push_back(s.obstruction_only);
  EXPECT_THAT(obstructs, ElementsAre(false, false, true, true));
  for (const Surface& s : scene.surfaces) EXPECT_EQ(s.group, kNoGroup);
  EXPECT_THAT(scene.warnings, ElementsAre());
}

TEST_F(Vs3, AnAsteriskEndsItAndATitleIsNotNeeded) {
  const Scene scene = read_scene(write("plain.vs3", std::string(kSquare) + "*\nnonsense\n"));
  EXPECT_EQ(scene.name, "plain");
  EXPECT_EQ(scene.surfaces.size(), 1u);
}

TEST_F(Vs3, ControlsThatWouldChangeResultsAreMentioned) {
  const Scene scene = read_scene(write("a.vs3", "C encl=1 emit = 1 row=2 col=0\n" + std::string(kSquare)));
  EXPECT_THAT(scene.warnings,
              ElementsAre(HasSubstr("a.vs3:1: encl"), HasSubstr("a.vs3:1: emit"), HasSubstr("a.vs3:1: row")));
}

TEST_F(Vs3, CombinedSurfacesAreAGroup) {
  const Scene scene =
      read_scene(write("a.vs3", std::string(kSquare) + "S 2 1 2 3 0 0 0 0.5 a\nS 3 1 2 4 0 0 2 0.5 b\n"
                                                       "S 4 1 2 3 4 0 0 0.5 c\nS 5 2 3 4 0 0 2 0.5 d\n"));
  std::vector<std::uint32_t> groups;
  for (const Surface& s : scene.surfaces) groups.push_back(s.group);
  EXPECT_THAT(groups, ElementsAre(kNoGroup, 0, 0, kNoGroup, 0));
}

// A wall of 4 × 3 with a window within, a door along its lower edge, and a pane within the window.
constexpr std::string_view kWall =
    "V 1 0 0 0\nV 2 4 0 0\nV 3 4 3 0\nV 4 0 3 0\n"
    "V 5 1 1 0\nV 6 2 1 0\nV 7 2 2 0\nV 8 1 2 0\n"
    "V 9 2.5 0 0\nV 10 3.5 0 0\nV 11 3.5 2 0\nV 12 2.5 2 0\n"
    "V 13 1.25 1.25 0\nV 14 1.75 1.25 0\nV 15 1.75 1.75 0\nV 16 1.25 1.75 0\n";  // 16 lines

TEST_F(Vs3, SubsurfacesAreCutOutOfTheirBase) {
  const Scene scene = read_scene(write("a.vs3", std::string(kWall) + "S 1 1 2 3 4 0 0 0.5 wall\n"
                                                                     "S 2 5 6 7 8 1 0 0.5 window\n"
                                                                     "S 3 9 10 11 12 1 0 0.5 door\n"
                                                                     "S 4 13 14 15 16 2 0 0.5 pane\n"));
  EXPECT_THAT(areas(scene), ElementsAre(12 - 1 - 2, 1 - 0.25, 2, 0.25));
  for (const Surface& s : scene.surfaces) EXPECT_EQ(s.group, kNoGroup);
  for (const Finding& finding : check_scene(scene).findings) EXPECT_NE(finding.kind, FindingKind::overlap_same_facing);
}

TEST_F(Vs3, ABaseInPiecesIsAGroup) {
  const Scene scene = read_scene(write("a.vs3",
                                       "V 1 0 0 0\nV 2 4 0 0\nV 3 4 1 0\nV 4 0 1 0\nV 5 1 0 0\nV 6 2 0 0\nV 7 2 1 0\n"
                                       "V 8 1 1 0\nS 1 1 2 3 4 0 0 0.5 wall\nS 2 5 6 7 8 1 0 0.25 stripe\n"));
  ASSERT_EQ(scene.surfaces.size(), 3u);
  EXPECT_EQ(scene.surfaces[0].group, 0u);
  EXPECT_EQ(scene.surfaces[1].group, 0u);
  EXPECT_EQ(scene.surfaces[2].group, kNoGroup);
  EXPECT_EQ(scene.surfaces[0].object, scene.surfaces[1].object);
  const std::vector<double> A = areas(scene);
  EXPECT_EQ(A[0] + A[1], 3);
}

TEST_F(Vs3, ObstructionsMayBeBasesAndNullSurfacesHideTheirs) {
  const Scene scene = read_scene(write("a.vs3", std::string(kWall) + "S 1 1 2 3 4 0 0 0.5 wall\n"
                                                                     "N 2 8 7 6 5 1 0 0.5 hidden\n"
                                                                     "S 3 13 14 15 16 4 0 0.5 lamp\n"
                                                                     "O 4 5 6 7 8\n"));
  EXPECT_THAT(areas(scene), ElementsAre(11, 1, 0.25, 0.75));
  std::vector<bool> obstructs;
  for (const Surface& s : scene.surfaces) obstructs.push_back(s.obstruction_only);
  EXPECT_THAT(obstructs, ElementsAre(false, true, false, true));
}

// A unit cube seen from inside, turned so that no coordinate of the window and of the door is representable in its
// wall's plane: were they left lying on it, an ulp would decide which of them is seen.
TEST_F(Vs3, ExchangeOfARotatedBaseIsTheWholesLessTheSubsurfaces) {
  const Placement turn{.linear = product(rotation({1, 2, 3}, 37), rotation({0, 0, 1}, 11)), .translation = {1, 2, 3}};
  std::string text;
  int number = 0;
  const auto vertex = [&](double x, double y, double z) {
    const Vec3 p = turn({x, y, z});
    text += fmt::format("V {} {:.17g} {:.17g} {:.17g}\n", ++number, p.x, p.y, p.z);
  };
  for (const double z : {0., 1.}) {
    vertex(0, 0, z);
    vertex(1, 0, z);
    vertex(1, 1, z);
    vertex(0, 1, z);
  }
  for (const auto& [x, z] : {std::pair{0.2, 0.3}, {0.4, 0.3}, {0.4, 0.7}, {0.2, 0.7}}) vertex(x, 0, z);
  for (const auto& [x, z] : {std::pair{0.6, 0.}, {0.8, 0.}, {0.8, 0.6}, {0.6, 0.6}}) vertex(x, 0, z);
  text +=
      "S 1 1 2 3 4 0 0 0.5 floor\nS 2 5 8 7 6 0 0 0.5 ceiling\nS 3 1 5 6 2 0 0 0.5 wall\nS 4 2 6 7 3 0 0 0.5 right\n"
      "S 5 3 7 8 4 0 0 0.5 back\nS 6 4 8 5 1 0 0 0.5 left\nS 7 9 12 11 10 3 0 0.5 window\nS 8 13 16 15 14 3 0 0.5 "
      "door\n";
  const Scene scene = read_scene(write("cube.vs3", text));
  ASSERT_EQ(scene.surfaces.size(), 8u);

  std::vector<Polygon> polygons;
  for (const Surface& s : scene.surfaces) polygons.push_back(s.polygon);
  const AreaFormFactors found = area_form_factors(ExchangeScene(PolygonSoup(polygons)), {.tolerance = 1e-5});
  const auto F = [&](std::size_t i, std::size_t j) { return found.F[i * found.n + j]; };
  EXPECT_NEAR(found.area[2], 1 - 0.08 - 0.12, 1e-12);
  // Opposite and adjacent faces of a cube (parallel squares' closed form; the rest by symmetry).
  constexpr double kOpposite = 0.19982489569838744, kAdjacent = (1 - kOpposite) / 4;
  EXPECT_NEAR(F(0, 2) + F(0, 6) + F(0, 7), kAdjacent, 3e-5);
  EXPECT_NEAR(F(4, 2) + F(4, 6) + F(4, 7), kOpposite, 3e-5);
  for (const std::size_t i : {2u, 6u, 7u}) {
    double sum = 0;
    for (std::size_t j = 0; j < 8; ++j) sum += F(i, j);
    EXPECT_NEAR(sum, 1, 8e-5) << i;
    for (const std::size_t j : {2u, 6u, 7u}) EXPECT_NEAR(F(i, j), 0, 1e-12);
  }
}

TEST_F(Vs3, BadLinesAreNamed) {
  EXPECT_THAT(error_of(""), HasSubstr("no surfaces"));
  EXPECT_THAT(error_of("V 1 0 0 0\n"), HasSubstr("no surfaces"));
  EXPECT_THAT(error_of("T x\nF 3a\n"), AllOf(HasSubstr("a.vs3:2: "), HasSubstr("F 3a")));
  EXPECT_THAT(error_of("F 2\n"), AllOf(HasSubstr("a.vs3:1: "), HasSubstr("F 2")));
  EXPECT_THAT(error_of("F\n"), HasSubstr("a.vs3:1: "));
  EXPECT_THAT(error_of("C eps=small\n"), AllOf(HasSubstr("a.vs3:1: "), HasSubstr("\"small\"")));
  EXPECT_THAT(error_of("C eps\n"), HasSubstr("a.vs3:1: "));
  EXPECT_THAT(error_of("V 1 0 0\n"), AllOf(HasSubstr("a.vs3:1: "), HasSubstr("missing")));
  EXPECT_THAT(error_of("V 1 0 zero 0\n"), AllOf(HasSubstr("a.vs3:1: "), HasSubstr("\"zero\"")));
  EXPECT_THAT(error_of("V 1 0 nan 0\n"), AllOf(HasSubstr("a.vs3:1: "), HasSubstr("not a finite")));
  EXPECT_THAT(error_of("V 1 0 1e999 0\n"), AllOf(HasSubstr("a.vs3:1: "), HasSubstr("range")));
  EXPECT_THAT(error_of("V 2 0 0 0\n"), AllOf(HasSubstr("a.vs3:1: "), HasSubstr("vertex 2 stands where 1 is next")));
  EXPECT_THAT(error_after_square("Z 1\n"), AllOf(HasSubstr("a.vs3:6: "), HasSubstr("\"Z\"")));
  EXPECT_THAT(error_after_square("M 2 4 3 2 1 1 0 0.5 m\n"), AllOf(HasSubstr("a.vs3:6: "), HasSubstr("masking")));
  EXPECT_THAT(error_after_square("X 1\n"), AllOf(HasSubstr("a.vs3:6: "), HasSubstr("transformations")));
}

TEST_F(Vs3, BadSurfacesAreNamed) {
  EXPECT_THAT(error_after_square("S 3 1 2 3 4 0 0 0.5 b\n"), AllOf(HasSubstr("a.vs3:6: "), HasSubstr("2 is next")));
  EXPECT_THAT(error_after_square("S 2 1 2 3 5 0 0 0.5 b\n"), AllOf(HasSubstr("a.vs3:6: "), HasSubstr("vertex 5")));
  EXPECT_THAT(error_after_square("S 2 1 2 0 4 0 0 0.5 b\n"), AllOf(HasSubstr("a.vs3:6: "), HasSubstr("vertex 0")));
  EXPECT_THAT(error_after_square("S 2 1 2 -3 4 0 0 0.5 b\n"), HasSubstr("a.vs3:6: "));
  EXPECT_THAT(error_after_square("S 2 1 2 3.5 4 0 0 0.5 b\n"), AllOf(HasSubstr("a.vs3:6: "), HasSubstr("\"3.5\"")));
  EXPECT_THAT(error_after_square("S 2 1 2 3\n"), AllOf(HasSubstr("a.vs3:6: "), HasSubstr("missing")));
  EXPECT_THAT(error_after_square("S 2 1 2 3 4 0 0\n"), AllOf(HasSubstr("a.vs3:6: "), HasSubstr("missing")));
  EXPECT_THAT(error_after_square("S 2 1 2 3 4 0 0 0 b\n"), AllOf(HasSubstr("a.vs3:6: "), HasSubstr("emissivity 0")));
  EXPECT_THAT(error_after_square("S 2 1 2 3 4 0 0 1.1 b\n"), HasSubstr("emissivity 1.1"));
  EXPECT_THAT(error_after_square("S 2 1 2 3 4 0 0 nan b\n"), HasSubstr("emissivity nan"));
  EXPECT_THAT(error_after_square("S 2 1 2 2 1 0 0 0.5 b\n"), AllOf(HasSubstr("a.vs3:6: "), HasSubstr("no area")));
  EXPECT_THAT(error_after_square("S 2 1 3 2 4 0 0 0.5 b\n"), AllOf(HasSubstr("a.vs3:6: "), HasSubstr("crosses")));
  EXPECT_EQ(error_after_square("S 2 1 3 2 4 0 0 1.5 b\n", {.keep_faults = true}), "");
  EXPECT_THAT(error_after_square("", {.flip = true}), HasSubstr("bare meshes"));
  EXPECT_THAT(error_after_square("", {.two_sided = true}), HasSubstr("bare meshes"));
}

TEST_F(Vs3, BadCombinationsAreNamed) {
  EXPECT_THAT(error_after_square("S 2 1 2 3 4 0 7 0.5 b\n"), AllOf(HasSubstr("a.vs3:6: "), HasSubstr("surface 7")));
  EXPECT_THAT(error_after_square("S 2 1 2 3 4 0 -1 0.5 b\n"), AllOf(HasSubstr("a.vs3:6: "), HasSubstr("negative")));
  EXPECT_THAT(error_after_square("S 2 1 2 3 4 0 2 0.5 b\n"), AllOf(HasSubstr("a.vs3:6: "), HasSubstr("before")));
  EXPECT_THAT(error_after_square("O 2 1 2 3 4\nS 3 1 2 3 4 0 2 0.5 b\n"),
              AllOf(HasSubstr("a.vs3:7: "), HasSubstr("surface 2")));
  EXPECT_THAT(error_after_square("S 2 1 2 3 4 0 1 0.5 b\nS 3 1 2 3 4 0 2 0.5 b\n"),
              AllOf(HasSubstr("a.vs3:7: "), HasSubstr("combined with 1")));
}

TEST_F(Vs3, BadSubsurfacesAreNamed) {
  const auto error_on_wall = [&](std::string_view lines) {
    return error_of(std::string(kWall) +
                    "V 17 1 1 0.001\nV 18 5 1 0\nV 19 5 2 0\nV 20 2 3 0\nS 1 1 2 3 4 0 0 0.5 wall\n" +
                    std::string(lines));
  };
  const auto at = [](int line, const char* what) {
    return AllOf(HasSubstr(fmt::format("a.vs3:{}: ", line)), HasSubstr(what));
  };
  EXPECT_THAT(error_on_wall("S 2 5 6 7 8 9 0 0.5 w\n"), at(22, "surface 9"));
  EXPECT_THAT(error_on_wall("S 2 5 6 7 8 2 0 0.5 w\n"), at(22, "before"));
  EXPECT_THAT(error_on_wall("S 2 8 7 6 5 1 0 0.5 w\n"), at(22, "faces against"));
  EXPECT_THAT(error_on_wall("N 2 5 6 7 8 1 0 0.5 w\n"), at(22, "faces the same way"));
  EXPECT_THAT(error_on_wall("N 2 8 7 6 5 0 0 0.5 w\n"), at(22, "has a base"));
  EXPECT_THAT(error_on_wall("N 2 8 7 6 5 1 0 0.5 w\nS 3 13 14 15 16 2 0 0.5 p\n"), at(23, "null surface"));
  EXPECT_THAT(error_on_wall("S 2 17 6 7 8 1 0 0.5 w\n"), at(22, "off the plane"));
  EXPECT_THAT(error_on_wall("S 2 6 18 19 7 1 0 0.5 w\n"), at(22, "does not lie within"));
  EXPECT_THAT(error_on_wall("S 2 8 7 20 0 1 0 0.5 w\n"), at(22, "corner"));
  EXPECT_THAT(error_on_wall("S 2 5 6 7 8 1 0 0.5 w\nS 3 13 14 15 16 1 0 0.5 p\n"), at(23, "overlap"));
  EXPECT_THAT(error_on_wall("S 2 1 2 3 4 1 0 0.5 w\n"), at(21, "leave nothing"));
}

}  // namespace
}  // namespace exitance
