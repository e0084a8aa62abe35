#include "src/form_factor/kept_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>
#include <span>
#include <stdexcept>
#include <utility>

namespace exitance {
namespace {

/// Whether rows and entries are as many as `first` says.
bool is_list_of_rows(std::span<const std::uint64_t> first, std::size_t entries) {
  return !first.empty() && first.front() == 0 && first.back() == entries && std::ranges::is_sorted(first);
}

bool fits(const PairRows& rows) {
  const std::size_t pairs = rows.column.size();
  return rows.row_first.size() == rows.row.size() + 1 && is_list_of_rows(rows.row_first, pairs) &&
         rows.F.size() == pairs && rows.F_error.size() == pairs && rows.F_reverse.size() == pairs &&
         rows.F_reverse_error.size() == pairs && rows.mark.size() == pairs;
}

PairRows read_pairs(const ArchiveReader& file) {
  PairRows rows{.row = file.uint32s("row"),
                .row_first = file.uint64s("row_first"),
                .column = file.uint32s("column"),
                .F = file.doubles("F"),
                .F_error = file.doubles("F_error"),
                .F_reverse = file.doubles("F_reverse"),
                .F_reverse_error = file.doubles("F_reverse_error"),
                .mark = file.uint8s("mark")};
  if (!fits(rows)) file.refuse("its vectors do not fit each other");
  return rows;
}

constexpr std::size_t kCounts = 11, kSums = 2;

std::array<std::uint64_t, kCounts> counts_of(const PointRowStatistics& s) {
  return {s.pairs.facing_away, s.pairs.open, s.pairs.blocked,  s.pairs.partial, s.stages.filter, s.stages.interval,
          s.stages.exact,      s.extended,   s.covered_points, s.rays,          s.sampled};
}

std::array<double, kSums> sums_of(const PointRowStatistics& s) {
  return {s.closure_max_defect, s.standard_error_sum};
}

PointRowStatistics read_statistics(const ArchiveReader& file) {
  const std::vector<std::uint64_t> n = file.uint64s("counts");
  const std::vector<double> sums = file.doubles("sums");
  if (n.size() != kCounts || sums.size() != kSums) file.refuse("its statistics are not those of rows of points");
  return {.pairs = {n[0], n[1], n[2], n[3]},
          .stages = {n[4], n[5], n[6]},
          .extended = n[7],
          .covered_points = n[8],
          .closure_max_defect = sums[0],
          .rays = n[9],
          .sampled = n[10],
          .standard_error_sum = sums[1]};
}

/// The rows of a part that begins at row `first`, and the statistics of all up to its end.
PointRows read_points(const ArchiveReader& file, std::uint64_t first, std::uint32_t columns) {
  PointRows rows{.F = {.row_first = file.uint64s("row_first"),
                       .column = file.uint32s("column"),
                       .F = file.doubles("F"),
                       .F_error = file.doubles("F_error"),
                       .columns = columns},
                 .statistics = read_statistics(file)};
  const std::size_t entries = rows.F.column.size();
  if (!is_list_of_rows(rows.F.row_first, entries) || rows.F.F.size() != entries || rows.F.F_error.size() != entries)
    file.refuse("its vectors do not fit each other");
  if (file.uint64s("first") != std::vector{first}) file.refuse(fmt::format("its rows do not begin at {}", first));
  return rows;
}

}  // namespace

void keep_pairs(Checkpoint& checkpoint, const PairRows& rows) {
  if (!fits(rows)) throw std::invalid_argument("keep_pairs: the vectors of the rows do not fit each other");
  checkpoint.add([&](ArchiveWriter& file) {
    file.write("row", std::span(rows.row));
    file.write("row_first", std::span(rows.row_first));
    file.write("column", std::span(rows.column));
    file.write("F", std::span(rows.F));
    file.write("F_error", std::span(rows.F_error));
    file.write("F_reverse", std::span(rows.F_reverse));
    file.write("F_reverse_error", std::span(rows.F_reverse_error));
    file.write("mark", std::span(rows.mark));
  });
}

std::vector<PairRows> kept_pairs(Checkpoint& checkpoint) {
  std::vector<PairRows> all;
  std::set<std::uint32_t> seen;
  const std::vector<std::filesystem::path> parts = checkpoint.parts();
  for (const std::filesystem::path& part : parts) {
    try {
      PairRows rows = read_pairs(checkpoint.open(part));
      for (const std::uint32_t row : rows.row) {
        if (!seen.insert(row).second)
          throw DamagedFile(part, fmt::format("holds row {}, which another file of its folder holds already", row));
      }
      all.push_back(std::move(rows));
    } catch (const DamagedFile&) {
      if (!checkpoint.forgets()) throw;
      checkpoint.forget(part);
    }
  }
  return all;
}

void keep_points(Checkpoint& checkpoint, const PointRows& rows, std::size_t first) {
  const FormFactorMatrix& F = rows.F;
  const std::uint64_t begin = F.row_first[first], place = first;
  std::vector<std::uint64_t> row_first(F.row_first.begin() + static_cast<std::ptrdiff_t>(first), F.row_first.end());
  for (std::uint64_t& entry : row_first) entry -= begin;
  checkpoint.add([&](ArchiveWriter& file) {
    file.write("first", std::span(&place, 1));
    file.write("row_first", std::span<const std::uint64_t>(row_first));
    file.write("column", std::span(F.column).subspan(begin));
    file.write("F", std::span(F.F).subspan(begin));
    file.write("F_error", std::span(F.F_error).subspan(begin));
    file.write("counts", std::span<const std::uint64_t>(counts_of(rows.statistics)));
    file.write("sums", std::span<const double>(sums_of(rows.statistics)));
  });
}

PointRows kept_points(Checkpoint& checkpoint, std::uint32_t columns) {
  PointRows rows;
  rows.F.columns = columns;
  const std::vector<std::filesystem::path> parts = checkpoint.parts();
  for (auto part = parts.begin(); part != parts.end(); ++part) {
    try {
      const PointRows more = read_points(checkpoint.open(*part), rows.F.rows(), columns);
      append(rows.F, more.F);
      rows.statistics = more.statistics;
    } catch (const DamagedFile&) {
      std::for_each(part, parts.end(), [&](const std::filesystem::path& lost) { checkpoint.forget(lost); });
      break;
    }
  }
  return rows;
}

}  // namespace exitance
