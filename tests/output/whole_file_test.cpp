#include "src/output/whole_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "src/scene/input_error.h"
#include "tests/output/scratch_folder.h"

namespace exitance {
namespace {

const auto kText = [](std::ostream& out) { out << "new"; };

TEST(WholeFile, ReplacesAnEarlierOne) {
  const ScratchFolder folder;
  write_whole_file(folder / "a.txt", [](std::ostream& out) { out << "a much longer old text"; });
  write_whole_file(folder / "a.txt", kText);
  EXPECT_EQ(contents(folder / "a.txt"), "new");
  EXPECT_EQ(folder.files(), 1u);
}

TEST(WholeFile, TheEarlierOneStaysWhileAndWhenWritingFails) {
  const ScratchFolder folder;
  const auto path = folder / "a.txt";
  write_whole_file(path, kText);
  const auto fail_half_way = [&](std::ostream& out) {
    out << "half" << std::flush;
    EXPECT_EQ(contents(path), "new");
    throw std::domain_error("on purpose");
  };
  EXPECT_THROW(write_whole_file(path, fail_half_way), std::domain_error);
  EXPECT_EQ(contents(path), "new");
  EXPECT_EQ(folder.files(), 1u);
}

TEST(WholeFile, AStreamThatFailedIsNotRenamed) {
  const ScratchFolder folder;
  const auto path = folder / "a.txt";
  write_whole_file(path, kText);
  EXPECT_THROW(write_whole_file(path, [](std::ostream& out) { out.setstate(std::ios::badbit); }), InputError);
  EXPECT_EQ(contents(path), "new");
  EXPECT_EQ(folder.files(), 1u);
}

TEST(WholeFile, AMissingFolderIsNamed) {
  const ScratchFolder folder;
  const auto path = folder / "missing" / "a.txt";
  try {
    write_whole_file(path, kText);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::AllOf(testing::StartsWith(path.string()), testing::HasSubstr("No such file")));
  }
}

TEST(WholeFile, AFolderInTheWayIsAnErrorAndLeavesNothingBehind) {
  const ScratchFolder folder;
  std::filesystem::create_directories(folder / "a.txt" / "inside");
  EXPECT_THROW(write_whole_file(folder / "a.txt", kText), InputError);
  EXPECT_EQ(folder.files(), 1u);
}

}  // namespace
}  // namespace exitance
