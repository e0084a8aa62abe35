// Results that cannot be written must not get lost unnoticed.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/cli/program.h"
#include "tests/places.h"

namespace exitance {
namespace {

/// The exit code of the program when standard output is a disk that is full, and what it says.
Outcome on_a_full_disk(const std::string& arguments) {
  const ScratchFolder scratch;
  const std::string err = (scratch / "err").string();
  const int status = std::system((program() + " " + arguments + " >/dev/full 2>" + err + " </dev/null").c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, "", contents(err)};
}

TEST(StandardOutput, FailuresAreNoticed) {
  const ScratchFolder scratch;
  const std::string cases = (scratch / "cases.json").string(), cube = data("furnace_cube.toml");
  std::ofstream(cases) << "{\"cases\":[]}";
  for (const std::string& arguments :
       {"cases " + cases, "check " + cube, "check --json " + cube, "solve " + cube, "solve --json " + cube,
        "formfactor " + cube, "formfactor " + cube + " -o " + (scratch / "F.csv").string(),
        "reference " + cube + " -o " + (scratch / "r.h5").string(),
        "reference --json " + cube + " -o " + (scratch / "s.h5").string(),
        "generate furnished-room --polygons 100 -o " + (scratch / "room.obj").string(), std::string("--help"),
        std::string("--version"), std::string("solve --help")}) {
    const Outcome outcome = on_a_full_disk(arguments);
    EXPECT_EQ(outcome.code, 3) << arguments;
    EXPECT_THAT(outcome.err, testing::HasSubstr("exitance: standard output: cannot be written")) << arguments;
  }
}

TEST(StandardOutput, MayBeNamedAsAFile) {
  const ScratchFolder scratch;
  const std::string cases = (scratch / "cases.json").string();
  std::ofstream(cases) << "{\"cases\":[]}";
  const Outcome plain = run("cases " + cases), named = run("cases " + cases + " -o /dev/stdout");
  EXPECT_EQ(named.code, 0) << named.err;
  EXPECT_EQ(named.out, plain.out);
  EXPECT_EQ(run("cases " + cases + " -o /dev/full").code, 3);
}

}  // namespace
}  // namespace exitance
