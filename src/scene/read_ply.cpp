#include "src/scene/read_ply.h"

#include <fmt/format.h>

#include <utility>

#include "src/scene/bytes.h"
#include "src/scene/input_error.h"
#include "src/scene/ply_header.h"

namespace exitance {
namespace {

// What follows the header, one number after the other.
class TextBody {
 public:
  explicit TextBody(TextCursor text) : text_(std::move(text)) { text_.next_line(); }

  double real(PlyType) { return text_.to_number(token()); }
  std::int64_t integer(PlyType) { return text_.to_integer(token()); }
  std::uint32_t line() {
    // Of the next number: an item begins in a line of its own, but blank lines may stand before it.
    TextCursor ahead = text_;
    ahead.token_across_lines();
    return ahead.line();
  }
  bool at_end() { return text_.token_across_lines().empty(); }
  [[noreturn]] void fail(const std::string& what) const { text_.fail(what); }

 private:
  std::string_view token() {
    const std::string_view next = text_.token_across_lines();
    if (next.empty()) text_.fail("the file ends before all that its header announces; it is truncated");
    return next;
  }

  TextCursor text_;
};

class BinaryBody {
 public:
  BinaryBody(std::string file, std::string_view bytes, std::endian order)
      : file_(std::move(file)), bytes_(bytes), order_(order) {}

  double real(PlyType type) {
    if (type == PlyType::float32) return static_cast<double>(next<float>());
    if (type == PlyType::float64) return next<double>();
    return static_cast<double>(integer(type));
  }
  std::int64_t integer(PlyType type) {
    switch (type) {
      case PlyType::int8:
        return next<std::int8_t>();
      case PlyType::uint8:
        return next<std::uint8_t>();
      case PlyType::int16:
        return next<std::int16_t>();
      case PlyType::uint16:
        return next<std::uint16_t>();
      case PlyType::int32:
        return next<std::int32_t>();
      case PlyType::uint32:
        return next<std::uint32_t>();
      default:
        fail("vertex numbers are of a floating-point type; correct the header");
    }
  }
  std::uint32_t line() const { return 0; }
  bool at_end() const { return position_ == bytes_.size(); }
  [[noreturn]] void fail(const std::string& what) const { throw InputError(file_, 0, what); }

 private:
  template <typename T>
  T next() {
    if (bytes_.size() - position_ < sizeof(T))
      fail("the file ends before all that its header announces; it is truncated");
    const T value = load<T>(bytes_, position_, order_);
    position_ += sizeof(T);
    return value;
  }

  std::string file_;
  std::string_view bytes_;
  std::endian order_;
  std::size_t position_ = 0;
};

template <typename Body>
std::size_t list_length(Body& body, const PlyProperty& property) {
  const std::int64_t length = body.integer(*property.count_type);
  if (length < 0) body.fail("a list has a negative length; the file is damaged");
  return static_cast<std::size_t>(length);
}

template <typename Body>
void skip(Body& body, const PlyProperty& property) {
  const std::size_t values = property.count_type ? list_length(body, property) : 1;
  for (std::size_t i = 0; i < values; ++i) body.real(property.type);
}

template <typename Body>
void read_vertex(Body& body, const PlyElement& element, FaceList& list) {
  Vec3 vertex;
  list.vertex_lines.push_back(body.line());
  for (const PlyProperty& property : element.properties) {
    const bool coordinate =
        !property.count_type && property.name.size() == 1 && property.name >= "x" && property.name <= "z";
    if (coordinate) {
      vertex[property.name[0] - 'x'] = body.real(property.type);
    } else {
      skip(body, property);
    }
  }
  list.vertices.push_back(vertex);
}

bool is_vertex_list(const PlyProperty& property) {
  return property.count_type && (property.name == "vertex_indices" || property.name == "vertex_index");
}

template <typename Body>
void read_face(Body& body, const PlyElement& element, FaceList& list) {
  Face face{.first = list.corners.size(), .line = body.line()};
  for (const PlyProperty& property : element.properties) {
    if (!is_vertex_list(property)) {
      skip(body, property);
      continue;
    }
    face.count = list_length(body, property);
    for (std::size_t i = 0; i < face.count; ++i) list.corners.push_back(body.integer(property.type));
  }
  list.faces.push_back(face);
}

template <typename Body>
void read_body(Body body, const PlyHeader& header, FaceList& list) {
  for (const PlyElement& element : header.elements) {
    for (std::size_t i = 0; i < element.count; ++i) {
      if (element.name == "vertex") {
        read_vertex(body, element, list);
      } else if (element.name == "face") {
        read_face(body, element, list);
      } else {
        for (const PlyProperty& property : element.properties) skip(body, property);
      }
    }
  }
  if (!body.at_end()) list.warnings.push_back(list.file + ": more follows than the header announces; it is ignored");
}

void refuse_incomplete(const PlyHeader& header, const std::string& file) {
  int coordinates = 0, lists = 0;
  for (const PlyElement& element : header.elements) {
    for (const PlyProperty& property : element.properties) {
      coordinates += element.name == "vertex" && (property.name == "x" || property.name == "y" || property.name == "z");
      lists += element.name == "face" && is_vertex_list(property);
    }
  }
  if (coordinates != 3) throw InputError(file, 0, "the element \"vertex\" must have x, y and z; correct the header");
  if (lists != 1)
    throw InputError(file, 0, "the element \"face\" must have one list \"vertex_indices\"; convert strips to faces");
}

}  // namespace

FaceList read_ply(const std::filesystem::path& path) {
  const std::string bytes = read_bytes(path);
  FaceList list;
  list.file = path.string();
  TextCursor text(list.file, bytes);
  const PlyHeader header = read_ply_header(text);
  refuse_incomplete(header, list.file);
  if (header.encoding == PlyEncoding::text) {
    read_body(TextBody(std::move(text)), header, list);
  } else {
    const std::string_view body = std::string_view(bytes).substr(text.end_of_line());
    const bool little = header.encoding == PlyEncoding::little_endian;
    read_body(BinaryBody(list.file, body, little ? std::endian::little : std::endian::big), header, list);
  }
  return list;
}

}  // namespace exitance
