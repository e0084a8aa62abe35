#include "src/scene/face_list.h"

#include <fmt/format.h>

#include <filesystem>
#include <utility>

#include "src/scene/input_error.h"

namespace exitance {
namespace {

void refuse_non_finite(const FaceList& list) {
  for (std::size_t i = 0; i < list.vertices.size(); ++i) {
    if (is_finite(list.vertices[i])) continue;
    const std::size_t line = list.vertex_lines.empty() ? 0 : list.vertex_lines[i];
    throw InputError(list.file, line,
                     fmt::format("vertex {} has a coordinate that is not a finite number; correct or remove it",
                                 i + static_cast<std::size_t>(list.numbering_from)));
  }
}

Polygon polygon_of(const FaceList& list, std::size_t face_number) {
  const Face& face = list.faces[face_number];
  // Binary files have no lines; the face's number stands in.
  const std::string name = face.line > 0 ? "the face" : fmt::format("face {}", face_number);
  if (face.count < 3) {
    throw InputError(list.file, face.line,
                     fmt::format("{} has {} {}, a polygon needs three; correct or remove it", name, face.count,
                                 face.count == 1 ? "vertex" : "vertices"));
  }
  Polygon polygon;
  polygon.outer.reserve(face.count);
  for (std::size_t i = face.first; i < face.first + face.count; ++i) {
    const std::int64_t vertex = list.corners[i];
    if (vertex < 0 || vertex >= std::ssize(list.vertices)) {
      throw InputError(
          list.file, face.line,
          fmt::format("{} names vertex {}, but the file has {} (numbered from {}); correct it, or the file is "
                      "truncated",
                      name, vertex + list.numbering_from, list.vertices.size(), list.numbering_from));
    }
    polygon.outer.push_back(list.vertices[static_cast<std::size_t>(vertex)]);
  }
  return polygon;
}

}  // namespace

Scene to_scene(FaceList list, bool keep_faults) {
  if (list.faces.empty()) throw InputError(list.file, 0, "holds no faces; is it a surface mesh, is it complete?");
  if (!keep_faults) refuse_non_finite(list);

  Scene scene;
  scene.name = std::filesystem::path(list.file).stem().string();
  scene.warnings = std::move(list.warnings);
  scene.materials = std::move(list.materials);
  if (scene.materials.empty()) scene.materials.emplace_back();
  if (list.objects.empty()) list.objects.push_back(scene.name);
  for (std::string& name : list.objects) scene.objects.push_back({std::move(name), list.file});
  scene.surfaces.reserve(list.faces.size());
  for (std::size_t i = 0; i < list.faces.size(); ++i) {
    const Face& face = list.faces[i];
    scene.surfaces.push_back(
        {.polygon = polygon_of(list, i), .material = face.material, .object = face.object, .line = face.line});
  }
  return scene;
}

}  // namespace exitance
