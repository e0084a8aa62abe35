#include "src/form_factor/kept_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>
#include <span>
#include <stdexcept>

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

/// Puts the rows of a part behind those that are there.
void read_points(const ArchiveReader& file, FormFactorMatrix& F) {
  const std::vector<std::uint64_t> place = file.uint64s("first"), row_first = file.uint64s("row_first");
  const std::vector<std::uint32_t> column = file.uint32s("column");
  const std::vector<double> values = file.doubles("F"), errors = file.doubles("F_error");
  if (!is_list_of_rows(row_first, column.size()) || values.size() != column.size() || errors.size() != column.size())
    file.refuse("its vectors do not fit each other");
  if (place.size() != 1 || place[0] != F.rows()) file.refuse(fmt::format("its rows do not begin at {}", F.rows()));
  const std::uint64_t before = F.F.size();
  for (std::size_t k = 1; k < row_first.size(); ++k) F.row_first.push_back(before + row_first[k]);
  F.column.insert(F.column.end(), column.begin(), column.end());
  F.F.insert(F.F.end(), values.begin(), values.end());
  F.F_error.insert(F.F_error.end(), errors.begin(), errors.end());
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

std::vector<PairRows> kept_pairs(const Checkpoint& checkpoint) {
  std::vector<PairRows> all;
  std::set<std::uint32_t> seen;
  for (const std::filesystem::path& part : checkpoint.parts()) {
    all.push_back(read_pairs(checkpoint.open(part)));
    for (const std::uint32_t row : all.back().row) {
      if (!seen.insert(row).second)
        throw DamagedFile(part, fmt::format("holds row {}, which another file of its folder holds already", row));
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

PointRows kept_points(const Checkpoint& checkpoint, std::uint32_t columns) {
  PointRows rows;
  rows.F.columns = columns;
  for (const std::filesystem::path& part : checkpoint.parts()) {
    const ArchiveReader file = checkpoint.open(part);
    read_points(file, rows.F);
    rows.statistics = read_statistics(file);
  }
  return rows;
}

}  // namespace exitance
