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

TEST_F(BadInputTest, PatchesThatWouldNotFitInMemory) {
  const std::string cube = data("furnace_cube.toml");
  for (const char* size : {"1e-5", "1e-30", "1e-320"}) {
    const std::string with_size = cube + " --patch-size " + size;
    for (const char* method : {" --method shoot", ""}) expect_of_scene(4, with_size + method, "patches");
    expect(4, "formfactor " + with_size + " -o " + (scratch / "F.h5").string(), "patches");
    expect(4, "reference " + with_size + " -o " + (scratch / "R.h5").string(), "patches");
  }
  EXPECT_FALSE(std::filesystem::exists(scratch / "F.h5.parts"));
  EXPECT_FALSE(std::filesystem::exists(scratch / "R.h5.parts"));
}

TEST_F(BadInputTest, Folders) {
  const std::string file = write("file", "");
  expect(3, "solve " + data("furnace_cube.toml") + " -o " + file, file);
  expect(3, "solve " + data("furnace_cube.toml") + " -o " + file + "/below", file);
  expect(3, "generate furnished-room --polygons 500 -o " + file + "/below.obj", file);
}

TEST_F(BadInputTest, NamesThatAreTooLongOrNoFiles) {
  const std::string cube = data("furnace_cube.toml"), long_name(300, 'x');
  expect_of_scene(3, long_name + ".obj", "no such file");
  std::filesystem::create_symlink("/dev/zero", scratch / "zero.obj");
  expect_of_scene(3, (scratch / "zero.obj").string(), "is a device");
  expect_of_scene(3, write("long.toml", "[[object]]\nmesh = \"" + long_name + ".obj\"\n"), "long.toml:2: ");
  expect_of_scene(3, write("device.toml", "[[object]]\nmesh = \"/dev/zero\"\n"), "device.toml:2: ");
  write("room.obj", "v 0 0 0\n");
  expect_of_scene(3, write("nul.toml", "[[object]]\nmesh = \"room.obj\\u0000beyond\"\n"), "nul.toml:2: ");
  expect(3, "solve " + cube + " -o " + long_name, "too long");
  expect(3, "reference " + cube + " -o " + long_name + ".h5", "too long");
  const Outcome outcome =
      run("dynamic " + cube + " -o " + (scratch / "frames").string() + " --references " + long_name);
  EXPECT_EQ(outcome.code, 3);  // after a warning that nothing happens in the scene
  EXPECT_THAT(outcome.err, testing::HasSubstr("too long"));
  expect(3, "stress --count 1 -o " + long_name, "too long");
  expect(3, "cases " + long_name, "no such file");
  expect(3, "cases /dev/zero", "is a device");
  expect(3, "cases " + (scratch / ".").string(), "is a folder");
  expect(3, "diff " + long_name + " " + long_name, "no such file");
}

/// Of a line with a long name in it, the start and the end are told, in whole characters.
TEST_F(BadInputTest, NamesOfAnyLengthInOneShortLine) {
  for (const std::string lead : {"", "x", "xx"}) {
    std::string name = lead;
    for (int k = 0; k < 30'000; ++k) name += "€";
    const std::string scene = "[[material]]\nname = \"" + name + "\"\nrho = 1\n[[object]]\nmaterial = \"" + name +
                              "\"\nbox = {min = [0, 0, 0], max = [1, 1, 1]}\n";
    const Outcome outcome = run("solve " + write("name.toml", scene));
    EXPECT_EQ(outcome.code, 3);
    EXPECT_TRUE(outcome.one_line_on_stderr());
    EXPECT_LT(outcome.err.size(), 1100u);
    EXPECT_THAT(outcome.err, testing::HasSubstr("name.toml:1: material '" + lead + "€"));
    EXPECT_THAT(outcome.err, testing::EndsWith("below 1; lower it\n"));
    std::string rest = outcome.err;
    for (const std::string character : {"€", "…"}) {
      for (std::size_t at; (at = rest.find(character)) != std::string::npos;) rest.erase(at, character.size());
    }
    EXPECT_TRUE(std::ranges::all_of(rest, [](char c) { return (c & 0x80) == 0; })) << "no character is cut in two";
  }
}

TEST_F(BadInputTest, Usage) {
  const std::string cube = data("furnace_cube.toml");
  expect(2, "", "verb");
  expect(2, "paint", "paint");
  expect(2, "solve", "SCENE");
  expect_of_scene(2, cube + " --colour", "--colour");
  expect_of_scene(2, cube + " --method thermal", "gather,shoot");
  expect_of_scene(2, cube + " --visibility sampled", "exact");
  expect_of_scene(2, cube + " --receivers volume", "points");
  expect_of_scene(2, cube + " --patch-size wide", "--patch-size");
  expect_of_scene(2, cube + " --elements 0", "elements");
  expect_of_scene(2, cube + " --tolerance 0", "tolerance");
  expect_of_scene(2, cube + " --threads 0", "--threads");
  expect_of_scene(2, cube + " --shots 5", "--method shoot");
  expect(2, "generate furnished-room --polygons 5 -o x.obj", "--polygons");
  expect(2, "generate furnished-room --polygons 500 -o " + (scratch / "room.mtl").string(), "must end in .obj");
}

/// What is no number, not finite, or outside of an option's range is refused by every option that takes a number.
TEST_F(BadInputTest, Numbers) {
  const std::string solve = "solve " + data("furnace_cube.toml"),
                    formfactor = "formfactor " + data("furnace_cube.toml"),
                    reference = "reference " + data("furnace_cube.toml") + " -o " + (scratch / "r.h5").string(),
                    check = "check " + data("furnace_cube.toml") + " --closure 5",
                    cases = "cases " + write("cases.json", "{\"cases\":[]}"),
                    generate = "generate furnished-room -o " + (scratch / "room.obj").string() + " --polygons 500";
  struct Option {
    std::string verb, name;
    bool is_whole, may_be_zero;
  };
  const Option options[] = {{solve, "--form-factor-tolerance", false, false},
                            {solve, "--patch-size", false, true},
                            {solve, "--elements", true, false},
                            {solve, "--tolerance", false, false},
                            {solve + " --method shoot", "--shots", true, true},
                            {solve, "--time-limit", false, false},
                            {solve, "--memory-limit", false, false},
                            {solve, "--threads", true, false},
                            {solve, "--seed", true, true},
                            {formfactor, "--tolerance", false, false},
                            {formfactor, "--relative", false, true},
                            {formfactor, "--patch-size", false, true},
                            {formfactor, "--threads", true, false},
                            {formfactor, "--memory-limit", false, false},
                            {formfactor, "--save-every", false, true},
                            {formfactor, "--seed", true, true},
                            {reference, "--error", false, false},
                            {reference, "--patch-size", false, true},
                            {reference, "--time-limit", false, false},
                            {reference, "--memory-limit", false, false},
                            {reference, "--threads", true, false},
                            {reference, "--save-every", false, true},
                            {check, "--seed", true, true},
                            {check, "--threads", true, false},
                            {"check " + data("furnace_cube.toml"), "--closure", true, false},
                            {cases, "--tolerance", false, false},
                            {cases, "--threads", true, false},
                            {"generate furnished-room -o x.obj", "--polygons", true, false},
                            {generate, "--seed", true, true}};
  for (const Option& option : options) {
    std::vector<std::string> wrong = {"nan", "-1"};
    if (option.is_whole) wrong.push_back("1.5");
    if (!option.may_be_zero) wrong.push_back("0");
    for (const std::string& value : wrong)
      expect(2, option.verb + " " + option.name + " " + value, option.name + ": must be a ");
  }
  for (const char* value : {"-nan", "inf", "-inf", "1e999", "1e-999", "\"\"", "1x"})
    expect(2, solve + " --tolerance " + value, "--tolerance: must be a number above 0;");
  for (const char* value : {"nan", "inf", "1e3", "+", "\"\"", "1x", "18446744073709551616"})
    expect(2, solve + " --seed " + value, "--seed: must be a whole number from 0 to 2^64 - 1;");
  expect(2, solve + " --threads 99999999999", "--threads: must be a whole number from 1 to 1024;");
}

/// What makes `solve` refuse, `check` tells, with the same exit code.
TEST_F(BadInputTest, CheckRefusesWhatSolveRefuses) {
  const auto box = [](const std::string& more, const std::string& E = "1") {
    return "[[material]]\nname = \"m\"\nrho = 0.5\nE = " + E +
           "\n[[object]]\nmaterial = \"m\"\nflip = true\nbox = {min = [0, 0, 0], max = [1, 1, 1]}\n" + more;
  };
  const std::tuple<std::string, std::string, std::string> scenes[] = {
      {write("flat.toml", "[[object]]\npolygons = [[[0, 0, 0], [1, 1, 1], [3, 3, 3]]]\n"), "no surface has an area",
       "no_patch"},
      {write("obstructions.toml", box("obstruction_only = true\n")), "no surface has an area", "no_patch"},
      {write("large.toml", box("scale = 1e200\n")), "large.toml:8: a coordinate is 1e+200", "bad_extent"},
      {write("small.toml", box("scale = 1e-200\n")), "small.toml:8: no coordinate of the scene", "bad_extent"},
      {write("overflow.toml", box("scale = 1e300\n")), "overflow.toml:8: a coordinate is 1e+300", "bad_extent"},
      {write("speck.toml", box("[[object]]\npolygons = [[[0, 0, 0], [1e-30, 0, 0], [0, 1e-30, 0]]]\n")),
       "speck.toml:10: its area of 5e-61", "bad_extent"},
      {write("bright.toml", box("", "1e300")), "bright.toml:1: material 'm' has emission 1e+300", "reflectance"},
      {write("dim.toml", box("", "1e-300")), "dim.toml:1: material 'm' has emission 1e-300", "reflectance"}};
  for (const auto& [scene, says, kind] : scenes) {
    for (const char* verb : {"solve ", "formfactor "}) {
      const Outcome outcome = run(verb + scene);
      EXPECT_EQ(outcome.code, 3) << verb << scene;
      EXPECT_THAT(outcome.err, testing::HasSubstr(says)) << verb << scene;
    }
    const Outcome checked = run("check --json " + scene);
    EXPECT_EQ(checked.code, 3) << scene;
    EXPECT_THAT(checked.out, testing::HasSubstr("\"kind\": \"" + kind + "\"")) << scene;
  }
}

/// A terminal obeys control characters.
TEST_F(BadInputTest, BytesOfAFileAreNotEchoed) {
  const std::string bytes = "\x1b]0;title\x07\xff";
  for (const char* name : {"garbage.off", "garbage.vs3", "garbage.obj"}) {
    const Outcome outcome = run("solve " + write(name, "v " + bytes + "\n"));
    EXPECT_EQ(outcome.code, 3) << name;
    EXPECT_TRUE(outcome.one_line_on_stderr()) << name;
    EXPECT_EQ(outcome.err.find_first_of("\x1b\x07\xff"), std::string::npos) << name;
  }
  const Outcome named =
      run("check " + write("named.obj", "o \x1b[2J\nv 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 4\n"));
  EXPECT_EQ(named.out.find('\x1b'), std::string::npos);
  EXPECT_THAT(named.out, testing::HasSubstr("\\x1b[2J"));
}

TEST_F(BadInputTest, AMeshMustBeAMesh) {
  const std::string self = write("self.toml", "[[object]]\nmesh = \"self.toml\"\n");
  expect_of_scene(3, self, "self.toml:2: ");
  expect_of_scene(3, write("deep.toml", "a = " + std::string(100000, '[')), "deep.toml:1: ");
}

}  // namespace
}  // namespace exitance
