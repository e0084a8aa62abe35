#include "src/scene/read_stl.h"

#include <fmt/format.h>

#include <utility>

#include "src/scene/bytes.h"
#include "src/scene/input_error.h"
#include "src/scene/text_cursor.h"

namespace exitance {
namespace {

constexpr std::size_t kHeader = 80, kCount = 4;
// A normal and three vertices of three floats each, and two bytes of attributes.
constexpr std::size_t kTriangle = 50, kNormal = 12;

void add_triangle(FaceList& list, std::uint32_t object, std::uint32_t line) {
  const std::size_t first = list.corners.size();
  for (std::size_t k = 0; k < 3; ++k) list.corners.push_back(static_cast<std::int64_t>(first + k));
  list.faces.push_back({.first = first, .count = 3, .object = object, .line = line});
}

std::size_t announced_triangles(std::string_view bytes) {
  return bytes.size() < kHeader + kCount ? 0 : load<std::uint32_t>(bytes, kHeader, std::endian::little);
}

void read_binary(std::string_view bytes, FaceList& list) {
  const std::size_t count = announced_triangles(bytes);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t start = kHeader + kCount + i * kTriangle + kNormal;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto coordinate = [&](std::size_t axis) {
        return static_cast<double>(load<float>(bytes, start + 4 * (3 * k + axis), std::endian::little));
      };
      list.vertices.push_back({coordinate(0), coordinate(1), coordinate(2)});
    }
    add_triangle(list, 0, 0);
  }
}

void expect(TextCursor& text, std::string_view word) {
  const std::string_view token = text.token_across_lines();
  if (token == word) return;
  text.fail(token.empty() ? fmt::format("the file ends where \"{}\" should follow; it is truncated", word)
                          : fmt::format("\"{}\" stands where \"{}\" should; correct it", token, word));
}

void read_facet(TextCursor& text, FaceList& list, std::uint32_t object) {
  const std::uint32_t line = text.line();
  expect(text, "normal");
  for (int axis = 0; axis < 3; ++axis) text.token_across_lines();  // often wrong, never needed
  expect(text, "outer");
  expect(text, "loop");
  for (int k = 0; k < 3; ++k) {
    expect(text, "vertex");
    const double x = text.number(), y = text.number(), z = text.number();
    list.vertices.push_back({x, y, z});
    list.vertex_lines.push_back(text.line());
  }
  expect(text, "endloop");
  expect(text, "endfacet");
  add_triangle(list, object, line);
}

void read_text(TextCursor& text, FaceList& list) {
  for (std::string_view word = text.token_across_lines(); !word.empty(); word = text.token_across_lines()) {
    if (word != "solid") text.fail(fmt::format("\"{}\" stands where \"solid\" should; correct it", word));
    const std::string name(text.rest_of_line());
    const auto object = static_cast<std::uint32_t>(list.objects.size());
    list.objects.push_back(name.empty() ? fmt::format("solid {}", object + 1) : name);
    for (word = text.token_across_lines(); word == "facet"; word = text.token_across_lines())
      read_facet(text, list, object);
    if (word.empty()) text.fail("the file ends where \"facet\" or \"endsolid\" should follow; it is truncated");
    if (word != "endsolid") text.fail(fmt::format("\"{}\" stands where \"facet\" should; correct it", word));
    text.rest_of_line();
  }
}

}  // namespace

FaceList read_stl(const std::filesystem::path& path) {
  const std::string bytes = read_bytes(path);
  FaceList list;
  list.file = path.string();
  // Binary files may begin with "solid" too, so the length decides.
  const std::size_t triangles = announced_triangles(bytes);
  if (bytes.size() >= kHeader + kCount && bytes.size() == kHeader + kCount + triangles * kTriangle) {
    read_binary(bytes, list);
  } else if (TextCursor text(list.file, bytes); text.token_across_lines() == "solid") {
    TextCursor from_start(list.file, bytes);
    read_text(from_start, list);
  } else {
    throw InputError(
        list.file, 0,
        fmt::format("is neither text STL nor binary STL of its length ({} bytes, {} triangles announced); it is "
                    "truncated or of another format",
                    bytes.size(), triangles));
  }
  return list;
}

}  // namespace exitance
