#include "src/output/result_folder.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <string>

#include "src/output/leftovers.h"
#include "src/scene/input_error.h"
#include "tests/output/scratch_folder.h"

namespace exitance {
namespace {

void write(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path) << text;
}

TEST(ResultFolder, PublishesAllAndLeavesNoDraft) {
  const ScratchFolder scratch;
  const auto folder = scratch / "new";
  {
    const ResultFolder results(folder);
    write(results.draft() / "a", "1");
    write(results.draft() / "b", "2");
    EXPECT_FALSE(exists(folder / "a"));
    results.publish();
  }
  EXPECT_EQ(contents(folder / "a"), "1");
  EXPECT_EQ(contents(folder / "b"), "2");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 2);
}

TEST(ResultFolder, WhatIsMadeBeforeANameIsTooLongIsRemoved) {
  const ScratchFolder scratch;
  EXPECT_THROW(ResultFolder(scratch / "new" / "below" / std::string(300, 'x')), InputError);
  EXPECT_FALSE(exists(scratch / "new"));
}

TEST(ResultFolder, DraftsOfKilledProcessesAreRemoved) {
  const ScratchFolder scratch;
  const pid_t dead = fork();
  if (dead == 0) _exit(0);
  waitpid(dead, nullptr, 0);
  const auto of_the_dead = scratch / (".draft." + name_of_process(dead));
  const auto of_the_living = scratch / (".draft." + name_of_process(1));
  const auto of_another_host = scratch / (".draft.x" + name_of_process(dead));
  for (const auto& draft : {of_the_dead, of_the_living, of_another_host}) create_directory(draft);
  write(of_the_dead / "a", "half");
  const ResultFolder results(scratch / "");
  EXPECT_FALSE(exists(of_the_dead));
  EXPECT_TRUE(exists(of_the_living));
  EXPECT_TRUE(exists(of_another_host));
}

TEST(ResultFolder, KeepsEarlierResultsUntilPublished) {
  const ScratchFolder scratch;
  write(scratch / "a", "earlier");
  {
    const ResultFolder results(scratch / "");
    write(results.draft() / "a", "later");
  }
  EXPECT_EQ(contents(scratch / "a"), "earlier");
  EXPECT_EQ(scratch.files(), 1u);
  {
    const ResultFolder results(scratch / "");
    write(results.draft() / "a", "later");
    results.publish();
  }
  EXPECT_EQ(contents(scratch / "a"), "later");
}

TEST(ResultFolder, LeavesNoFolderThatWasMadeForNothing) {
  const ScratchFolder scratch;
  { const ResultFolder results(scratch / "new"); }
  EXPECT_EQ(scratch.files(), 0u);
}

TEST(ResultFolder, RemovesTheParentsThatItMadeAndNoFolderThatWasThere) {
  const ScratchFolder scratch;
  { const ResultFolder results(scratch / "new/and/deep"); }
  EXPECT_EQ(scratch.files(), 0u);
  std::filesystem::create_directory(scratch / "empty");
  { const ResultFolder results(scratch / "empty"); }
  EXPECT_TRUE(std::filesystem::is_directory(scratch / "empty"));
}

TEST(ResultFolder, PublishesNothingWhereOneFileCannotBeReplaced) {
  const ScratchFolder scratch;
  write(scratch / "a", "earlier");
  std::filesystem::create_directory(scratch / "b");
  {
    const ResultFolder results(scratch / "");
    for (const char* name : {"a", "b", "c"}) write(results.draft() / name, "later");
    EXPECT_THROW(results.publish(), InputError);
  }
  EXPECT_EQ(contents(scratch / "a"), "earlier");
  EXPECT_EQ(scratch.files(), 2u);
}

TEST(ResultFolder, RefusesAFileInItsPlace) {
  const ScratchFolder scratch;
  write(scratch / "a", "");
  EXPECT_THROW(ResultFolder(scratch / "a"), InputError);
}

}  // namespace
}  // namespace exitance
