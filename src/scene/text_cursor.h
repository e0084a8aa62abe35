#pragma once
// A cursor through the text of a mesh file: lines, tokens and correctly rounded numbers, whatever the locale.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace exitance {

/// The bytes of a file or a pipe. Throws InputError when there is none, it cannot be read, or is a device.
std::string read_bytes(const std::filesystem::path& path);

/// Whether a name that is given in a file names one, which has an end: no folder, device or pipe, nothing longer
/// than names may be and nothing with a NUL in it.
bool is_file(const std::filesystem::path& path);

/// Tokens are separated by blanks; a token that starts with '#' begins a comment, which lasts to the end of the line. A
/// backslash at the end of a line continues it (OBJ); carriage returns count as blanks.
class TextCursor {
 public:
  /// The text must outlive the cursor, which stands before the first line.
  TextCursor(std::string file, std::string_view text);

  bool next_line();                 ///< moves to the start of the next line; false at the end of the text
  std::string_view next_token();    ///< the next one of this line; empty at its end
  std::string_view rest_of_line();  ///< all that is left of this line, comments included, without blanks around it
  std::string_view token_across_lines();  ///< the next token of this or a later line; empty at the end of the text

  /// The next number of this line. Throws InputError when it is missing, malformed or out of a double's range; "nan"
  /// and "inf" are numbers.
  double number();
  double to_number(std::string_view token) const;         ///< the same for a token; empty counts as missing
  std::int64_t to_integer(std::string_view token) const;  ///< likewise, for a whole decimal number

  std::size_t end_of_line() const;  ///< offset in the text of what follows this line
  std::uint32_t line() const { return line_; }
  const std::string& file() const { return file_; }
  [[noreturn]] void fail(const std::string& what) const;  ///< throws an InputError that names this line

 private:
  void skip_blanks();

  std::string file_;
  std::string_view text_;
  std::size_t position_ = 0;
  std::uint32_t line_ = 0;
};

}  // namespace exitance
