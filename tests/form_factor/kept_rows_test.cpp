#include "src/form_factor/kept_rows.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <bit>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <span>
#include <stdexcept>
#include <tuple>

#include "tests/output/damage.h"
#include "tests/output/error_of.h"

namespace exitance {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr const char* kKey = "mesh 1234\ntolerance 1e-9\nversion 0.1";

// What a run computes for a row: any bits, and the same ones each time.
void append_row(PairRows& rows, std::uint32_t row) {
  std::mt19937_64 random(row);
  const auto number = [&] {
    for (;;) {
      const double value = std::bit_cast<double>(random());
      if (!std::isnan(value)) return value;
    }
  };
  rows.row.push_back(row);
  for (std::uint32_t column = row; column < row + row % 5; ++column) {
    rows.column.push_back(column);
    rows.F.push_back(number());
    rows.F_error.push_back(number());
    rows.F_reverse.push_back(number());
    rows.F_reverse_error.push_back(number());
    rows.mark.push_back(static_cast<std::uint8_t>(random()));
  }
  rows.row_first.push_back(rows.column.size());
}

PairRows some_rows(std::uint32_t first, std::uint32_t last) {
  PairRows rows;
  for (std::uint32_t row = first; row < last; ++row) append_row(rows, row);
  return rows;
}

bool operator==(const PairRows& a, const PairRows& b) {
  return a.row == b.row && a.row_first == b.row_first && a.column == b.column && a.F == b.F && a.F_error == b.F_error &&
         a.F_reverse == b.F_reverse && a.F_reverse_error == b.F_reverse_error && a.mark == b.mark;
}

std::set<std::uint32_t> rows_in(Checkpoint& checkpoint) {
  std::set<std::uint32_t> found;
  for (const PairRows& part : kept_pairs(checkpoint)) {
    PairRows expected;
    for (const std::uint32_t row : part.row) append_row(expected, row);
    EXPECT_TRUE(part == expected);
    found.insert(part.row.begin(), part.row.end());
  }
  return found;
}

TEST(KeptRows, RowsComeBackBitForBitInTheirOrder) {
  const ScratchFolder folder;
  const auto path = folder / "m.h5.parts";
  {
    Checkpoint checkpoint(path, kKey);
    EXPECT_TRUE(kept_pairs(checkpoint).empty());
    keep_pairs(checkpoint, some_rows(10, 30));
    keep_pairs(checkpoint, some_rows(0, 1));
    EXPECT_EQ(kept_pairs(checkpoint).size(), 2u);
  }
  Checkpoint checkpoint(path, kKey);
  keep_pairs(checkpoint, some_rows(40, 45));
  const std::vector<PairRows> parts = kept_pairs(checkpoint);
  ASSERT_EQ(parts.size(), 3u);
  EXPECT_TRUE(parts[0] == some_rows(10, 30));
  EXPECT_TRUE(parts[1] == some_rows(0, 1));
  EXPECT_TRUE(parts[2] == some_rows(40, 45));
}

TEST(KeptRows, DamageIsNoticedAndNamed) {
  const ScratchFolder folder;
  const auto path = folder / "a.parts";
  {
    Checkpoint checkpoint(path, kKey);
    keep_pairs(checkpoint, some_rows(0, 200));
    keep_pairs(checkpoint, some_rows(200, 400));
  }
  const auto damaged = path / "part-000002.h5";
  const std::string bytes = contents(damaged);
  std::size_t noticed = 0;
  for (std::size_t at = 0; at < bytes.size(); at += 97) {
    put(damaged, flipped(bytes, at));
    Checkpoint checkpoint(path, kKey);
    try {
      EXPECT_EQ(rows_in(checkpoint).size(), 400u) << at;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("part-000002.h5"));
      ++noticed;
    }
  }
  EXPECT_GT(noticed, bytes.size() / 97 / 2);
  for (const std::size_t length : {std::size_t{0}, std::size_t{1}, bytes.size() / 2, bytes.size() - 1}) {
    put(damaged, bytes.substr(0, length));
    Checkpoint checkpoint(path, kKey);
    EXPECT_THROW(kept_pairs(checkpoint), DamagedFile) << length;
  }
  // Removed, as the message says, it costs its own rows only, and a new part takes no old name.
  std::filesystem::remove(path / "part-000001.h5");
  put(damaged, bytes);
  Checkpoint checkpoint(path, kKey);
  EXPECT_EQ(rows_in(checkpoint).size(), 200u);
  keep_pairs(checkpoint, some_rows(0, 200));
  EXPECT_EQ(rows_in(checkpoint).size(), 400u);
}

TEST(KeptRows, ARowThatIsThereTwiceIsNoticed) {
  const ScratchFolder folder;
  Checkpoint checkpoint(folder / "a.parts", kKey);
  keep_pairs(checkpoint, some_rows(0, 3));
  keep_pairs(checkpoint, some_rows(2, 4));
  EXPECT_THAT(error_of([&] { kept_pairs(checkpoint); }), AllOf(HasSubstr("part-000002.h5"), HasSubstr("row 2")));
}

TEST(KeptRows, RowsThatDoNotFitAreRefused) {
  const ScratchFolder folder;
  Checkpoint checkpoint(folder / "a.parts", kKey);
  PairRows rows = some_rows(0, 3);
  rows.F_error.pop_back();
  EXPECT_THROW(keep_pairs(checkpoint, rows), std::invalid_argument);
  rows = some_rows(0, 3);
  rows.row.push_back(9);
  EXPECT_THROW(keep_pairs(checkpoint, rows), std::invalid_argument);
  EXPECT_TRUE(kept_pairs(checkpoint).empty());
}

PointRows some_points(std::uint32_t count) {
  const PairRows pairs = some_rows(0, count);
  PointRows rows;
  rows.F = {
      .row_first = pairs.row_first, .column = pairs.column, .F = pairs.F, .F_error = pairs.F_error, .columns = 99};
  rows.statistics = {.pairs = {count, 2, 3, 4},
                     .stages = {5, 6, 7},
                     .extended = 8,
                     .covered_points = 9,
                     .closure_max_defect = 0x1p-50,
                     .rays = 10,
                     .sampled = 11,
                     .standard_error_sum = 0.1};
  return rows;
}

void expect_same(const PointRows& a, const PointRows& b) {
  EXPECT_EQ(a.F.row_first, b.F.row_first);
  EXPECT_EQ(a.F.column, b.F.column);
  EXPECT_EQ(a.F.F, b.F.F);
  EXPECT_EQ(a.F.F_error, b.F.F_error);
  EXPECT_EQ(a.F.columns, b.F.columns);
  const PointRowStatistics &s = a.statistics, &t = b.statistics;
  EXPECT_EQ(s.pairs, t.pairs);
  EXPECT_EQ(
      std::tie(s.stages.filter, s.stages.interval, s.stages.exact, s.extended, s.covered_points, s.rays, s.sampled),
      std::tie(t.stages.filter, t.stages.interval, t.stages.exact, t.extended, t.covered_points, t.rays, t.sampled));
  EXPECT_EQ(s.closure_max_defect, t.closure_max_defect);
  EXPECT_EQ(s.standard_error_sum, t.standard_error_sum);
}

TEST(KeptRows, OfPointsComeBackWithTheirStatistics) {
  const ScratchFolder folder;
  {
    Checkpoint checkpoint(folder / "a.parts", kKey);
    EXPECT_EQ(kept_points(checkpoint, 99).F.rows(), 0u);
    keep_points(checkpoint, some_points(10), 0);
    keep_points(checkpoint, some_points(11), 10);
    keep_points(checkpoint, some_points(30), 11);
  }
  Checkpoint checkpoint(folder / "a.parts", kKey);
  expect_same(kept_points(checkpoint, 99), some_points(30));
}

TEST(KeptRows, OfPointsGoOnToTheFirstPartThatDoesNotFit) {
  const ScratchFolder folder;
  Checkpoint checkpoint(folder / "a.parts", kKey, Checkpoint::OtherRun::forgotten);
  keep_points(checkpoint, some_points(10), 0);
  keep_points(checkpoint, some_points(11), 10);
  keep_points(checkpoint, some_points(30), 11);
  checkpoint.forget(folder / "a.parts" / "part-000002.h5");
  expect_same(kept_points(checkpoint, 99), some_points(10));
  EXPECT_FALSE(exists(folder / "a.parts" / "part-000003.h5"));
  keep_points(checkpoint, some_points(30), 10);
  expect_same(kept_points(checkpoint, 99), some_points(30));
}

// Of a run that forgets: where a byte anywhere in the second of three parts is wrong, what can be read is as it was,
// and what cannot is no longer there.
TEST(KeptRows, DamagedOnesAreForgotten) {
  const ScratchFolder folder;
  const auto pairs = folder / "pairs", points = folder / "points";
  {
    Checkpoint checkpoint(pairs, kKey);
    for (const std::uint32_t first : {0, 100, 200}) keep_pairs(checkpoint, some_rows(first, first + 100));
  }
  {
    Checkpoint checkpoint(points, kKey);
    for (const std::uint32_t first : {0, 100, 200}) keep_points(checkpoint, some_points(first + 100), first);
  }
  std::map<std::filesystem::path, std::map<std::filesystem::path, std::string>> whole;
  for (const auto& path : {pairs, points}) {
    for (const auto& part : std::filesystem::directory_iterator(path)) whole[path][part.path()] = contents(part.path());
  }
  std::map<std::size_t, std::size_t> pairs_left, points_left;
  for (const auto& [path, parts] : whole) {
    const std::string bytes = parts.at(path / "part-000002.h5");
    for (std::size_t at = 0; at < bytes.size(); at += 197) {
      create_directory(path);  // that of a checkpoint in which nothing is left is gone
      for (const auto& [part, of_part] : parts) put(part, of_part);
      put(path / "part-000002.h5", flipped(bytes, at));
      Checkpoint checkpoint(path, kKey, Checkpoint::OtherRun::forgotten);
      if (path == pairs) {
        ++pairs_left[rows_in(checkpoint).size()];
      } else {
        const PointRows found = kept_points(checkpoint, 99);
        if (found.F.rows() > 0) expect_same(found, some_points(static_cast<std::uint32_t>(found.F.rows())));
        EXPECT_EQ(checkpoint.parts().size(), found.F.rows() / 100);
        ++points_left[found.F.rows()];
      }
    }
  }
  // Nothing where the part could not be opened, all where the byte has no meaning.
  for (const auto& [left, times] : pairs_left) EXPECT_TRUE(left == 0 || left == 200 || left == 300) << left;
  for (const auto& [left, times] : points_left) EXPECT_TRUE(left == 0 || left == 100 || left == 300) << left;
  EXPECT_GT(pairs_left[200], pairs_left[0] + pairs_left[300]);
  EXPECT_GT(points_left[100], points_left[0] + points_left[300]);
}

constexpr std::uint32_t kRows = 60, kRowsAtOnce = 3;

// A run in a process of its own: what is missing is computed, in blocks, and the number of finished rows is reported
// through the pipe after each.
[[noreturn]] void run(const std::filesystem::path& path, int report) {
  Checkpoint checkpoint(path, kKey);
  std::set<std::uint32_t> done = rows_in(checkpoint);
  PairRows block;
  for (std::uint32_t row = 0; row < kRows; ++row) {
    if (done.contains(row)) continue;
    append_row(block, row);
    if (block.row.size() < kRowsAtOnce && row + 1 < kRows) continue;
    keep_pairs(checkpoint, block);
    for (const std::uint32_t finished : block.row) {
      if (write(report, &finished, sizeof finished) != sizeof finished) _exit(1);
    }
    block = PairRows();
  }
  _exit(0);
}

// Kills the run with signal 9 as soon as it has reported so many more rows, or a little later.
void run_and_kill(const std::filesystem::path& path, std::size_t after, useconds_t later,
                  std::set<std::uint32_t>& reported) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    close(ends[0]);
    run(path, ends[1]);
  }
  close(ends[1]);
  std::uint32_t row = 0;
  std::size_t count = 0;
  while (count < after && read(ends[0], &row, sizeof row) == sizeof row) {
    EXPECT_TRUE(reported.insert(row).second) << "row " << row << " was computed again";
    ++count;
  }
  usleep(later);
  kill(child, SIGKILL);
  while (read(ends[0], &row, sizeof row) == sizeof row) {
    EXPECT_TRUE(reported.insert(row).second) << "row " << row << " was computed again";
  }
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFSIGNALED(status) || (WIFEXITED(status) && WEXITSTATUS(status) == 0));
}

TEST(KeptRows, NoReportedRowIsLostByKillingTheRun) {
  const ScratchFolder folder;
  const auto path = folder / "a.parts";
  std::set<std::uint32_t> reported;
  // At different points within a block: writing, waiting for the disk, renaming.
  for (useconds_t round = 0; round < 12; ++round) {
    run_and_kill(path, 3, 311 * round, reported);
    // A row that is on the disk but was not reported any more counts as finished by the next run, and is not reported.
    Checkpoint checkpoint(path, kKey);
    const std::set<std::uint32_t> saved = rows_in(checkpoint);
    for (const std::uint32_t row : reported) EXPECT_TRUE(saved.contains(row)) << row;
    EXPECT_LE(saved.size(), reported.size() + kRowsAtOnce * (round + 1));
    for (const auto& file : std::filesystem::directory_iterator(path)) EXPECT_EQ(file.path().extension(), ".h5");
  }
  run_and_kill(path, kRows, 0, reported);
  Checkpoint checkpoint(path, kKey);
  EXPECT_EQ(rows_in(checkpoint).size(), kRows);
  checkpoint.remove();
  EXPECT_EQ(folder.files(), 0u);
}

}  // namespace
}  // namespace exitance
