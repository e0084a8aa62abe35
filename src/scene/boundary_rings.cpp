#include "src/scene/boundary_rings.h"

#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>
#include <algorithm>
#include <array>
#include <map>

namespace exitance {
namespace {

using Mesh = OpenMesh::PolyMesh_ArrayKernelT<OpenMesh::DefaultTraitsDouble>;

/// Keeps OpenMesh from speaking of every face that it refuses, as long as this lives.
class Silence {
 public:
  Silence() : was_enabled_(::omerr().is_enabled()) { ::omerr().disable(); }
  ~Silence() {
    if (was_enabled_) ::omerr().enable();
  }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;

 private:
  bool was_enabled_;
};

/// The mesh of some polygons, its faces in their order; false when they are no manifold.
bool make_mesh(std::span<const Polygon> polygons, std::span<const std::uint32_t> chosen, Mesh& mesh) {
  std::map<std::array<double, 3>, Mesh::VertexHandle> vertex_at;
  for (const std::uint32_t p : chosen) {
    if (!polygons[p].holes.empty()) return false;
    std::vector<Mesh::VertexHandle> face;
    for (const Vec3& v : polygons[p].outer) {
      const auto [place, is_new] = vertex_at.try_emplace({v.x + 0.0, v.y + 0.0, v.z + 0.0});
      if (is_new) place->second = mesh.add_vertex({v.x, v.y, v.z});
      if (std::ranges::find(face, place->second) != face.end()) return false;
      face.push_back(place->second);
    }
    if (!mesh.add_face(face).is_valid()) return false;
  }
  return true;
}

void add_rings(const Mesh& mesh, std::span<const std::uint32_t> polygon_of_face, std::vector<BoundaryRing>& rings) {
  std::vector<bool> visited(mesh.n_halfedges(), false);
  const auto index = [](const Mesh::HalfedgeHandle& h) { return static_cast<std::size_t>(h.idx()); };
  for (const auto start : mesh.halfedges()) {
    if (!mesh.is_boundary(start) || visited[index(start)]) continue;
    BoundaryRing ring;
    ring.polygon = polygon_of_face[static_cast<std::size_t>(mesh.opposite_face_handle(start).idx())];
    for (Mesh::HalfedgeHandle h = start; !visited[index(h)]; h = mesh.next_halfedge_handle(h)) {
      visited[index(h)] = true;
      ++ring.edges;
      ring.length += mesh.calc_edge_length(h);
    }
    rings.push_back(ring);
  }
}

}  // namespace

std::vector<BoundaryRing> find_boundary_rings(std::span<const Polygon> polygons,
                                              std::span<const std::uint32_t> object) {
  const Silence silence;
  std::map<std::uint32_t, std::vector<std::uint32_t>> polygons_of;
  for (std::uint32_t p = 0; p < polygons.size(); ++p) polygons_of[object[p]].push_back(p);
  std::vector<BoundaryRing> rings;
  for (const auto& [number, chosen] : polygons_of) {
    Mesh mesh;
    if (make_mesh(polygons, chosen, mesh)) add_rings(mesh, chosen, rings);
  }
  return rings;
}

}  // namespace exitance
