#include "src/scene/ply_header.h"

#include <fmt/format.h>

#include <map>

namespace exitance {
namespace {

PlyType read_type(TextCursor& text) {
  static const std::map<std::string_view, PlyType> kTypes = {
      {"char", PlyType::int8},      {"int8", PlyType::int8},       {"uchar", PlyType::uint8},
      {"uint8", PlyType::uint8},    {"short", PlyType::int16},     {"int16", PlyType::int16},
      {"ushort", PlyType::uint16},  {"uint16", PlyType::uint16},   {"int", PlyType::int32},
      {"int32", PlyType::int32},    {"uint", PlyType::uint32},     {"uint32", PlyType::uint32},
      {"float", PlyType::float32},  {"float32", PlyType::float32}, {"double", PlyType::float64},
      {"float64", PlyType::float64}};
  const std::string_view name = text.next_token();
  const auto type = kTypes.find(name);
  if (type == kTypes.end()) text.fail(fmt::format("\"{}\" is not a type of PLY; correct the header", name));
  return type->second;
}

PlyEncoding read_encoding(TextCursor& text) {
  const std::string_view name = text.next_token();
  if (name == "ascii") return PlyEncoding::text;
  if (name == "binary_little_endian") return PlyEncoding::little_endian;
  if (name == "binary_big_endian") return PlyEncoding::big_endian;
  text.fail(fmt::format("\"{}\" is not a format of PLY; correct the header", name));
}

PlyElement read_element(TextCursor& text) {
  PlyElement element;
  element.name = text.next_token();
  const std::int64_t count = text.to_integer(text.next_token());
  if (count < 0) text.fail("a count is negative; correct it");
  element.count = static_cast<std::size_t>(count);
  return element;
}

PlyProperty read_property(TextCursor& text) {
  PlyProperty property;
  TextCursor ahead = text;
  if (ahead.next_token() == "list") {
    text.next_token();
    property.count_type = read_type(text);
    if (*property.count_type >= PlyType::float32)
      text.fail("a list's length must be of an integer type; correct the header");
  }
  property.type = read_type(text);
  property.name = text.next_token();
  return property;
}

}  // namespace

PlyHeader read_ply_header(TextCursor& text) {
  if (!text.next_line() || text.next_token() != "ply")
    text.fail("does not begin with \"ply\"; it is of another format");
  PlyHeader header;
  bool has_format = false;
  while (text.next_line()) {
    const std::string_view keyword = text.next_token();
    if (keyword == "format") {
      header.encoding = read_encoding(text);
      has_format = true;
    } else if (keyword == "element") {
      header.elements.push_back(read_element(text));
    } else if (keyword == "property") {
      if (header.elements.empty()) text.fail("a property comes before any element; correct the header");
      header.elements.back().properties.push_back(read_property(text));
    } else if (keyword == "end_header") {
      if (!has_format) text.fail("the header names no format; add one");
      return header;
    } else if (keyword != "comment" && keyword != "obj_info" && !keyword.empty()) {
      text.fail(fmt::format("\"{}\" does not belong in a PLY header; correct it", keyword));
    }
  }
  text.fail("the file ends within its header; it is truncated");
}

}  // namespace exitance
