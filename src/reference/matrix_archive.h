#pragma once
// Form-factor matrices in archives (.h5): "row_first", "column", "F" and "F_error" as in FormFactorMatrix, "columns",
// "area", "emissivity", "name", "mesh_hash" and "manifest".

#include <filesystem>

#include "src/reference/matrix_file.h"

namespace exitance {

/// See write_matrix and read_matrix. Reading also checks that the parts make a matrix: DamagedFile where not.
void write_matrix_archive(const std::filesystem::path& path, const MatrixRecord& record);
MatrixRecord read_matrix_archive(const std::filesystem::path& path);

}  // namespace exitance
