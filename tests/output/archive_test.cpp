#include "src/output/archive.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <signal.h>
#include <sys/resource.h>

#include <bit>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <limits>
#include <numeric>
#include <thread>

#include "tests/output/damage.h"
#include "tests/output/error_of.h"

namespace exitance {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

constexpr std::string_view kKind = "test 1";

std::vector<std::uint64_t> bits(const std::vector<double>& values) {
  std::vector<std::uint64_t> result;
  for (const double value : values) result.push_back(std::bit_cast<std::uint64_t>(value));
  return result;
}

struct Contents {
  std::vector<double> reals{
      0.1, -0.0, 0, 5e-324, std::numeric_limits<double>::max(), std::numeric_limits<double>::infinity(), std::nan("7")};
  std::vector<std::uint64_t> counts{0, std::numeric_limits<std::uint64_t>::max()};
  std::vector<std::uint32_t> indices{4294967295u, 3, 2};
  std::vector<std::uint8_t> marks{255, 0, 1};
  std::vector<std::string> names{"floor", "", "größer als die anderen"};
  std::string text = "{\"lines\": \"a\nb\"}";

  bool operator==(const Contents& other) const {
    return bits(reals) == bits(other.reals) && counts == other.counts && indices == other.indices &&
           marks == other.marks && names == other.names && text == other.text;
  }
};

void write(const std::filesystem::path& path, const Contents& contents) {
  ArchiveWriter file(path, kKind);
  file.write("reals", std::span<const double>(contents.reals));
  file.write("counts", std::span<const std::uint64_t>(contents.counts));
  file.write("indices", std::span<const std::uint32_t>(contents.indices));
  file.write("marks", std::span<const std::uint8_t>(contents.marks));
  file.write("names", std::span<const std::string>(contents.names));
  file.write("text", contents.text);
  file.publish();
}

Contents read(const std::filesystem::path& path) {
  const ArchiveReader file(path, kKind);
  return {file.doubles("reals"), file.uint64s("counts"), file.uint32s("indices"),
          file.uint8s("marks"),  file.texts("names"),    file.text("text")};
}

TEST(Archive, ComesBackBitForBit) {
  const ScratchFolder folder;
  const Contents contents;
  write(folder / "a.h5", contents);
  EXPECT_EQ(read(folder / "a.h5"), contents);
  EXPECT_EQ(folder.files(), 1u);
}

TEST(Archive, HoldsEmptyVectorsAndManyChunks) {
  const ScratchFolder folder;
  Contents contents{
      .reals = std::vector<double>(200'001), .counts = {}, .indices = {}, .marks = {}, .names = {}, .text = ""};
  for (std::size_t i = 0; i < contents.reals.size(); ++i) contents.reals[i] = std::sin(static_cast<double>(i));
  write(folder / "a.h5", contents);
  EXPECT_EQ(read(folder / "a.h5"), contents);
}

TEST(Archive, TheSameContentsAreTheSameBytes) {
  const ScratchFolder folder;
  write(folder / "a.h5", {});
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // HDF5 counts times in seconds
  write(folder / "b.h5", {});
  EXPECT_EQ(contents(folder / "a.h5"), contents(folder / "b.h5"));
}

TEST(Archive, WhatIsNotPublishedLeavesTheEarlierFile) {
  const ScratchFolder folder;
  write(folder / "a.h5", {});
  const std::string before = contents(folder / "a.h5");
  {
    ArchiveWriter file(folder / "a.h5", kKind);
    file.write("text", "other");
  }
  EXPECT_EQ(contents(folder / "a.h5"), before);
  EXPECT_EQ(folder.files(), 1u);
}

// Every byte: flipping one is noticed, or hits one that holds nothing.
TEST(Archive, EveryFlippedByteIsNoticedOrHarmless) {
  const ScratchFolder folder;
  const Contents whole;
  write(folder / "a.h5", whole);
  const std::string bytes = contents(folder / "a.h5");
  const auto damaged = folder / "damaged.h5";
  std::size_t noticed = 0;
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    for (const unsigned flip : {0xffu, 0x01u}) {
      put(damaged, flipped(bytes, at, flip));
      try {
        ASSERT_EQ(read(damaged), whole) << "byte " << at << " of " << bytes.size() << ", " << flip;
      } catch (const InputError& error) {
        EXPECT_THAT(error.what(), StartsWith(damaged.string()));
        ++noticed;
      }
    }
  }
  EXPECT_GT(noticed, bytes.size() / 4);
}

TEST(Archive, AFlippedByteInTheValuesNamesThem) {
  const ScratchFolder folder;
  std::vector<double> noise(100'000);
  for (std::size_t i = 0; i < noise.size(); ++i) noise[i] = std::sin(static_cast<double>(i * i));
  {
    ArchiveWriter file(folder / "a.h5", kKind);
    file.write("noise", std::span<const double>(noise));
    file.publish();
  }
  const std::string bytes = contents(folder / "a.h5");
  for (const double share : {0.1, 0.5, 0.9}) {
    put(folder / "a.h5", flipped(bytes, static_cast<std::size_t>(share * static_cast<double>(bytes.size())), 0x10));
    const ArchiveReader file(folder / "a.h5", kKind);
    EXPECT_THROW(file.doubles("noise"), DamagedFile);
    EXPECT_THAT(error_of([&] { file.doubles("noise"); }),
                AllOf(HasSubstr("\"noise\" is damaged"), HasSubstr("etcher32")));
  }
}

TEST(Archive, EveryTruncationIsNoticed) {
  const ScratchFolder folder;
  write(folder / "a.h5", {});
  const std::string bytes = contents(folder / "a.h5");
  for (std::size_t length = 0; length < bytes.size(); length += 1 + length / 50) {
    put(folder / "a.h5", bytes.substr(0, length));
    EXPECT_THROW(read(folder / "a.h5"), DamagedFile) << length;
  }
}

TEST(Archive, WhatIsMissingOrOfAnotherTypeIsNamed) {
  const ScratchFolder folder;
  write(folder / "a.h5", {});
  const ArchiveReader file(folder / "a.h5", kKind);
  EXPECT_TRUE(file.holds("reals"));
  EXPECT_FALSE(file.holds("other"));
  EXPECT_THAT(error_of([&] { file.doubles("other"); }), HasSubstr("\"other\" is missing"));
  EXPECT_THAT(error_of([&] { file.doubles("counts"); }), HasSubstr("\"counts\" holds values of another type"));
  EXPECT_THAT(error_of([&] { file.uint32s("reals"); }), HasSubstr("another type"));
  EXPECT_THAT(error_of([&] { file.doubles("names"); }), HasSubstr("another type"));
  EXPECT_THAT(error_of([&] { file.texts("reals"); }), HasSubstr("no texts"));
  EXPECT_THAT(error_of([&] { file.text("names"); }), HasSubstr("3 texts, not one"));
}

TEST(Archive, ForeignFilesAreNamed) {
  const ScratchFolder folder;
  write(folder / "a.h5", {});
  EXPECT_THAT(error_of([&] { ArchiveReader(folder / "a.h5", "form factors"); }),
              HasSubstr("holds test 1, not form factors"));
  EXPECT_THAT(error_of([&] { ArchiveReader(folder / "none.h5", kKind); }), HasSubstr("no such file"));
  put(folder / "text.h5", "not HDF5 at all");
  EXPECT_THROW(ArchiveReader(folder / "text.h5", kKind), DamagedFile);
  const hid_t other = H5Fcreate((folder / "other.h5").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  H5Fclose(other);
  EXPECT_THAT(error_of([&] { ArchiveReader(folder / "other.h5", kKind); }), HasSubstr("is not an archive of test 1"));
  EXPECT_THAT(error_of([&] { ArchiveWriter(folder / "missing" / "a.h5", kKind); }), HasSubstr("No such file"));
}

// A limit on the size of files stands for a full disk.
TEST(Archive, AFullDiskIsAnErrorThatTheProgramSurvivesAndLeavesNothing) {
  const ScratchFolder folder;
  const auto path = folder / "a.h5";
  const auto write_too_much = [&] {
    signal(SIGXFSZ, SIG_IGN);
    const rlimit small{100'000, 100'000};
    setrlimit(RLIMIT_FSIZE, &small);
    std::vector<double> noise(1'000'000);
    for (std::size_t i = 0; i < noise.size(); ++i) noise[i] = std::sin(static_cast<double>(i * i));
    const std::string error = error_of([&] {
      ArchiveWriter file(path, kKind);
      file.write("noise", std::span<const double>(noise));
      file.publish();
    });
    fmt::print(stderr, "{}\n", error);
    std::exit(0);
  };
  EXPECT_EXIT(write_too_much(), testing::ExitedWithCode(0),
              AllOf(StartsWith(path.string()), HasSubstr("cannot be written (File too large); choose")));
  EXPECT_EQ(folder.files(), 0u);
}

}  // namespace
}  // namespace exitance
