#pragma once
// Form-factor matrices as lines of text (.csv): "i,j,F,F_error", counted from 0, without the entries that are zero, 17
// significant digits.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <ostream>

#include "src/reference/matrix_file.h"

namespace exitance {

/// Rows ascending, columns ascending in a row.
void write_triplets(std::ostream& out, const FormFactorMatrix& matrix);

/// The same, as a file that is written whole or not at all.
void write_matrix_triplets(const std::filesystem::path& path, const FormFactorMatrix& matrix);

/// See read_matrix. Entries may come in any order. The header may also be "i,j,F", of programs that know no error.
/// Throws InputError for another header, a line without as many numbers, numbers that are malformed or not finite (an
/// error may be infinite), an error below 0, an index of `rows` or above, or, where `rows` is not given, so
/// large that nearly all rows would be empty (100,000 and 1,000 an entry), an entry that is there twice.
MatrixRecord read_matrix_triplets(const std::filesystem::path& path, std::optional<std::uint32_t> rows);

}  // namespace exitance
