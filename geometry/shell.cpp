#include "geometry/shell.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>

#include <unordered_map>

#include "geometry/enclosed_volume.h"

namespace exitance {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;

bool bounds_solid(std::span<const Vec3> vertices, std::span<const std::array<std::uint32_t, 3>> triangles) {
  EnclosedVolume volume(vertices[triangles.front()[0]]);
  for (const auto& t : triangles) volume.add(vertices[t[0]], vertices[t[1]], vertices[t[2]]);
  if (!(volume.value() > 0)) return false;

  Mesh mesh;
  std::unordered_map<std::uint32_t, Mesh::Vertex_index> vertex_of;
  const auto vertex = [&](std::uint32_t v) {
    const auto [place, is_new] = vertex_of.try_emplace(v);
    if (is_new) place->second = mesh.add_vertex({vertices[v].x, vertices[v].y, vertices[v].z});
    return place->second;
  };
  for (const auto& t : triangles) {
    const auto point = [&](int k) { return mesh.point(vertex(t[static_cast<std::size_t>(k)])); };
    if (CGAL::collinear(point(0), point(1), point(2))) return false;  // outside what does_self_intersect is defined for
    if (mesh.add_face(vertex(t[0]), vertex(t[1]), vertex(t[2])) == Mesh::null_face()) return false;
  }
  return !CGAL::Polygon_mesh_processing::does_self_intersect(mesh);
}

}  // namespace exitance
