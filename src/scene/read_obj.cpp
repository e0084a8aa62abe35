#include "src/scene/read_obj.h"

#include <fmt/format.h>

#include <map>
#include <utility>

#include "src/scene/read_mtl.h"
#include "src/scene/text_cursor.h"

namespace exitance {
namespace {

// Names in order of first use.
class NameTable {
 public:
  std::uint32_t number(std::string_view name) {
    const auto [it, is_new] = numbers_.try_emplace(std::string(name), static_cast<std::uint32_t>(names_.size()));
    if (is_new) names_.emplace_back(name);
    return it->second;
  }
  const std::vector<std::string>& names() const { return names_; }

 private:
  std::map<std::string, std::uint32_t> numbers_;
  std::vector<std::string> names_;
};

class ObjReader {
 public:
  ObjReader(const std::filesystem::path& path, std::string_view bytes, Emission emission)
      : folder_(path.parent_path()), emission_(emission), text_(path.string(), bytes) {
    list_.file = path.string();
    list_.numbering_from = 1;
  }

  FaceList read() {
    while (text_.next_line()) read_statement(text_.next_token());
    name_objects();
    if (ignored_ > 0) {
      list_.warnings.push_back(
          fmt::format("{}: {} lines and points are ignored; only faces count", list_.file, ignored_));
    }
    return std::move(list_);
  }

 private:
  void read_statement(std::string_view keyword) {
    if (keyword == "v") {
      const std::uint32_t line = text_.line();
      const double x = text_.number(), y = text_.number(), z = text_.number();
      list_.vertices.push_back({x, y, z});
      list_.vertex_lines.push_back(line);
    } else if (keyword == "f") {
      read_face();
    } else if (keyword == "usemtl") {
      material_ = material(text_.rest_of_line());
    } else if (keyword == "mtllib") {
      read_libraries(text_.rest_of_line());
    } else if (keyword == "o") {
      object_ = std::string(text_.rest_of_line());
      has_o_ = true;
    } else if (keyword == "g") {
      group_ = std::string(text_.rest_of_line());
    } else if (keyword == "l" || keyword == "p") {
      ++ignored_;
    }
  }

  void read_face() {
    Face face{.first = list_.corners.size(),
              .material = material_ == kNoMaterial ? material({}) : material_,
              .line = text_.line()};
    for (std::string_view token = text_.next_token(); !token.empty(); token = text_.next_token()) {
      list_.corners.push_back(corner(token));
    }
    face.count = list_.corners.size() - face.first;
    list_.faces.push_back(face);
    objects_of_faces_.push_back(objects_.number(object_));
    groups_of_faces_.push_back(groups_.number(group_));
  }

  // "v", "v/vt", "v//vn" or "v/vt/vn", of which only v matters.
  std::int64_t corner(std::string_view token) const {
    const std::string_view vertex = token.substr(0, token.find('/'));
    if (token.find_first_not_of("0123456789-+/", vertex.size()) != std::string_view::npos || vertex.empty()) {
      text_.fail(fmt::format("\"{}\" is not a corner of a face; write v, v/vt, v//vn or v/vt/vn", token));
    }
    const std::int64_t number = text_.to_integer(vertex);
    const std::int64_t index = number > 0 ? number - 1 : std::ssize(list_.vertices) + number;
    if (number == 0 || index < 0) {
      text_.fail(fmt::format("vertex {} does not exist; vertices are numbered from 1 on, or from -1 back to -{}",
                             number, list_.vertices.size()));
    }
    return index;
  }

  std::uint32_t material(std::string_view name) {
    const std::uint32_t number = materials_.number(name);
    if (number == list_.materials.size()) {
      list_.materials.push_back(
          {.name = std::string(name), .rho = {}, .E = {}, .file = list_.file, .line = text_.line()});
    }
    return number;
  }

  void read_libraries(std::string_view names) {
    // One file whose name holds blanks, or several files.
    if (is_file(folder_ / names)) return read_library(std::string(names));
    const std::uint32_t line = text_.line();
    TextCursor words(text_.file(), names);
    for (std::string_view name = words.token_across_lines(); !name.empty(); name = words.token_across_lines()) {
      if (!is_file(folder_ / name)) {
        list_.warnings.push_back(
            fmt::format("{}:{}: the material library {} is missing or no file; put it there or delete this line",
                        text_.file(), line, (folder_ / name).string()));
        continue;
      }
      read_library(std::string(name));
    }
  }

  void read_library(const std::string& name) {
    for (Material& m : read_mtl(folder_ / name, emission_)) {
      const std::uint32_t number = material(m.name);
      list_.materials[number] = std::move(m);
    }
  }

  void name_objects() {
    const NameTable& table = has_o_ ? objects_ : groups_;
    const auto& of_faces = has_o_ ? objects_of_faces_ : groups_of_faces_;
    for (std::size_t i = 0; i < list_.faces.size(); ++i) list_.faces[i].object = of_faces[i];
    for (const std::string& name : table.names()) {
      list_.objects.push_back(name.empty() ? std::filesystem::path(list_.file).stem().string() : name);
    }
  }

  static constexpr std::uint32_t kNoMaterial = 0xffffffffu;

  std::filesystem::path folder_;
  Emission emission_;
  TextCursor text_;
  FaceList list_;
  NameTable materials_, objects_, groups_;
  std::string object_, group_;
  bool has_o_ = false;
  std::uint32_t material_ = kNoMaterial;
  std::vector<std::uint32_t> objects_of_faces_, groups_of_faces_;
  std::size_t ignored_ = 0;
};

}  // namespace

FaceList read_obj(const std::filesystem::path& path, Emission emission) {
  const std::string bytes = read_bytes(path);
  return ObjReader(path, bytes, emission).read();
}

}  // namespace exitance
