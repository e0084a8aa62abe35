#include "src/scene/read_vs3.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "src/scene/cut_out.h"
#include "src/scene/input_error.h"
#include "src/scene/text_cursor.h"

namespace exitance {
namespace {

// View3D's own: how far a subsurface may lie from its base's plane, and one edge from another, relative to the size.
constexpr double kOffPlane = 1e-5;
constexpr double kOffEdge = 1e-6;

struct Vs3Surface {
  char kind = 'S';
  Polygon polygon = {};
  std::size_t base = 0;           // number; 0: none
  std::size_t combined_with = 0;  // likewise
  double emissivity = 1;
  std::string name = {};
  std::uint32_t line = 0;
  std::uint32_t group = kNoGroup;
};

double size_of(const Polygon& polygon) {
  double size = 0;
  for (const Vec3& p : polygon.outer) size = std::max(size, norm(p - polygon.outer[0]));
  return size;
}

std::vector<std::string_view> words(std::string_view line) {
  constexpr std::string_view kBetween = " ,\t\r\f\v";
  std::vector<std::string_view> found;
  for (std::size_t at = line.find_first_not_of(kBetween); at != std::string_view::npos;
       at = line.find_first_not_of(kBetween, at)) {
    if (line[at] == '!' || line[at] == '/') break;
    const std::size_t end = std::min(line.find_first_of(kBetween, at), line.size());
    found.push_back(line.substr(at, end - at));
    at = end;
  }
  return found;
}

class Vs3Reader {
 public:
  Vs3Reader(const std::filesystem::path& path, std::string_view bytes, bool keep_faults)
      : text_(path.string(), bytes), keep_faults_(keep_faults) {
    scene_.name = path.stem().string();
  }

  Scene read() {
    bool ended = false;
    while (!ended && text_.next_line()) {
      line_ = text_.rest_of_line();
      words_ = words(line_);
      if (!words_.empty()) ended = !read_statement();
    }
    if (surfaces_.empty()) throw InputError(text_.file(), 0, "holds no surfaces; is it a .vs3 file, is it complete?");
    for (Vs3Surface& surface : surfaces_) combine(surface);
    for (std::size_t number = 1; number <= surfaces_.size(); ++number) add_to_scene(number);
    return std::move(scene_);
  }

 private:
  // False at the end.
  bool read_statement() {
    const char kind = static_cast<char>(std::toupper(static_cast<unsigned char>(words_[0][0])));
    switch (kind) {
      case 'T':
        read_title();
        return true;
      case 'C':
        read_controls();
        return true;
      case 'F':
        read_format();
        return true;
      case 'V':
        read_vertex();
        return true;
      case 'S':
      case 'N':
      case 'O':
        read_surface(kind);
        return true;
      case 'E':
      case '*':
        return false;
      case 'M':
        text_.fail("masking surfaces (M) are not supported; a null surface (N) hides as much of its base");
      case 'X':
        text_.fail("coordinate transformations (X) are not supported; write the vertices where they belong");
      default:
        text_.fail(fmt::format("\"{}\" begins no line of a .vs3 file; lines begin with T, C, F, V, S, N, O, E or !",
                               words_[0].substr(0, 20)));
    }
  }

  void read_title() {
    const std::size_t first = std::min(line_.find_first_of(" \t"), line_.size());
    const std::size_t start = std::min(line_.find_first_not_of(" \t", first), line_.size());
    if (start < line_.size()) scene_.name = std::string(line_.substr(start));
  }

  // "encl = 1", "encl= 1" and "encl=1" are the same.
  void read_controls() {
    std::string names_and_values;
    for (std::size_t i = 1; i < words_.size(); ++i) names_and_values.append(words_[i]).append(" ");
    std::ranges::replace(names_and_values, '=', ' ');
    const std::vector<std::string_view> pairs = words(names_and_values);
    for (std::size_t i = 0; i < pairs.size(); i += 2) {
      std::string name(pairs[i]);
      std::ranges::transform(name, name.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
      const double value = text_.to_number(i + 1 < pairs.size() ? pairs[i + 1] : std::string_view());
      if (value == 0) continue;
      if (name == "encl") warn("encl = 1: form factors are never adjusted unless that is asked for");
      if (name == "emit") warn("emit = 1: form factors are written, not those that include reflection (script F)");
      if (name == "row" || name == "col") warn("row and col: all form factors are computed");
    }
  }

  void warn(const std::string& what) {
    scene_.warnings.push_back(fmt::format("{}:{}: {}", text_.file(), text_.line(), what));
  }

  void read_format() {
    const std::string_view format = word(1);
    if (format == "3") return;
    text_.fail(
        fmt::format("geometry \"F {}\" is not supported, only F 3 (vertices and surfaces in three dimensions); "
                    "convert it",
                    format));
  }

  void read_vertex() {
    expect_number("vertex", vertices_.size() + 1);
    const Vec3 vertex{text_.to_number(word(2)), text_.to_number(word(3)), text_.to_number(word(4))};
    if (!is_finite(vertex) && !keep_faults_)
      text_.fail("a coordinate is not a finite number; correct or remove the vertex");
    vertices_.push_back(vertex);
  }

  void read_surface(char kind) {
    expect_number("surface", surfaces_.size() + 1);
    Vs3Surface surface{.kind = kind, .line = text_.line()};
    for (std::size_t i = 2; i < 6; ++i) {
      const std::int64_t vertex = text_.to_integer(word(i));
      if (vertex == 0 && i == 5) break;
      if (vertex < 1 || vertex > std::ssize(vertices_)) {
        text_.fail(fmt::format("vertex {} does not exist; {} are given above", vertex, vertices_.size()));
      }
      surface.polygon.outer.push_back(vertices_[static_cast<std::size_t>(vertex - 1)]);
    }
    const PolygonDefect defect = find_defect(surface.polygon);
    if (defect != PolygonDefect::none && !keep_faults_)
      text_.fail(fmt::format("the surface cannot be used: {}; correct it", describe(defect)));
    surface.name = std::string(word(9));
    if (surface.name.empty()) surface.name = fmt::format("surface {}", surfaces_.size() + 1);
    if (kind != 'O') {  // View3D reads no further there
      surface.base = number_of_other(6, "base");
      surface.combined_with = number_of_other(7, "combined");
      surface.emissivity = text_.to_number(word(8));
      if (!(surface.emissivity > 0 && surface.emissivity <= 1) && !keep_faults_)
        text_.fail(fmt::format("the emissivity {} must be above 0 and at most 1; correct it", word(8)));
      if (kind == 'N' && (surface.base == 0 || surface.combined_with != 0))
        text_.fail("a null surface has a base and is not combined; name the surface that it hides a part of");
    }
    surfaces_.push_back(std::move(surface));
  }

  std::size_t number_of_other(std::size_t index, const char* what) const {
    const std::int64_t number = text_.to_integer(word(index));
    if (number < 0)
      text_.fail(fmt::format("the number {} of the {} surface is negative; write 0 for none", number, what));
    return static_cast<std::size_t>(number);
  }

  void expect_number(const char* what, std::size_t expected) const {
    if (text_.to_integer(word(1)) == static_cast<std::int64_t>(expected)) return;
    text_.fail(fmt::format("{} {} stands where {} is next; number them in order", what, word(1), expected));
  }

  std::string_view word(std::size_t index) const { return index < words_.size() ? words_[index] : std::string_view(); }

  [[noreturn]] void refuse(const Vs3Surface& surface, const std::string& what) const {
    throw InputError(text_.file(), surface.line, what);
  }

  const Vs3Surface& other(const Vs3Surface& surface, std::size_t number) const {
    if (number > surfaces_.size())
      refuse(surface, fmt::format("surface {} does not exist, there are {}; correct it", number, surfaces_.size()));
    return surfaces_[number - 1];
  }

  void combine(Vs3Surface& surface) {
    if (surface.combined_with == 0) return;
    const Vs3Surface& first = other(surface, surface.combined_with);
    if (first.kind != 'S')
      refuse(surface, fmt::format("surface {} has no form factors to combine with", surface.combined_with));
    if (first.line >= surface.line)
      refuse(surface, fmt::format("is combined with surface {}, which does not come before it; swap the two numbers",
                                  surface.combined_with));
    if (first.combined_with != 0) {
      refuse(surface, fmt::format("is combined with surface {}, which is combined with {}; name that one in both",
                                  surface.combined_with, first.combined_with));
    }
    surface.group = group_of(surfaces_[surface.combined_with - 1]);
  }

  std::uint32_t group_of(Vs3Surface& surface) {
    if (surface.group == kNoGroup) surface.group = groups_++;
    return surface.group;
  }

  void add_to_scene(std::size_t number) {
    Vs3Surface& surface = surfaces_[number - 1];
    if (surface.base != 0) check_base(surface);
    std::vector<Polygon> remaining = without_subsurfaces(number);
    if (remaining.size() > 1 && surface.kind == 'S') group_of(surface);
    const auto object = static_cast<std::uint32_t>(scene_.objects.size());
    scene_.objects.push_back({surface.name, text_.file()});
    for (Polygon& polygon : remaining) {
      scene_.surfaces.push_back({.polygon = std::move(polygon),
                                 .material = material(surface),
                                 .object = object,
                                 .obstruction_only = surface.kind != 'S',
                                 .line = surface.line,
                                 .group = surface.group});
    }
  }

  // Reflectances out of range pass here only to be listed (keep_faults).
  std::uint32_t material(const Vs3Surface& surface) {
    const std::string name = fmt::format("emissivity {}", surface.emissivity);
    const auto [found, is_new] = materials_.try_emplace(name, static_cast<std::uint32_t>(scene_.materials.size()));
    if (is_new) {
      scene_.materials.push_back(
          {.name = name, .rho = {1 - surface.emissivity}, .E = {0}, .file = text_.file(), .line = surface.line});
    }
    return found->second;
  }

  void check_base(const Vs3Surface& surface) const {
    const Vs3Surface& base = other(surface, surface.base);
    if (base.kind == 'N') refuse(surface, fmt::format("its base {} is a null surface; name another", surface.base));
    if (base.kind == 'S' && base.line >= surface.line)
      refuse(surface, fmt::format("its base {} does not come before it; swap the two numbers", surface.base));
    const Vec3 front = area_vector(base.polygon);
    const double towards = dot(area_vector(surface.polygon), front);
    if (surface.kind == 'S' ? !(towards > 0) : !(towards < 0)) {
      refuse(surface, fmt::format("faces {} its base {}; list its vertices in the other direction",
                                  surface.kind == 'S' ? "against" : "the same way as", surface.base));
    }
    const double allowed = kOffPlane * size_of(base.polygon);
    for (const Vec3& p : surface.polygon.outer) {
      const double distance = std::fabs(dot(normalized(front), p - base.polygon.outer[0]));
      if (!(distance <= allowed)) {
        refuse(surface, fmt::format("lies {:.3g} off the plane of its base {}; move it there", distance, surface.base));
      }
    }
  }

  std::vector<Polygon> without_subsurfaces(std::size_t number) const {
    const Vs3Surface& base = surfaces_[number - 1];
    const double tolerance = kOffEdge * size_of(base.polygon);
    std::vector<Polygon> parts;
    const Vs3Surface* last = nullptr;
    for (const Vs3Surface& surface : surfaces_) {
      if (surface.base != number) continue;
      last = &surface;
      parts.push_back(surface.polygon);
      if (surface.kind == 'N') std::ranges::reverse(parts.back().outer);
      if (!cut_out(base.polygon, {&parts.back(), 1}, tolerance)) {
        refuse(surface, fmt::format("does not lie within its base {}, or touches its boundary with a corner only; "
                                    "correct it, or cut the base by hand",
                                    number));
      }
    }
    if (parts.empty()) return {base.polygon};
    auto remaining = cut_out(base.polygon, parts, tolerance);
    if (!remaining) {
      refuse(*last,
             fmt::format("this and other subsurfaces of {} overlap, or touch with a corner only; correct them, or "
                         "cut the base by hand",
                         number));
    }
    if (remaining->empty()) {
      refuse(base, fmt::format("its subsurfaces leave nothing of surface {}; make one of them the base of none and "
                               "remove this one",
                               number));
    }
    return *std::move(remaining);
  }

  TextCursor text_;
  bool keep_faults_;
  Scene scene_;
  std::string_view line_;
  std::vector<std::string_view> words_;  // of the current line
  std::vector<Vec3> vertices_;
  std::vector<Vs3Surface> surfaces_;
  std::map<std::string, std::uint32_t> materials_;  // by name
  std::uint32_t groups_ = 0;
};

}  // namespace

Scene read_vs3(const std::filesystem::path& path, bool keep_faults) {
  const std::string bytes = read_bytes(path);
  return Vs3Reader(path, bytes, keep_faults).read();
}

}  // namespace exitance
