#include "src/reference/solution_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "src/form_factor/area_cell.h"
#include "src/output/archive.h"

namespace exitance {
namespace {

constexpr std::string_view kKind = "exitance solution 1";

std::vector<double> coordinates(std::span<const Vec3> points) {
  std::vector<double> numbers;
  for (const Vec3& p : points) numbers.insert(numbers.end(), {p.x, p.y, p.z});
  return numbers;
}

std::vector<Vec3> points_of(const ArchiveReader& file, const std::string& name) {
  const std::vector<double> numbers = file.doubles(name);
  if (numbers.size() % 3 != 0 || !std::ranges::all_of(numbers, [](double x) { return std::isfinite(x); }))
    file.refuse(fmt::format("\"{}\" is no list of points", name));
  std::vector<Vec3> points;
  for (std::size_t k = 0; k < numbers.size(); k += 3) points.push_back({numbers[k], numbers[k + 1], numbers[k + 2]});
  return points;
}

std::vector<double> finite(const ArchiveReader& file, const std::string& name, std::size_t count) {
  std::vector<double> numbers = file.doubles(name);
  if (numbers.size() != count || !std::ranges::all_of(numbers, [](double x) { return std::isfinite(x); }))
    file.refuse(fmt::format("\"{}\" are not {} finite numbers", name, count));
  return numbers;
}

std::uint32_t number(const ArchiveReader& file, const std::string& name) {
  const std::vector<std::uint32_t> numbers = file.uint32s(name);
  if (numbers.size() != 1) file.refuse(fmt::format("\"{}\" is not one number", name));
  return numbers.front();
}

bool is_refined_mesh(const PatchMesh& mesh) {
  std::uint32_t piece = 0;
  for (const Patch& patch : mesh.patches) {
    if (patch.piece_first != piece++ || patch.piece_count != 1) return false;
    for (std::uint32_t e = 0; e < patch.element_count; ++e) {
      const Element& element = mesh.elements[patch.element_first + e];
      if (element.piece_first != piece++ || element.piece_count != 1) return false;
    }
  }
  return piece == mesh.pieces.size() &&
         std::ranges::all_of(mesh.pieces, [](const PatchPiece& p) { return p.loop_count >= 3; });
}

/// The mesh from its lists; false where they do not make one.
bool assemble(PatchMesh& mesh, std::span<const std::uint32_t> surface, std::span<const std::uint32_t> facet,
              std::span<const std::uint32_t> elements, std::span<const std::uint32_t> corners,
              std::span<const Vec3> normal) {
  if (facet.size() != surface.size() || elements.size() != surface.size() || normal.size() != surface.size())
    return false;
  const std::size_t count = std::accumulate(elements.begin(), elements.end(), std::size_t{0});
  if (corners.size() != count + surface.size()) return false;
  std::size_t at = 0;
  const auto take_piece = [&](std::uint32_t of_facet) {
    const std::uint32_t n = corners[mesh.pieces.size()];
    if (n < 3 || n > 4 || at + n > mesh.points.size()) return false;
    const auto loop = std::span(mesh.points).subspan(at, n);
    AreaCell cell{{loop[0], loop[1], loop[2], loop[n - 1]}, static_cast<int>(n)};
    if (n == 3) cell.corner[3] = loop[0];
    mesh.pieces.push_back({of_facet, static_cast<std::uint32_t>(at), n, cell.area()});
    at += n;
    return true;
  };
  for (std::uint32_t p = 0; p < surface.size(); ++p) {
    Patch patch{.surface = surface[p],
                .piece_first = static_cast<std::uint32_t>(mesh.pieces.size()),
                .piece_count = 1,
                .element_first = static_cast<std::uint32_t>(mesh.elements.size()),
                .element_count = elements[p]};
    if (elements[p] == 0 || !take_piece(facet[p])) return false;
    for (std::uint32_t e = 0; e < elements[p]; ++e) {
      const auto piece = static_cast<std::uint32_t>(mesh.pieces.size());
      if (!take_piece(facet[p])) return false;
      const PatchPiece& of = mesh.pieces.back();
      Vec3 centre;
      for (const Vec3& v : mesh.loop(of)) centre = centre + (1 / static_cast<double>(of.loop_count)) * v;
      mesh.elements.push_back({.patch = p,
                               .facet = facet[p],
                               .sample = centre,
                               .normal = normal[p],
                               .area = of.area,
                               .piece_first = piece,
                               .piece_count = 1,
                               .loop_first = of.loop_first,
                               .loop_count = of.loop_count});
      patch.area += of.area;
    }
    mesh.patches.push_back(patch);
  }
  return at == mesh.points.size();
}

}  // namespace

std::vector<double> luminance(std::span<const double> values, std::uint32_t bands, std::size_t elements) {
  if (bands == 0 || values.size() != elements * bands)
    throw std::invalid_argument("luminance: there must be a value for each element and band");
  std::vector<double> Y(elements);
  for (std::size_t e = 0; e < elements; ++e) {
    const auto of = values.subspan(e * bands, bands);
    Y[e] = bands == 3 ? 0.2126 * of[0] + 0.7152 * of[1] + 0.0722 * of[2] : std::accumulate(of.begin(), of.end(), 0.0);
  }
  return Y;
}

void write_solution_archive(const std::filesystem::path& path, const SolutionRecord& record) {
  const PatchMesh& mesh = record.mesh;
  if (!is_refined_mesh(mesh)) throw std::invalid_argument("write_solution_archive: not a mesh of single pieces");
  if (record.B.size() != mesh.elements.size() * record.bands || record.H.size() != record.B.size())
    throw std::invalid_argument("write_solution_archive: B and H do not fit the mesh");
  std::vector<std::uint32_t> surface, facet, elements, corners;
  std::vector<Vec3> normal;
  for (const Patch& patch : mesh.patches) {
    surface.push_back(patch.surface);
    facet.push_back(mesh.pieces[patch.piece_first].facet);
    elements.push_back(patch.element_count);
    normal.push_back(mesh.elements[patch.element_first].normal);
  }
  for (const PatchPiece& piece : mesh.pieces) corners.push_back(piece.loop_count);
  const std::vector<double> points = coordinates(mesh.points), normals = coordinates(normal);
  const std::vector<std::uint32_t> bands{record.bands}, degree{record.degree};
  const std::vector<double> error{record.error.total, record.error.mesh, record.error.integration, record.error.solver};
  ArchiveWriter file(path, kKind);
  file.write("scene", record.scene);
  file.write("scene_hash", record.scene_hash);
  file.write("unit", record.unit);
  file.write("bands", std::span(bands));
  file.write("degree", std::span(degree));
  file.write("error", std::span(error));
  file.write("patch_surface", std::span(surface));
  file.write("patch_facet", std::span(facet));
  file.write("patch_elements", std::span(elements));
  file.write("patch_normal", std::span(normals));
  file.write("piece_corners", std::span(corners));
  file.write("points", std::span(points));
  file.write("B", std::span(record.B));
  file.write("H", std::span(record.H));
  file.write("manifest", record.manifest);
  file.publish();
}

SolutionRecord read_solution_archive(const std::filesystem::path& path) {
  const ArchiveReader file(path, kKind);
  SolutionRecord record{.source = path.string(),
                        .scene = file.text("scene"),
                        .scene_hash = file.text("scene_hash"),
                        .unit = file.text("unit"),
                        .bands = number(file, "bands"),
                        .degree = number(file, "degree"),
                        .manifest = file.text("manifest")};
  const std::vector<Vec3> points = points_of(file, "points");
  record.mesh.points.append(points.begin(), points.end());
  const std::vector<std::uint32_t> surface = file.uint32s("patch_surface"), facet = file.uint32s("patch_facet"),
                                   elements = file.uint32s("patch_elements"), corners = file.uint32s("piece_corners");
  const std::vector<Vec3> normal = points_of(file, "patch_normal");
  if (!assemble(record.mesh, surface, facet, elements, corners, normal)) file.refuse("its lists make no mesh");
  const std::size_t values = record.mesh.elements.size() * record.bands;
  record.B = finite(file, "B", values);
  record.H = finite(file, "H", values);
  const std::vector<double> error = finite(file, "error", 4);
  record.error = {error[0], error[1], error[2], error[3]};
  return record;
}

SolutionRecord read_solution(const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) return read_result_folder(path);
  if (path.extension() == ".vtp") return read_result_folder(path.parent_path().empty() ? "." : path.parent_path());
  return read_solution_archive(path);
}

}  // namespace exitance
