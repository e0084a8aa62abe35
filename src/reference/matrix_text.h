#pragma once
// Form-factor matrices in the layout of View3D's text output (.txt):
//
//   View3D 3.3 0 1 0 6        program, its version, the controls out, encl and emit, the number of rows
//   1 1 1 1 1 1               areas
//   0 0.2 …                   a line for each row: form factors to all, zeros included
//   0.5 0.5 0.5 0.5 0.5 0.5   emissivities
//
// View3D itself gives six decimals; exitance writes 17 significant digits, and its own name.

#include <filesystem>

#include "src/reference/matrix_file.h"

namespace exitance {

/// See write_matrix.
void write_matrix_text(const std::filesystem::path& path, const MatrixRecord& record);

/// See read_matrix. Zeros make no entries. A file that says encl = 1 gets a warning: View3D has scaled its rows to sum
/// to
/// 1. Throws InputError for binary output, for emit = 1 (script-F factors, which are no form factors), a line with more
/// or fewer numbers than rows, numbers that are malformed or not finite, areas that are not positive, a file that ends
/// early or goes on.
MatrixRecord read_matrix_text(const std::filesystem::path& path);

}  // namespace exitance
