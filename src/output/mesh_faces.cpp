#include "src/output/mesh_faces.h"

namespace exitance {

Faces faces_of(const PatchMesh& mesh, const PolygonSoup& soup) {
  // Far above the rounding of points that were computed in two ways, far below any element.
  constexpr double kRounding = 0x1p-40;
  Faces faces(kRounding * soup.extent());
  std::vector<Vec3> loop;
  for (std::uint32_t e = 0; e < mesh.elements.size(); ++e) {
    const Element& element = mesh.elements[e];
    const std::uint32_t surface = mesh.patches[element.patch].surface;
    for (const PatchPiece& piece : mesh.pieces_of(element)) {
      const auto given = mesh.loop(piece);
      loop.assign(given.begin(), given.end());
      if (loop.empty()) {
        for (const Corner& c : soup.corners(soup.facets()[piece.facet])) loop.push_back(soup.vertices()[c.vertex]);
      }
      faces.add(surface, element.patch, e, loop);
    }
  }
  return faces;
}

}  // namespace exitance
