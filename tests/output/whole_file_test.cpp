#include "src/output/whole_file.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <stdexcept>
#include <string>
#include <thread>

#include "src/output/leftovers.h"
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

TEST(WholeFile, WhatKilledProcessesLeftOfItIsRemoved) {
  const ScratchFolder folder;
  const pid_t child = fork();
  if (child == 0) _exit(0);
  siginfo_t ended;
  waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOWAIT);
  const std::string dead = name_of_process(child), living = name_of_process(1);
  const auto leave = [&] { std::ofstream(folder / ("a.txt." + dead + ".part")) << "half"; };
  leave();
  for (const std::string& name : {living, dead + "x", std::string()})
    std::ofstream(folder / ("a.txt." + name + ".part"));
  for (const std::string name : {"a.txt.x", "b.txt."}) std::ofstream(folder / (name + dead + ".part"));
  write_whole_file(folder / "a.txt", kText);
  EXPECT_FALSE(exists(folder / ("a.txt." + dead + ".part"))) << "nobody has taken notice of its end";
  waitpid(child, nullptr, 0);
  leave();
  write_whole_file(folder / "a.txt", kText);
  EXPECT_FALSE(exists(folder / ("a.txt." + dead + ".part")));
  EXPECT_EQ(folder.files(), 6u) << "those of living processes, of other hosts and files, and what is no draft";
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

TEST(WholeFile, FollowsLinks) {
  const ScratchFolder folder;
  std::filesystem::create_directory(folder / "below");
  write_whole_file(folder / "there", [](std::ostream& out) { out << "old"; });
  std::filesystem::create_symlink("there", folder / "link");
  std::filesystem::create_symlink("link", folder / "link_to_link");
  std::filesystem::create_symlink("../not_yet_there", folder / "below" / "dangling");
  write_whole_file(folder / "link_to_link", kText);
  write_whole_file(folder / "below" / "dangling", kText);
  EXPECT_EQ(contents(folder / "there"), "new");
  EXPECT_EQ(contents(folder / "not_yet_there"), "new");
  for (const auto& link : {folder / "link", folder / "link_to_link", folder / "below" / "dangling"})
    EXPECT_TRUE(std::filesystem::is_symlink(link)) << link;
  EXPECT_EQ(folder.files(), 5u);
}

TEST(WholeFile, LinksInACircleAreRefused) {
  const ScratchFolder folder;
  std::filesystem::create_symlink("b", folder / "a");
  std::filesystem::create_symlink("a", folder / "b");
  EXPECT_THROW(write_whole_file(folder / "a", kText), InputError);
  EXPECT_EQ(folder.files(), 2u);
}

TEST(WholeFile, AFifoIsWrittenToAndStays) {
  const ScratchFolder folder;
  ASSERT_EQ(mkfifo((folder / "fifo").c_str(), 0600), 0);
  std::filesystem::create_symlink("fifo", folder / "link");
  for (const char* name : {"fifo", "link"}) {
    std::string read;
    std::jthread reader([&] { read = contents(folder / "fifo"); });
    write_whole_file(folder / name, kText);
    reader.join();
    EXPECT_EQ(read, "new") << name;
    EXPECT_TRUE(std::filesystem::is_fifo(folder / "fifo"));
  }
  EXPECT_EQ(folder.files(), 2u);
}

TEST(WholeFile, AFullDeviceIsAnError) {
  EXPECT_THROW(write_whole_file("/dev/full", kText), InputError);
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/full"));
}

/// What an open file holds already, which /proc names by its number, stays.
TEST(WholeFile, AnOpenFileIsAddedTo) {
  const ScratchFolder folder;
  const int file = open((folder / "a.txt").c_str(), O_CREAT | O_WRONLY | O_CLOEXEC, 0600);
  ASSERT_EQ(write(file, "first ", 6), 6);
  write_whole_file("/proc/self/fd/" + std::to_string(file), kText);
  close(file);
  EXPECT_EQ(contents(folder / "a.txt"), "first new");
}

}  // namespace
}  // namespace exitance
