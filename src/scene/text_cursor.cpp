#include "src/scene/text_cursor.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <iterator>
#include <utility>

#include "src/scene/input_error.h"

namespace exitance {
namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v';
}

std::string quoted(std::string_view token) {
  constexpr std::size_t kLongest = 40;
  return fmt::format("\"{}{}\"", token.substr(0, kLongest), token.size() > kLongest ? "…" : "");
}

// std::from_chars takes no plus sign.
std::string_view without_plus(std::string_view token) {
  const bool plus = token.size() > 1 && token[0] == '+' && token[1] != '-';
  return plus ? token.substr(1) : token;
}

}  // namespace

std::string read_bytes(const std::filesystem::path& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) throw InputError(path.string(), 0, "no such file; check the path");
  if (std::filesystem::is_directory(status)) throw InputError(path.string(), 0, "is a folder; name a file in it");
  if (std::filesystem::is_character_file(status))
    throw InputError(path.string(), 0, "is a device, which may have no end; name a file or a pipe");
  std::ifstream stream(path, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  if (!stream.is_open() || stream.bad()) throw InputError(path.string(), 0, "cannot be read; check its permissions");
  return bytes;
}

bool is_file(const std::filesystem::path& path) {
  std::error_code ignored;
  const bool is_name = path.native().find('\0') == std::string::npos;  // the system would take what stands before
  return is_name && std::filesystem::is_regular_file(path, ignored);
}

TextCursor::TextCursor(std::string file, std::string_view text) : file_(std::move(file)), text_(text) {}

bool TextCursor::next_line() {
  if (line_ > 0) position_ = end_of_line();
  if (position_ >= text_.size()) return false;
  ++line_;
  return true;
}

std::size_t TextCursor::end_of_line() const {
  const std::size_t end = text_.find('\n', position_);
  return end == std::string_view::npos ? text_.size() : end + 1;
}

void TextCursor::skip_blanks() {
  while (position_ < text_.size()) {
    if (is_blank(text_[position_])) {
      ++position_;
      continue;
    }
    if (text_[position_] != '\\') return;
    std::size_t end = position_ + 1;
    while (end < text_.size() && text_[end] == '\r') ++end;
    if (end >= text_.size() || text_[end] != '\n') return;
    position_ = end + 1;
    ++line_;
  }
}

std::string_view TextCursor::next_token() {
  skip_blanks();
  if (position_ >= text_.size() || text_[position_] == '\n' || text_[position_] == '#') return {};
  const std::size_t start = position_;
  while (position_ < text_.size() && text_[position_] != '\n' && !is_blank(text_[position_])) ++position_;
  // "1\" at the end of a line: the backslash continues the line and is no part of the token.
  if (text_[position_ - 1] == '\\' &&
      (position_ == text_.size() || text_[position_] == '\n' || text_[position_] == '\r')) {
    if (--position_ == start) return {};
  }
  return text_.substr(start, position_ - start);
}

std::string_view TextCursor::rest_of_line() {
  skip_blanks();
  const std::size_t start = position_;
  position_ = std::min(text_.find('\n', start), text_.size());
  std::size_t end = position_;
  while (end > start && is_blank(text_[end - 1])) --end;
  return text_.substr(start, end - start);
}

std::string_view TextCursor::token_across_lines() {
  if (line_ == 0 && !next_line()) return {};
  do {
    if (const std::string_view token = next_token(); !token.empty()) return token;
  } while (next_line());
  return {};
}

double TextCursor::number() {
  return to_number(next_token());
}

double TextCursor::to_number(std::string_view token) const {
  if (token.empty()) fail("a number is missing; the file may be truncated");
  const std::string_view digits = without_plus(token);
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc::result_out_of_range)
    fail(quoted(token) + " is outside the range of a double; rescale the mesh");
  if (error != std::errc{} || end != digits.data() + digits.size())
    fail(quoted(token) + " is not a number; correct it");
  return value;
}

std::int64_t TextCursor::to_integer(std::string_view token) const {
  if (token.empty()) fail("a whole number is missing; the file may be truncated");
  const std::string_view digits = without_plus(token);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc{} || end != digits.data() + digits.size())
    fail(quoted(token) + " is not a whole number; correct it");
  return value;
}

void TextCursor::fail(const std::string& what) const {
  throw InputError(file_, line_, what);
}

}  // namespace exitance
