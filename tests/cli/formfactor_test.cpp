// exitance formfactor: right numbers in every format, and runs that can be ended at any moment.

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numeric>

#include "src/reference/matrix_file.h"
#include "tests/cli/program.h"
#include "tests/cli/running.h"

namespace exitance {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// Unit squares one apart, and at a right angle along an edge (Hottel 1931).
constexpr double kOpposite = 0.19982489569838746, kAdjacent = 0.20004377607540313;

/// A unit cube as seen from within: floor and ceiling, of which the ceiling is in two, combined halves; four walls.
constexpr const char* kCube = R"(T cube with a divided ceiling
F 3
V  1  0 0 0
V  2  1 0 0
V  3  1 1 0
V  4  0 1 0
V  5  0 0 1
V  6  1 0 1
V  7  1 1 1
V  8  0 1 1
V  9  0.5 0 1
V 10  0.5 1 1
S  1  1 2 3 4    0 0  0.5  floor
S  2  9 5 8 10   0 0  0.6  ceiling
S  3  6 9 10 7   0 2  0.8  half
S  4  1 5 6 2    0 0  0.5  south
S  5  2 6 7 3    0 0  0.5  east
S  6  3 7 8 4    0 0  0.5  north
S  7  4 8 5 1    0 0  0.5  west
End
)";

class FormFactorTest : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return (scratch / name).string(); }

  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(scratch / name) << text;
    return path(name);
  }

  /// Runs it to FILE, expects the exit code, and returns what is in the file.
  MatrixRecord matrix(const std::string& scene, const std::string& options, const std::string& file, int code = 0) {
    const Outcome outcome = run("formfactor " + scene + " " + options + " -o " + path(file));
    EXPECT_EQ(outcome.code, code) << outcome.err;
    return read_matrix(scratch / file);
  }

  /// The report that is printed.
  nlohmann::json report(const std::string& scene, const std::string& options, const std::string& file, int code = 0) {
    const Outcome outcome = run("formfactor " + scene + " " + options + " --json -o " + path(file));
    EXPECT_EQ(outcome.code, code) << outcome.err;
    return nlohmann::json::parse(outcome.out);
  }

  void refused(int code, const std::string& arguments, const std::string& says) const {
    const Outcome outcome = run("formfactor " + arguments);
    EXPECT_EQ(outcome.code, code) << arguments << "\n" << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(says)) << arguments;
    EXPECT_EQ(outcome.out, "") << arguments;
  }

  const ScratchFolder scratch;
};

/// Files need not be text, and are not shown.
bool same_bytes(const std::filesystem::path& a, const std::filesystem::path& b) {
  return exists(a) && exists(b) && contents(a) == contents(b);
}

double at(const MatrixRecord& record, std::size_t i, std::uint32_t j) {
  const auto columns = record.matrix.row_columns(i);
  const auto found = std::ranges::find(columns, j);
  return found == columns.end() ? 0 : record.matrix.row(i)[static_cast<std::size_t>(found - columns.begin())];
}

double sum(std::span<const double> row) {
  return std::accumulate(row.begin(), row.end(), 0.0);
}

TEST_F(FormFactorTest, EveryFormatHoldsTheSameMatrix) {
  const std::string scene = data("furnace_cube.toml");
  const MatrixRecord h5 = matrix(scene, "", "cube.h5"), csv = matrix(scene, "", "cube.csv"),
                     txt = matrix(scene, "", "cube.txt");
  ASSERT_EQ(h5.matrix.rows(), 6u);
  for (std::size_t i = 0; i < 6; ++i) {
    ASSERT_EQ(h5.matrix.row(i).size(), 5u);
    int opposite = 0;
    for (std::size_t k = 0; k < 5; ++k) {
      const double F = h5.matrix.row(i)[k], error = h5.matrix.row_error(i)[k];
      const bool is_opposite = std::fabs(F - kOpposite) < std::fabs(F - kAdjacent);
      opposite += is_opposite;
      EXPECT_NEAR(F, is_opposite ? kOpposite : kAdjacent, error);
      EXPECT_LT(error, 1e-12);
    }
    EXPECT_EQ(opposite, 1);
  }
  EXPECT_EQ(csv.matrix.F, h5.matrix.F);
  EXPECT_EQ(csv.matrix.F_error, h5.matrix.F_error);
  EXPECT_EQ(csv.matrix.column, h5.matrix.column);
  EXPECT_EQ(txt.matrix.F, h5.matrix.F);
  EXPECT_EQ(txt.area, h5.area);
  EXPECT_THAT(h5.emissivity, testing::Each(0.5));
  EXPECT_EQ(txt.emissivity, h5.emissivity);
  EXPECT_THAT(h5.manifest, AllOf(HasSubstr("\"tolerance\""), HasSubstr("\"scene_hash\"")));
  EXPECT_THAT(h5.mesh_hash, testing::Not(testing::IsEmpty()));
  // Without a file, CSV on standard output and the report beside it.
  const Outcome printed = run("formfactor " + scene);
  EXPECT_EQ(printed.code, 0);
  EXPECT_EQ(printed.out, contents(scratch / "cube.csv"));
  EXPECT_THAT(printed.err, AllOf(HasSubstr("pairs open"), HasSubstr("memory: about"), HasSubstr("21 unordered"),
                                 HasSubstr("holds for 30 ordered pairs of rows"),
                                 HasSubstr("blocked <= unblocked  not measured, no pair is partial")));
  EXPECT_EQ(scratch.files(), 3u);  // no checkpoint stays
}

TEST_F(FormFactorTest, ReadsEveryFormatOfScenes) {
  const std::string square = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n0 1 1\n1 1 1\n1 0 1\n";
  std::string obj;
  std::istringstream lines(square);
  for (std::string line; std::getline(lines, line);) obj += "v " + line + "\n";
  const std::string facets[] = {"0 0 0 1 0 0 1 1 0", "0 0 0 1 1 0 0 1 0", "0 0 1 0 1 1 1 1 1", "0 0 1 1 1 1 1 0 1"};
  std::string stl = "solid s\n";
  for (const std::string& facet : facets) {
    std::istringstream numbers(facet);
    stl += "facet normal 0 0 0\nouter loop\n";
    for (int v = 0; v < 3; ++v) {
      std::string x, y, z;
      numbers >> x >> y >> z;
      stl += "vertex " + x + " " + y + " " + z + "\n";
    }
    stl += "endloop\nendfacet\n";
  }
  stl += "endsolid s\n";
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 8\nproperty double x\nproperty double y\nproperty double z\n"
      "element face 2\nproperty list uchar int vertex_indices\nend_header\n";
  const std::string faces = "4 0 1 2 3\n4 4 5 6 7\n";
  for (const std::string& scene :
       {write("two.obj", obj + "f 1 2 3 4\nf 5 6 7 8\n"), write("two.off", "OFF\n8 2 0\n" + square + faces),
        write("two.ply", ply + square + faces)}) {
    const MatrixRecord two = matrix(scene, "", "two.h5");
    ASSERT_EQ(two.matrix.rows(), 2u) << scene;
    EXPECT_NEAR(at(two, 0, 1), kOpposite, 1e-13) << scene;
    EXPECT_NEAR(at(two, 1, 0), kOpposite, 1e-13) << scene;
    EXPECT_EQ(matrix(scene, "--flip", "flipped.h5").matrix.F.size(), 0u) << scene;
    EXPECT_EQ(matrix(scene, "--two-sided", "sheets.h5").matrix.rows(), 4u) << scene;
  }
  const MatrixRecord triangles = matrix(write("two.stl", stl), "", "triangles.h5");
  ASSERT_EQ(triangles.matrix.rows(), 4u);
  EXPECT_NEAR((at(triangles, 0, 2) + at(triangles, 0, 3) + at(triangles, 1, 2) + at(triangles, 1, 3)) / 2, kOpposite,
              1e-13);
}

TEST_F(FormFactorTest, CombinedSurfacesHaveOneRowAtAnyPatchSize) {
  const std::string scene = write("cube.vs3", kCube);
  const MatrixRecord whole = matrix(scene, "", "whole.txt");
  ASSERT_EQ(whole.matrix.rows(), 6u);
  EXPECT_NEAR(at(whole, 0, 1), kOpposite, 1e-13);
  EXPECT_NEAR(at(whole, 1, 0), kOpposite, 1e-13);
  EXPECT_NEAR(at(whole, 1, 2), kAdjacent, 1e-13);
  EXPECT_DOUBLE_EQ(whole.area[1], 1);
  EXPECT_NEAR(whole.emissivity[1], 0.7, 1e-15);
  const MatrixRecord cut = matrix(scene, "--patch-size 0.5", "cut.h5");
  ASSERT_EQ(cut.matrix.rows(), 5 * 4 + 1u);
  EXPECT_EQ(cut.name[4], "ceiling");
  EXPECT_EQ(cut.name[5], "south");
  double to_ceiling = 0;
  for (std::size_t i = 0; i < 4; ++i) to_ceiling += at(cut, i, 4) / 4;
  EXPECT_NEAR(to_ceiling, kOpposite, 1e-13);
}

TEST_F(FormFactorTest, ObstructionsAndSurfacesWithoutAreaHaveNoRow) {
  const std::string scene =
      write("shaded.vs3",
            "F 3\nV 1 0 0 0\nV 2 1 0 0\nV 3 1 1 0\nV 4 0 1 0\nV 5 0 0 1\nV 6 1 0 1\nV 7 1 1 1\nV 8 0 1 1\n"
            "V 9 -9 -9 0.5\nV 10 9 -9 0.5\nV 11 9 9 0.5\nV 12 -9 9 0.5\n"
            "S 1 1 2 3 4 0 0 1 low\nO 2 9 10 11 12 0 0 1 shade\nS 3 8 7 6 5 0 0 1 high\nE\n");
  const Outcome outcome = run("formfactor " + scene);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "i,j,F,F_error\n");
  const auto shaded = report(scene, "", "shaded.h5");
  EXPECT_EQ(shaded.at("rows"), 2);
  EXPECT_EQ(shaded.at("pairs").at("blocked"), 1);
  const std::string flat = write("flat.obj",
                                 "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 1 1 0\nv 0 0 1\nv 1 1 1\nv 2 0 1\n"
                                 "f 1 2 3\nf 1 3 4\nf 5 6 7\n");
  const auto two = report(flat, "", "flat.h5");
  EXPECT_EQ(two.at("rows"), 2);
  EXPECT_THAT(two.at("warnings").dump(), HasSubstr("1 surfaces have no area and no row"));
}

TEST_F(FormFactorTest, ClosedBoxSumsToOneWithinItsErrors) {
  const std::string scene = data("box_on_floor.toml");
  const auto told = report(scene, "--patch-size 1", "box.h5");
  const MatrixRecord box = read_matrix(scratch / "box.h5");
  ASSERT_EQ(box.matrix.rows(), 58u);
  double worst = 0;
  for (std::size_t i = 0; i < box.matrix.rows(); ++i) {
    const double defect = std::fabs(sum(box.matrix.row(i)) - 1);
    worst = std::max(worst, defect);
    EXPECT_LE(defect, sum(box.matrix.row_error(i)) + 1e-13) << i;
    for (std::size_t k = 0; k < box.matrix.row(i).size(); ++k) EXPECT_LE(box.matrix.row_error(i)[k], 1e-9);
  }
  EXPECT_NEAR(told.at("closure_max_defect"), worst, 1e-15);
  EXPECT_EQ(told.at("closed"), true);
  EXPECT_EQ(told.at("unreached"), 0);
  EXPECT_EQ(told.at("patches"), 58);
  std::uint64_t pairs = 0;
  for (const auto& [name, count] : told.at("pairs").items()) pairs += count.get<std::uint64_t>();
  EXPECT_EQ(pairs, 58u * 59 / 2);
  EXPECT_GT(told.at("pairs").at("partial"), 0);
  EXPECT_GT(told.at("pairs").at("open"), 0);
  EXPECT_GT(told.at("points"), 0);
  EXPECT_GT(told.at("reciprocity_pairs"), 32);
  EXPECT_LT(told.at("reciprocity_max_defect"), 2e-9);
  EXPECT_GT(told.at("reciprocity_max_defect"), 0);  // two integrals, not one divided twice
  EXPECT_EQ(told.at("failed").size(), 0u);
  EXPECT_GT(told.at("estimated_memory_bytes"), 0);
  for (const char* key : {"version", "commit", "compiler", "libraries", "threads", "seed", "scene_hash", "options"})
    EXPECT_TRUE(told.at("manifest").contains(key)) << key;
  const Outcome words = run("formfactor " + scene + " --patch-size 1 --tolerance 1e-4 -o " + path("words.csv"));
  EXPECT_THAT(words.out, testing::ContainsRegex("F <= min\\(1, A_j/A_i\\)  holds for [0-9]+ ordered pairs"));
  EXPECT_THAT(words.out, testing::ContainsRegex("blocked <= unblocked  holds for [0-9]+ unordered pairs"));
}

TEST_F(FormFactorTest, ContactsAndOpenScenesHaveNoClosure) {
  const auto open = report(data("cornell_box.toml"), "--tolerance 1e-5", "open.csv");
  EXPECT_EQ(open.at("closed"), false);
  EXPECT_TRUE(open.at("closure_max_defect").is_null());
  EXPECT_EQ(open.at("closure_worst").at("none_because"), "the scene is open");
  EXPECT_LE(open.at("largest_row_sum"), 1 + 1e-4);
  // Blocks stand on an uncut floor, which sees their undersides where they are.
  const auto contact = report(data("cornell_box_closed.toml"), "--tolerance 1e-5", "contact.csv");
  EXPECT_EQ(contact.at("closed"), true);
  EXPECT_TRUE(contact.at("closure_max_defect").is_null());
  EXPECT_THAT(contact.at("closure_worst").at("none_because"), HasSubstr("contacts"));
  refused(3, data("cornell_box.toml") + " --close-rows -o " + path("closed.csv"), "the scene is open");
  EXPECT_FALSE(exists(scratch / "closed.csv.parts"));
}

TEST_F(FormFactorTest, ClosedRowsStandInASecondFile) {
  const std::string scene = data("box_on_floor.toml"), size = "--patch-size 1 --tolerance 1e-5 ";
  const MatrixRecord alone = matrix(scene, size, "alone.h5");
  const auto told = report(scene, size + "--close-rows", "box.h5");
  EXPECT_TRUE(same_bytes(scratch / "alone.h5", scratch / "box.h5"));
  const MatrixRecord closed = read_matrix(scratch / "box.closed.h5");
  ASSERT_EQ(closed.matrix.column, alone.matrix.column);
  double largest = 0;
  for (std::size_t i = 0; i < closed.matrix.rows(); ++i) {
    EXPECT_NEAR(sum(closed.matrix.row(i)), 1, 1e-12);
    for (std::size_t k = 0; k < closed.matrix.row(i).size(); ++k) {
      const std::uint32_t j = closed.matrix.row_columns(i)[k];
      EXPECT_NEAR(closed.area[i] * at(closed, i, j), closed.area[j] * at(closed, j, static_cast<std::uint32_t>(i)),
                  1e-14);
      const double change = std::fabs(closed.matrix.row(i)[k] - alone.matrix.row(i)[k]);
      EXPECT_GE(closed.matrix.row_error(i)[k], change);
      largest = std::max(largest, change);
    }
  }
  EXPECT_GT(largest, 0);
  EXPECT_DOUBLE_EQ(told.at("rows_closed").at("largest_change"), largest);
  EXPECT_THAT(closed.manifest, HasSubstr("rows_closed"));
  EXPECT_THAT(alone.manifest, testing::Not(HasSubstr("rows_closed")));
}

TEST_F(FormFactorTest, AnyNumberOfThreadsGivesTheSameBytes) {
  for (const std::string format : {".h5", ".csv", ".txt"}) {
    const std::string options = "--patch-size 1 --tolerance 1e-7 --close-rows --threads ";
    matrix(data("box_on_floor.toml"), options + "1", "one" + format);
    matrix(data("box_on_floor.toml"), options + "2", "two" + format);
    EXPECT_TRUE(same_bytes(scratch / ("one" + format), scratch / ("two" + format))) << format;
    EXPECT_TRUE(same_bytes(scratch / ("one.closed" + format), scratch / ("two.closed" + format))) << format;
  }
}

TEST_F(FormFactorTest, RefusesWhatItCannotDo) {
  const std::string scene = data("furnace_cube.toml");
  refused(3, scene + " -o " + path("cube.mat"), ".mat");
  refused(3, scene + " -o " + path("cube"), "use .h5, .csv or .txt");
  refused(2, scene + " --json", "--json");
  refused(2, scene + " --close-rows", "--close-rows");
  refused(2, scene + " --unknown", "--unknown");
  refused(2, scene + " --tolerance 0", "--tolerance");
  refused(2, scene + " --relative -1", "--relative");
  refused(2, scene + " --patch-size -1", "patch");
  refused(2, scene + " --threads 0", "--threads");
  refused(2, "", "SCENE");
  refused(3, "no_such_scene.obj", "no_such_scene.obj");
  refused(3, write("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"), "no surface has an area");
  std::ofstream(scratch / "file") << "no folder";
  refused(3, scene + " -o " + path("file/cube.h5"), "file/cube.h5.parts");
  refused(4, scene + " --patch-size 0.1 --memory-limit 0.001 -o " + path("big.h5"), "form factors of 600 patches");
  EXPECT_FALSE(exists(scratch / "big.h5.parts"));
  EXPECT_FALSE(exists(scratch / "big.h5"));
}

class ResumeTest : public FormFactorTest {
 protected:
  ResumeTest() { EXPECT_EQ(run(command("whole.h5")).code, 0); }

  std::string command(const std::string& file, const std::string& options = "--tolerance 1e-10") const {
    return "formfactor " + data("box_on_floor.toml") + " --patch-size 0.6 --threads 1 --save-every 0 " + options +
           " -o " + path(file);
  }
  /// Whether so many parts of rows are saved.
  static std::function<bool()> saved(const std::filesystem::path& checkpoint, std::size_t parts) {
    return [=] { return files_with(".h5", checkpoint) >= parts; };
  }
  void expect_whole(const std::string& file) const {
    EXPECT_TRUE(same_bytes(scratch / file, scratch / "whole.h5"));
    EXPECT_FALSE(exists(scratch / (file + ".parts")));
  }
};

TEST_F(ResumeTest, AfterAKill) {
  const auto parts = scratch / "killed.h5.parts";
  EXPECT_EQ(Running(command("killed.h5")).end_when(saved(parts, 3), SIGKILL), -1);
  EXPECT_FALSE(exists(scratch / "killed.h5"));
  EXPECT_EQ(Running(command("killed.h5")).end_when(saved(parts, 7), SIGKILL), -1);  // and once more
  const Outcome resumed = run(command("killed.h5", "--tolerance 1e-10 --json"));
  EXPECT_EQ(resumed.code, 0) << resumed.err;
  EXPECT_GE(nlohmann::json::parse(resumed.out).at("resumed_rows"), 7);
  expect_whole("killed.h5");
}

TEST_F(ResumeTest, AfterAnInterrupt) {
  EXPECT_EQ(Running(command("paused.h5")).end_when(saved(scratch / "paused.h5.parts", 1), SIGINT), 4);
  EXPECT_FALSE(exists(scratch / "paused.h5"));
  EXPECT_TRUE(exists(scratch / "paused.h5.parts"));
  EXPECT_EQ(run(command("paused.h5")).code, 0);
  expect_whole("paused.h5");
}

TEST_F(ResumeTest, NotFromDamagedPartsOrThoseOfAnotherRun) {
  EXPECT_EQ(Running(command("box.h5")).end_when(saved(scratch / "box.h5.parts", 3), SIGKILL), -1);
  const Outcome other = run(command("box.h5", "--tolerance 1e-11"));
  EXPECT_EQ(other.code, 3);
  EXPECT_THAT(other.err, AllOf(HasSubstr("box.h5.parts/part-000001.h5"), HasSubstr("tolerance 1e-10"),
                               HasSubstr("another run"), HasSubstr("remove")));
  const auto part = scratch / "box.h5.parts" / "part-000002.h5";
  std::string bytes = contents(part);
  for (std::size_t k = bytes.size() / 4; k < bytes.size() / 2; ++k) bytes[k] = static_cast<char>(bytes[k] ^ 0x55);
  std::ofstream(part, std::ios::binary) << bytes;
  const Outcome damaged = run(command("box.h5"));
  EXPECT_EQ(damaged.code, 3);
  EXPECT_THAT(damaged.err, AllOf(HasSubstr("part-000002.h5"), HasSubstr("remove it, and its rows are computed again")));
  EXPECT_FALSE(exists(scratch / "box.h5"));
  std::filesystem::remove(part);
  EXPECT_EQ(run(command("box.h5")).code, 0);
  expect_whole("box.h5");
}

}  // namespace
}  // namespace exitance
