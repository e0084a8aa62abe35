#include "src/scene/front_view.h"

#include <algorithm>
#include <vector>

#include "geometry/contact.h"
#include "geometry/level.h"
#include "geometry/surface_pieces.h"
#include "src/scene/scene_check.h"
#include "src/scene/scene_extent.h"

namespace exitance {
bool sees_only_fronts(const Scene& scene) {
  if (std::ranges::any_of(scene.surfaces, &Surface::obstruction_only) || !is_closed(scene)) return false;
  std::vector<Polygon> polygons;
  polygons.reserve(scene.surfaces.size());
  for (const Surface& surface : scene.surfaces) polygons.push_back(surface.polygon);
  const SurfacePieces found = find_surface_pieces(polygons);
  const auto shows_its_front = [](const SurfacePiece& piece) {
    return piece.area == 0 || (piece.closed && (piece.enclosed ? piece.volume > 0 : piece.volume < 0));
  };
  return found.open_edges.empty() && std::ranges::all_of(found.pieces, shows_its_front) &&
         coplanar_overlaps(polygons, kLevel * extent(scene)).empty();
}

}  // namespace exitance
