// Bad input and bad usage: one clear line, the right exit code, nothing touched.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/cli/program.h"

namespace exitance {
namespace {

class BadInputTest : public testing::Test {
 protected:
  BadInputTest() {
    std::filesystem::create_directory(scratch / "results");
    for (const char* name : {"result.json", "solution.vtp", "solution.ply", "image.png"}) {
      std::ofstream(scratch / "results" / name) << "earlier";
    }
  }

  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(scratch / name) << text;
    return (scratch / name).string();
  }

  void expect(int code, const std::string& arguments, const std::string& says) const {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, code) << arguments << "\n" << outcome.err;
    EXPECT_TRUE(outcome.one_line_on_stderr()) << arguments << "\n" << outcome.err;
    EXPECT_THAT(outcome.err, testing::HasSubstr(says)) << arguments;
    EXPECT_EQ(outcome.out, "") << arguments;
    std::size_t files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(scratch / "results")) {
      EXPECT_EQ(contents(entry.path()), "earlier");
      ++files;
    }
    EXPECT_EQ(files, 4u);
  }

  void expect_of_scene(int code, const std::string& scene, const std::string& says) const {
    expect(code, "solve " + scene + " -o " + (scratch / "results").string(), says);
  }

  const ScratchFolder scratch;
};

TEST_F(BadInputTest, Scenes) {
  expect_of_scene(3, "no_such_file.obj", "no_such_file.obj");
  expect_of_scene(3, write("nan.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n"), "nan.obj:2: ");
  expect_of_scene(3, write("range.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n"), "range.obj:4: ");
  expect_of_scene(3, write("two.obj", "v 0 0 0\nv 1 0 0\nf 1 2\n"), "two.obj:3: ");
  expect_of_scene(3, write("flat.vs3", "F 2\n"), "flat.vs3:1: ");
  expect_of_scene(3, write("short.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n"), "short.off");
  expect_of_scene(3,
                  write("rho.toml",
                        "[[material]]\nname = \"m\"\nrho = 1\n[[object]]\nmaterial = \"m\"\n"
                        "box = {min = [0, 0, 0], max = [1, 1, 1]}\n"),
                  "rho.toml:1: ");
}

TEST_F(BadInputTest, SceneWithoutArea) {
  const Outcome outcome = run("solve " + write("line.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"));
  EXPECT_EQ(outcome.code, 3);  // beside the reader's warnings
  EXPECT_THAT(outcome.err, testing::HasSubstr("no surface has an area"));
}

TEST_F(BadInputTest, Folders) {
  const std::string file = write("file", "");
  expect(3, "solve " + data("furnace_cube.toml") + " -o " + file, file);
  expect(3, "solve " + data("furnace_cube.toml") + " -o " + file + "/below", file);
  expect(3, "generate furnished-room --polygons 500 -o " + file + "/below.obj", file);
}

TEST_F(BadInputTest, Usage) {
  const std::string cube = data("furnace_cube.toml");
  expect(2, "", "verb");
  expect(2, "paint", "paint");
  expect(2, "solve", "SCENE");
  expect_of_scene(2, cube + " --colour", "--colour");
  expect_of_scene(2, cube + " --method hierarchical", "gather,shoot");
  expect_of_scene(2, cube + " --visibility rays", "exact");
  expect_of_scene(2, cube + " --receivers volume", "points");
  expect_of_scene(2, cube + " --patch-size -1", "patch size");
  expect_of_scene(2, cube + " --patch-size nan", "patch size");
  expect_of_scene(2, cube + " --patch-size wide", "--patch-size");
  expect_of_scene(2, cube + " --elements 0", "elements");
  expect_of_scene(2, cube + " --tolerance 0", "tolerance");
  expect_of_scene(2, cube + " --threads 0", "--threads");
  expect_of_scene(2, cube + " --shots 5", "--method shoot");
  expect(2, "generate furnished-room --polygons 5 -o x.obj", "--polygons");
}

}  // namespace
}  // namespace exitance
