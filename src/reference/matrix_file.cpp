#include "src/reference/matrix_file.h"

#include <stdexcept>

#include "src/reference/matrix_archive.h"
#include "src/reference/matrix_text.h"
#include "src/reference/matrix_triplets.h"
#include "src/scene/input_error.h"
#include "src/scene/mesh_file.h"

namespace exitance {
namespace {

void check_sizes(const MatrixRecord& record, MatrixFormat format) {
  const std::size_t rows = record.matrix.rows();
  const auto fits = [&](std::size_t size, bool is_needed) { return size == rows || (size == 0 && !is_needed); };
  const bool is_text = format == MatrixFormat::view3d;
  if (!fits(record.area.size(), format != MatrixFormat::triplets) || !fits(record.emissivity.size(), is_text) ||
      !fits(record.name.size(), false)) {
    throw std::invalid_argument("write_matrix: areas, emissivities or names do not match the rows");
  }
  if (format != MatrixFormat::archive && record.matrix.columns != rows)
    throw std::invalid_argument("write_matrix: only .h5 holds a matrix that is not square");
}

}  // namespace

MatrixRecord combine(const MatrixRecord& record, const FormFactorGroups& groups) {
  MatrixRecord result{.matrix = combine(record.matrix, record.area, groups),
                      .area = std::vector<double>(groups.count),
                      .name = std::vector<std::string>(record.name.empty() ? 0 : groups.count),
                      .mesh_hash = record.mesh_hash,
                      .manifest = record.manifest};
  for (std::size_t i = 0; i < record.area.size(); ++i) result.area[groups.group_of[i]] += record.area[i];
  for (std::size_t i = record.name.size(); i-- > 0;) result.name[groups.group_of[i]] = record.name[i];
  if (record.emissivity.empty()) return result;
  result.emissivity.assign(groups.count, 0);
  for (std::size_t i = 0; i < record.area.size(); ++i) {
    const std::uint32_t group = groups.group_of[i];
    result.emissivity[group] += record.area[i] / result.area[group] * record.emissivity[i];
  }
  return result;
}

MatrixFormat matrix_format(const std::filesystem::path& path) {
  const std::string extension = lower_extension(path);
  if (extension == ".h5") return MatrixFormat::archive;
  if (extension == ".csv") return MatrixFormat::triplets;
  if (extension == ".txt") return MatrixFormat::view3d;
  throw InputError(path.string(), 0,
                   "the extension \"" + extension + "\" is not one of a matrix; use .h5, .csv or .txt");
}

void write_matrix(const std::filesystem::path& path, const MatrixRecord& record) {
  const MatrixFormat format = matrix_format(path);
  check_sizes(record, format);
  if (format == MatrixFormat::archive) return write_matrix_archive(path, record);
  if (format == MatrixFormat::triplets) return write_matrix_triplets(path, record.matrix);
  write_matrix_text(path, record);
}

MatrixRecord read_matrix(const std::filesystem::path& path, std::optional<std::uint32_t> rows) {
  const MatrixFormat format = matrix_format(path);
  if (format == MatrixFormat::archive) return read_matrix_archive(path);
  if (format == MatrixFormat::triplets) return read_matrix_triplets(path, rows);
  return read_matrix_text(path);
}

}  // namespace exitance
