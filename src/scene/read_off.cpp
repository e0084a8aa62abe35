#include "src/scene/read_off.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "src/scene/text_cursor.h"

namespace exitance {
namespace {

constexpr std::string_view kKeywords[] = {"OFF", "COFF", "NOFF", "CNOFF", "STOFF", "STCOFF", "STNOFF", "STCNOFF"};

// The first token of the next line that has one.
std::string_view first_token(TextCursor& text) {
  while (text.next_line()) {
    if (const std::string_view token = text.next_token(); !token.empty()) return token;
  }
  return {};
}

std::size_t read_count(TextCursor& text, std::string_view token) {
  const std::int64_t count = text.to_integer(token);
  if (count < 0) text.fail("a count is negative; correct it");
  return static_cast<std::size_t>(count);
}

std::string_view announced_line(TextCursor& text, const char* of, std::size_t index, std::size_t count) {
  const std::string_view token = first_token(text);
  if (token.empty()) text.fail(fmt::format("the file ends after {} of {} {}; it is truncated", index, count, of));
  return token;
}

}  // namespace

FaceList read_off(const std::filesystem::path& path) {
  const std::string bytes = read_bytes(path);
  TextCursor text(path.string(), bytes);
  FaceList list;
  list.file = path.string();

  std::string_view token = first_token(text);
  if (token.empty()) text.fail("the file is empty");
  if (std::ranges::find(kKeywords, token) != std::end(kKeywords)) {
    token = text.next_token();
    if (token == "BINARY") text.fail("binary OFF is not supported; save it as text");
    if (token.empty()) token = first_token(text);
  } else if (token.ends_with("OFF")) {
    text.fail(fmt::format("\"{}\" is not supported; save it as three-dimensional OFF", token));
  }
  const std::size_t vertices = read_count(text, token);
  const std::size_t faces = read_count(text, text.next_token());

  for (std::size_t i = 0; i < vertices; ++i) {
    const double x = text.to_number(announced_line(text, "vertices", i, vertices));
    const double y = text.number(), z = text.number();
    list.vertices.push_back({x, y, z});
    list.vertex_lines.push_back(text.line());
  }
  for (std::size_t i = 0; i < faces; ++i) {
    const std::size_t count = read_count(text, announced_line(text, "faces", i, faces));
    list.faces.push_back({.first = list.corners.size(), .count = count, .line = text.line()});
    for (std::size_t k = 0; k < count; ++k) list.corners.push_back(text.to_integer(text.next_token()));
  }
  if (!first_token(text).empty()) {
    list.warnings.push_back(
        fmt::format("{}:{}: more follows than the header announces; it is ignored", list.file, text.line()));
  }
  return list;
}

}  // namespace exitance
