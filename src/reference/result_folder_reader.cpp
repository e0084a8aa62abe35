#include <fmt/format.h>

#include <algorithm>
#include <boost/property_tree/ptree.hpp>
#include <boost/property_tree/xml_parser.hpp>
#include <charconv>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>
#include <system_error>

#include "src/reference/solution_record.h"
#include "src/scene/input_error.h"
#include "src/scene/text_cursor.h"

namespace exitance {
namespace {

namespace fs = std::filesystem;
using Tree = boost::property_tree::ptree;

[[noreturn]] void refuse(const fs::path& path, const std::string& what) {
  throw InputError(path.string(), 0, what + "; solve the scene again");
}

/// A file of ours has some fifty; the parser goes into elements within elements by recursion.
constexpr std::ptrdiff_t kMostTags = 1000;

Tree read_xml(const fs::path& path) {
  const std::string text = read_bytes(path);
  if (std::ranges::count(text, '<') > kMostTags) refuse(path, fmt::format("has more than {} tags", kMostTags));
  std::istringstream stream(text);
  Tree tree;
  try {
    boost::property_tree::read_xml(stream, tree);
  } catch (const boost::property_tree::xml_parser_error& wrong) {
    throw InputError(path.string(), wrong.line(), wrong.message() + "; solve the scene again");
  }
  return tree;
}

/// The DataArray of that name below a node.
const Tree& array_in(const fs::path& path, const Tree& piece, const std::string& group, const std::string& name) {
  if (const auto node = piece.get_child_optional(group)) {
    for (const auto& [tag, child] : *node) {
      if (tag == "DataArray" && child.get("<xmlattr>.Name", "") == name) return child;
    }
  }
  refuse(path, fmt::format("has no array \"{}\"", name));
}

template <class Number>
std::vector<Number> numbers(const fs::path& path, const Tree& array) {
  const std::string& text = array.data();
  std::vector<Number> values;
  const char *at = text.data(), *end = at + text.size();
  for (;;) {
    while (at < end && (*at == ' ' || *at == '\n' || *at == '\r' || *at == '\t')) ++at;
    if (at == end) return values;
    Number value{};
    const auto [next, error] = std::from_chars(at, end, value);
    if (error != std::errc() || !std::isfinite(value))
      refuse(path, fmt::format("array \"{}\" has something that is no number", array.get("<xmlattr>.Name", "")));
    values.push_back(value);
    at = next;
  }
}

std::string scene_hash_in(const fs::path& path, SolutionRecord& record) {
  const std::string text = read_bytes(path);
  try {
    const nlohmann::json report = nlohmann::json::parse(text);
    record.scene = report.at("scene");
    record.unit = report.at("unit");
    record.bands = report.at("bands");
    record.manifest = report.at("manifest").dump(1);
    return report.at("manifest").at("scene_hash");
  } catch (const nlohmann::json::exception& wrong) {
    refuse(path, fmt::format("is no report of a solution ({})", wrong.what()));
  }
}

}  // namespace

SolutionRecord read_result_folder(const fs::path& folder) {
  constexpr double unknown = std::numeric_limits<double>::infinity();
  const fs::path path = folder / "solution.vtp";
  SolutionRecord record{.source = folder.string(), .error = {unknown, unknown, unknown, unknown}};
  record.scene_hash = scene_hash_in(folder / "result.json", record);
  const Tree file = read_xml(path);
  const auto piece = file.get_child_optional("VTKFile.PolyData.Piece");
  if (!piece) refuse(path, "holds no polygons");

  const auto xyz = numbers<double>(path, array_in(path, *piece, "Points", "Points"));
  const auto corner = numbers<std::uint32_t>(path, array_in(path, *piece, "Polys", "connectivity"));
  const auto end = numbers<std::uint32_t>(path, array_in(path, *piece, "Polys", "offsets"));
  const auto element = numbers<std::uint32_t>(path, array_in(path, *piece, "CellData", "element"));
  const auto patch = numbers<std::uint32_t>(path, array_in(path, *piece, "CellData", "patch"));
  const auto surface = numbers<std::uint32_t>(path, array_in(path, *piece, "CellData", "surface"));
  const auto B = numbers<double>(path, array_in(path, *piece, "CellData", "B"));
  const std::size_t faces = end.size();
  if (element.size() != faces || patch.size() != faces || surface.size() != faces || xyz.size() % 3 != 0)
    refuse(path, "has arrays that do not fit its polygons");
  if (record.bands == 0 || B.size() != faces * record.bands)
    refuse(path, fmt::format("has not {} bands of B for every polygon", record.bands));

  // A patch of its own for each element: what is constant on elements knows nothing of patches.
  PatchMesh& mesh = record.mesh;
  std::size_t at = 0;
  for (std::size_t f = 0; f < faces; ++f) {
    if (end[f] < at + 3 || end[f] > corner.size()) refuse(path, fmt::format("polygon {} has no three corners", f));
    if (mesh.elements.empty() || element[f] != element[f - 1]) {
      const auto number = static_cast<std::uint32_t>(mesh.elements.size());
      const auto first = static_cast<std::uint32_t>(mesh.pieces.size());
      mesh.patches.push_back(
          {.surface = surface[f], .piece_first = first, .element_first = number, .element_count = 1});
      mesh.elements.emplace_back();
      mesh.elements.back().patch = number;
      mesh.elements.back().piece_first = first;
      for (std::uint32_t b = 0; b < record.bands; ++b) record.B.push_back(B[f * record.bands + b]);
    }
    PatchPiece face{.loop_first = static_cast<std::uint32_t>(mesh.points.size()),
                    .loop_count = static_cast<std::uint32_t>(end[f] - at)};
    for (; at < end[f]; ++at) {
      const std::size_t p = 3 * std::size_t{corner[at]};
      if (p + 2 >= xyz.size()) refuse(path, fmt::format("polygon {} has a corner that is no point", f));
      mesh.points.push_back({xyz[p], xyz[p + 1], xyz[p + 2]});
    }
    const auto loop = mesh.loop(face);
    Vec3 doubled;
    for (std::size_t k = 2; k < loop.size(); ++k) doubled = doubled + cross(loop[k - 1] - loop[0], loop[k] - loop[0]);
    face.area = norm(doubled) / 2;
    Element& of = mesh.elements.back();
    if (of.piece_count == 0 && face.area > 0) of.normal = normalized(doubled);
    of.area += face.area;
    ++of.piece_count;
    Patch& whole = mesh.patches.back();
    whole.area += face.area;
    ++whole.piece_count;
    mesh.pieces.push_back(face);
  }
  return record;
}

}  // namespace exitance
