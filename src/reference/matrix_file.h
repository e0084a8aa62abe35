#pragma once
// Form-factor matrices in files, by their extension: .h5 (archive.h), .csv (triplets), .txt (View3D's output).

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "src/form_factor/form_factor_groups.h"
#include "src/form_factor/form_factor_matrix.h"

namespace exitance {

/// A matrix and what its rows stand for. Formats hold different parts of it: what they do not hold is empty after
/// reading, and F_error infinite.
struct MatrixRecord {
  FormFactorMatrix matrix = {};
  std::vector<double> area = {};           ///< of each row [m²]
  std::vector<double> emissivity = {};     ///< of each row, in [0, 1]
  std::vector<std::string> name = {};      ///< of each row
  std::string mesh_hash = {};              ///< of what the rows are parts of
  std::string manifest = {};               ///< JSON: what made the matrix, and how
  std::vector<std::string> warnings = {};  ///< what was noticed while reading
};

/// The record of groups: form factors as in combine(), areas added up, emissivities averaged over the area, each named
/// after its first patch. The record has areas; emissivities and names may be missing.
MatrixRecord combine(const MatrixRecord& record, const FormFactorGroups& groups);

enum class MatrixFormat { archive, triplets, view3d };

/// By the extension, in either case. Throws InputError for one that is not known, so that a long run can fail at its
/// start.
MatrixFormat matrix_format(const std::filesystem::path& path);

/// Writes the file whole or not at all. area is needed but for triplets, which hold only the matrix; .txt also needs
/// emissivity; the matrix is square but in .h5. Throws std::invalid_argument when the record's sizes do not fit each
/// other or the format, InputError when the file cannot be written.
void write_matrix(const std::filesystem::path& path, const MatrixRecord& record);

/// What write_matrix wrote, bit for bit (but for what the format does not hold), or another program. rows: how many a
/// .csv has where that is known; otherwise the last row or column with an entry is the last. Throws InputError with
/// file and line for what is malformed, DamagedFile for a damaged .h5.
MatrixRecord read_matrix(const std::filesystem::path& path, std::optional<std::uint32_t> rows = {});

}  // namespace exitance
