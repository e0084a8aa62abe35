#include "src/reference/matrix_triplets.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <tuple>

#include "src/output/whole_file.h"
#include "src/scene/input_error.h"
#include "src/scene/text_cursor.h"

namespace exitance {
namespace {

constexpr std::string_view kHeader = "i,j,F,F_error", kShortHeader = "i,j,F";
constexpr std::uint32_t kLargestIndex = std::numeric_limits<std::uint32_t>::max() - 1;

/// Where nobody knows how many rows there are, a wrong index must not ask for memory that no file of this size needs.
constexpr std::uint64_t kRowsAnyway = 100'000, kRowsPerEntry = 1'000;

struct Triplet {
  std::uint32_t i = 0, j = 0, line = 0;
  double F = 0, F_error = 0;
  auto place() const { return std::tuple{i, j, line}; }
};

class TripletReader {
 public:
  TripletReader(const std::filesystem::path& path, std::string_view bytes, std::optional<std::uint32_t> rows)
      : text_(path.string(), bytes), rows_(rows) {}

  MatrixRecord read() {
    const std::string_view header = text_.next_line() ? text_.rest_of_line() : std::string_view();
    if (header != kHeader && header != kShortHeader)
      text_.fail(fmt::format("the first line must be \"{}\" (or \"{}\"); is it a matrix?", kHeader, kShortHeader));
    fields_ = header == kHeader ? 4 : 3;
    while (text_.next_line()) {
      const std::string_view line = text_.rest_of_line();
      if (!line.empty()) read_triplet(line);
    }
    return {.matrix = make_matrix()};
  }

 private:
  void read_triplet(std::string_view line) {
    std::array<std::string_view, 4> field;
    std::size_t count = 0;
    for (std::size_t at = 0; at <= line.size(); ++count) {
      const std::size_t end = std::min(line.find(',', at), line.size());
      if (count < fields_) field[count] = trimmed(line.substr(at, end - at));
      at = end + 1;
    }
    if (count != fields_)
      text_.fail(fmt::format("{} values where {} belong; the file may be truncated", count, fields_));
    Triplet entry{.i = index(field[0]), .j = index(field[1]), .line = text_.line(), .F = text_.to_number(field[2])};
    if (!std::isfinite(entry.F)) text_.fail(fmt::format("the form factor {} is not a finite number", field[2]));
    entry.F_error = fields_ == 4 ? text_.to_number(field[3]) : std::numeric_limits<double>::infinity();
    if (!(entry.F_error >= 0)) text_.fail(fmt::format("the error {} is no error; it must be at least 0", field[3]));
    entries_.push_back(entry);
  }

  static std::string_view trimmed(std::string_view field) {
    const std::size_t first = field.find_first_not_of(" \t\r");
    return first == std::string_view::npos ? std::string_view()
                                           : field.substr(first, field.find_last_not_of(" \t\r") - first + 1);
  }

  std::uint32_t index(std::string_view field) const {
    const std::int64_t value = text_.to_integer(field);
    const std::int64_t limit = rows_ ? std::int64_t{*rows_} - 1 : std::int64_t{kLargestIndex};
    if (value < 0 || value > limit) text_.fail(fmt::format("the index {} is not within 0 … {}", value, limit));
    return static_cast<std::uint32_t>(value);
  }

  FormFactorMatrix make_matrix() {
    std::ranges::sort(entries_, {}, &Triplet::place);
    std::uint32_t rows = rows_.value_or(0);
    for (const Triplet& entry : entries_) {
      rows = std::max({rows, entry.i + 1, entry.j + 1});
      if (!rows_ && rows > kRowsAnyway + kRowsPerEntry * entries_.size())
        throw InputError(text_.file(), entry.line,
                         fmt::format("the index {} leaves nearly all rows without an entry; correct it", rows - 1));
    }
    FormFactorMatrix matrix;
    matrix.columns = rows;
    matrix.row_first.assign(std::size_t{rows} + 1, 0);
    const Triplet* last = nullptr;
    for (const Triplet& entry : entries_) {
      if (last != nullptr && last->i == entry.i && last->j == entry.j) {
        throw InputError(
            text_.file(), entry.line,
            fmt::format("entry {},{} is there already, in line {}; remove one", entry.i, entry.j, last->line));
      }
      last = &entry;
      ++matrix.row_first[entry.i + 1];
      matrix.column.push_back(entry.j);
      matrix.F.push_back(entry.F);
      matrix.F_error.push_back(entry.F_error);
    }
    for (std::size_t i = 0; i < rows; ++i) matrix.row_first[i + 1] += matrix.row_first[i];
    return matrix;
  }

  TextCursor text_;
  std::optional<std::uint32_t> rows_;
  std::size_t fields_ = 4;
  std::vector<Triplet> entries_;
};

}  // namespace

void write_triplets(std::ostream& out, const FormFactorMatrix& matrix) {
  out << kHeader << '\n';
  fmt::memory_buffer lines;
  for (std::size_t i = 0; i < matrix.rows(); ++i) {
    lines.clear();
    for (std::uint64_t k = matrix.row_first[i]; k < matrix.row_first[i + 1]; ++k) {
      if (matrix.F[k] == 0) continue;
      fmt::format_to(std::back_inserter(lines), "{},{},{:.17g},{:.17g}\n", i, matrix.column[k], matrix.F[k],
                     matrix.F_error[k]);
    }
    out.write(lines.data(), static_cast<std::streamsize>(lines.size()));
  }
}

void write_matrix_triplets(const std::filesystem::path& path, const FormFactorMatrix& matrix) {
  write_whole_file(path, [&](std::ostream& out) { write_triplets(out, matrix); });
}

MatrixRecord read_matrix_triplets(const std::filesystem::path& path, std::optional<std::uint32_t> rows) {
  const std::string bytes = read_bytes(path);
  return TripletReader(path, bytes, rows).read();
}

}  // namespace exitance
