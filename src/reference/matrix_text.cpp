#include "src/reference/matrix_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <span>

#include "src/output/manifest.h"
#include "src/output/whole_file.h"
#include "src/scene/text_cursor.h"

namespace exitance {
namespace {

constexpr std::size_t kHeaderWidth = 30;  // View3D fills its first line up to it

void append_line(fmt::memory_buffer& line, std::span<const double> values) {
  line.clear();
  for (std::size_t i = 0; i < values.size(); ++i) {
    fmt::format_to(std::back_inserter(line), "{}{:.17g}", i > 0 ? " " : "", values[i]);
  }
  line.push_back('\n');
}

class MatrixTextReader {
 public:
  MatrixTextReader(const std::filesystem::path& path, std::string_view bytes) : text_(path.string(), bytes) {}

  MatrixRecord read() {
    MatrixRecord record;
    read_header(record);
    record.area = read_line("area");
    if (!std::ranges::all_of(record.area, [](double area) { return area > 0; }))
      text_.fail("an area is not positive; correct it");
    record.matrix.columns = rows_;
    for (std::uint32_t i = 0; i < rows_; ++i) add_row(record.matrix, read_line("form factor"));
    record.emissivity = read_line("emissivity");
    while (text_.next_line()) {
      if (!text_.next_token().empty()) text_.fail(fmt::format("the file goes on after {} rows; correct line 1", rows_));
    }
    return record;
  }

 private:
  void read_header(MatrixRecord& record) {
    if (!text_.next_line()) text_.fail("the file is empty");
    const std::string_view program = text_.next_token(), version = text_.next_token();
    const std::int64_t out = count(), encl = count(), emit = count(), rows = count();
    if (rows < 1 || rows >= std::numeric_limits<std::uint32_t>::max() || out < 0)
      text_.fail(fmt::format("{} rows are announced; correct the last number of the line", rows));
    if (emit != 0) {
      text_.fail(
          "holds factors that include reflection (emit = 1, script F), not form factors; run View3D with emit=0");
    }
    if (encl != 0) {
      record.warnings.push_back(
          fmt::format("{}: {} {} has scaled the rows to sum to 1 (encl = 1)", text_.file(), program, version));
    }
    rows_ = static_cast<std::uint32_t>(rows);
  }

  std::int64_t count() {
    const std::string_view token = text_.next_token();
    if (token.empty() || token.find_first_not_of("0123456789") != std::string_view::npos)
      text_.fail(
          "is not the first line of a matrix, as in \"View3D 3.3 0 0 0 6\" (program, version, out, encl, emit, rows)");
    return text_.to_integer(token);
  }

  std::vector<double> read_line(const char* what) {
    if (!text_.next_line()) text_.fail(fmt::format("the file ends here; it is truncated ({} lines are missing)", what));
    std::vector<double> values;
    for (std::string_view token = text_.next_token(); !token.empty(); token = text_.next_token()) {
      values.push_back(text_.to_number(token));
      if (!std::isfinite(values.back())) text_.fail(fmt::format("\"{}\" is not a finite number; correct it", token));
    }
    if (values.size() != rows_)
      text_.fail(fmt::format("{} values where one {} for each of {} rows belongs; the file may be truncated",
                             values.size(), what, rows_));
    return values;
  }

  static void add_row(FormFactorMatrix& matrix, const std::vector<double>& row) {
    for (std::uint32_t j = 0; j < row.size(); ++j) {
      if (row[j] == 0) continue;
      matrix.column.push_back(j);
      matrix.F.push_back(row[j]);
      matrix.F_error.push_back(std::numeric_limits<double>::infinity());
    }
    matrix.row_first.push_back(matrix.column.size());
  }

  TextCursor text_;
  std::uint32_t rows_ = 0;
};

}  // namespace

void write_matrix_text(const std::filesystem::path& path, const MatrixRecord& record) {
  write_whole_file(path, [&](std::ostream& out) {
    const FormFactorMatrix& matrix = record.matrix;
    const std::string header = fmt::format("exitance {} 0 0 0 {}", build_manifest().version, matrix.rows());
    out << fmt::format("{:<{}}\n", header, kHeaderWidth);
    fmt::memory_buffer line;
    const auto write_line = [&](std::span<const double> values) {
      append_line(line, values);
      out.write(line.data(), static_cast<std::streamsize>(line.size()));
    };
    write_line(record.area);
    std::vector<double> row;
    for (std::size_t i = 0; i < matrix.rows(); ++i) {
      row.assign(matrix.columns, 0);
      for (std::size_t k = 0; k < matrix.row(i).size(); ++k) row[matrix.row_columns(i)[k]] = matrix.row(i)[k];
      write_line(row);
    }
    write_line(record.emissivity);
  });
}

MatrixRecord read_matrix_text(const std::filesystem::path& path) {
  const std::string bytes = read_bytes(path);
  return MatrixTextReader(path, bytes).read();
}

}  // namespace exitance
