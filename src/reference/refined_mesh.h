#pragma once
// A mesh that is refined where a solution needs it: convex patches, each of a regular grid of elements.

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/polygon_soup.h"
#include "src/form_factor/area_cell.h"
#include "src/scene/patch_mesh.h"
#include "src/scene/scene.h"

namespace exitance {

/// Patches are triangles and convex quadrilaterals, each on one facet; their elements are n² in a grid, n along every
/// edge. Surfaces start as make_patch_mesh cuts them; every piece is a patch.
class RefinedMesh {
 public:
  /// Where a patch comes from: of the mesh before, the patch that it was or was a part of.
  struct Origin {
    std::uint32_t patch = 0;
    bool kept = false;  ///< it was that patch
  };

  /// The scene and its soup must outlive it. elements_per_edge ≥ 1; throws what make_patch_mesh does.
  RefinedMesh(const Scene& scene, const PolygonSoup& soup, const MeshOptions& options);

  /// Valid until the next split().
  const PatchMesh& mesh() const { return mesh_; }

  /// Divides the named patches (ascending): along shadow boundaries of the emitting surfaces where they cross it
  /// (visual_events.h: lines where a vertex and an edge come into line before an emitter, where other surfaces touch,
  /// and where an emitter comes into view), the one first that divides most evenly, until there are four parts;
  /// otherwise into four across the longer sides. Lines that cut off less than a tenth are left for when they lie
  /// better. Parts come first in the new mesh, the other patches follow in their order, with elements that are the
  /// same, bit for bit, in the same order. Returns where each patch of the new mesh comes from.
  std::vector<Origin> split(std::span<const std::uint32_t> patches);

 private:
  struct Cell {
    std::uint32_t surface = 0, facet = 0;
    AreaCell shape;
  };
  std::vector<AreaCell> parts_of(const Cell& cell) const;
  void make_mesh();
  void add_elements(const Cell& cell);

  const PolygonSoup* soup_;
  std::vector<std::uint32_t> emitters_;  // facets
  std::vector<Cell> cells_;              // one a patch
  std::uint32_t n_;
  PatchMesh mesh_;
};

}  // namespace exitance
