#include "src/reference/matrix_archive.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <span>

#include "src/output/archive.h"

namespace exitance {
namespace {

constexpr std::string_view kKind = "exitance form factors 1";

void check_matrix(const ArchiveReader& file, const FormFactorMatrix& matrix) {
  const std::size_t entries = matrix.column.size();
  if (matrix.row_first.empty() || matrix.row_first.front() != 0 || matrix.row_first.back() != entries ||
      !std::ranges::is_sorted(matrix.row_first)) {
    file.refuse(fmt::format("\"row_first\" does not ascend from 0 to the {} entries of \"column\"", entries));
  }
  if (matrix.F.size() != entries || matrix.F_error.size() != entries)
    file.refuse(fmt::format("\"column\", \"F\" and \"F_error\" have {}, {} and {} entries", entries, matrix.F.size(),
                            matrix.F_error.size()));
  for (std::size_t i = 0; i < matrix.rows(); ++i) {
    const auto columns = matrix.row_columns(i);
    if (std::ranges::adjacent_find(columns, std::greater_equal()) != columns.end() ||
        (!columns.empty() && columns.back() >= matrix.columns)) {
      file.refuse(fmt::format("\"column\" does not ascend below {} in row {}", matrix.columns, i));
    }
  }
  if (!std::ranges::all_of(matrix.F, [](double F) { return std::isfinite(F); }))
    file.refuse("\"F\" has an entry that is not a finite number");
  if (!std::ranges::all_of(matrix.F_error, [](double error) { return error >= 0; }))
    file.refuse("\"F_error\" has an entry that is no error");
}

}  // namespace

void write_matrix_archive(const std::filesystem::path& path, const MatrixRecord& record) {
  ArchiveWriter file(path, kKind);
  const std::vector<std::uint32_t> columns{record.matrix.columns};
  file.write("columns", std::span(columns));
  file.write("row_first", std::span(record.matrix.row_first));
  file.write("column", std::span(record.matrix.column));
  file.write("F", std::span(record.matrix.F));
  file.write("F_error", std::span(record.matrix.F_error));
  file.write("area", std::span(record.area));
  file.write("emissivity", std::span(record.emissivity));
  file.write("name", std::span(record.name));
  file.write("mesh_hash", record.mesh_hash);
  file.write("manifest", record.manifest);
  file.publish();
}

MatrixRecord read_matrix_archive(const std::filesystem::path& path) {
  const ArchiveReader file(path, kKind);
  MatrixRecord record;
  const std::vector<std::uint32_t> columns = file.uint32s("columns");
  if (columns.size() != 1) file.refuse("\"columns\" is not one number");
  record.matrix.columns = columns.front();
  record.matrix.row_first = file.uint64s("row_first");
  record.matrix.column = file.uint32s("column");
  record.matrix.F = file.doubles("F");
  record.matrix.F_error = file.doubles("F_error");
  record.area = file.doubles("area");
  record.emissivity = file.doubles("emissivity");
  record.name = file.texts("name");
  record.mesh_hash = file.text("mesh_hash");
  record.manifest = file.text("manifest");
  check_matrix(file, record.matrix);
  const auto fits = [&](std::size_t size) { return size == 0 || size == record.matrix.rows(); };
  if (!fits(record.area.size()) || !fits(record.emissivity.size()) || !fits(record.name.size()))
    file.refuse(fmt::format("\"area\", \"emissivity\" or \"name\" do not have one entry for each of {} rows",
                            record.matrix.rows()));
  return record;
}

}  // namespace exitance
