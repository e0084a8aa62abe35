#pragma once
// Patches (which shoot) and elements (which receive): the surfaces of a scene cut to a requested size.

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "geometry/facets.h"
#include "geometry/polygon_soup.h"
#include "src/scene/scene.h"
#include "src/scene/shared_rows.h"

namespace exitance {

/// A convex piece of a facet, as a source or receiver of light. Empty loop (loop_count 0): the whole facet.
struct PatchPiece {
  std::uint32_t facet = 0;
  std::uint32_t loop_first = 0, loop_count = 0;  ///< in PatchMesh::points, counter-clockwise seen from the front
  double area = 0;                               ///< [m²]
};

/// The unit that shoots. Its pieces and its elements are contiguous and each tile it.
struct Patch {
  std::uint32_t surface = 0;
  std::uint32_t piece_first = 0, piece_count = 0;
  std::uint32_t element_first = 0, element_count = 0;
  double area = 0;  ///< [m²], the sum of its elements'
};

/// The unit that receives, with one sample point: interior to it and to the facet it is on, away from the facet's edges
/// (the centroid of its largest piece, or a point beside that where another surface ends or crosses: SampleSite). Its
/// pieces tile it exactly. The loop is its outline for drawing: where it has one piece, that piece; a quadrilateral
/// bent along its surface's diagonal: the four corners; an element that is a whole surface: the outer loop, which tells
/// nothing of the holes.
struct Element {
  std::uint32_t patch = 0;
  std::uint32_t facet = 0;  ///< on which the sample point lies, by identity
  Vec3 sample;
  Vec3 normal;      ///< of that facet, unit length
  double area = 0;  ///< [m²], the sum of its pieces'
  std::uint32_t piece_first = 0, piece_count = 0;
  std::uint32_t loop_first = 0, loop_count = 0;  ///< in PatchMesh::points, counter-clockwise seen from the front
};

struct PatchMesh {
  SharedList<Vec3> points;
  SharedList<PatchPiece> pieces;
  SharedRows<Patch> patches;
  SharedRows<Element> elements;

  std::span<const Vec3> loop(const PatchPiece& p) const { return {points.data() + p.loop_first, p.loop_count}; }
  std::span<const Vec3> loop(const Element& e) const { return {points.data() + e.loop_first, e.loop_count}; }
  std::span<const PatchPiece> pieces_of(const Patch& p) const { return {pieces.data() + p.piece_first, p.piece_count}; }
  std::span<const PatchPiece> pieces_of(const Element& e) const {
    return {pieces.data() + e.piece_first, e.piece_count};
  }
};

struct MeshOptions {
  double patch_size = 0;                ///< longest edge of a patch [m]; 0: every surface is one patch
  std::uint32_t elements_per_edge = 1;  ///< a quadrilateral patch has this many squared elements, a triangle likewise
  double small_patch = 0;               ///< [m²] patches of surfaces cut to this area or less are one element each
  std::uint64_t memory_limit = std::numeric_limits<std::uint64_t>::max();  ///< for the mesh [bytes]
};

/// The polygon soup of a scene: surface k is polygon k, obstruction-only surfaces are sheets.
PolygonSoup make_soup(const Scene& scene);

/// Cuts every surface that is not obstruction-only. Surfaces of zero area give no patch. Patch order is surface order.
///  - Convex quadrilaterals become m × n quadrilaterals whose points divide opposite edges evenly (bilinear). Of one
///  that
///    is not planar every patch still lies on the facets: it is bent, in two pieces, where the diagonal crosses it.
///  - Triangles become n² triangles.
///  - Other polygons (more corners, non-convex, with holes) are cut by a square grid along their longest edge. A patch
///  is
///    what a cell holds of the polygon, on one or more facets; each of its elements lies on one facet.
///  - Facets narrower than 2^-40 of their coordinates, which rounded points cannot cut, stay whole.
/// Points on an edge depend on its two ends and the number of parts only, bit for bit, whichever surface they belong
/// to. patch_size ≥ 0 and finite, elements_per_edge ≥ 1, or std::invalid_argument; else what refuse_too_large_a_mesh
/// throws, before anything is cut.
PatchMesh make_patch_mesh(const Scene& scene, const PolygonSoup& soup, const MeshOptions& options);

/// The same of the surfaces `first` … `last` − 1 only, which are the soup's polygons from `polygon` on.
PatchMesh make_patch_mesh(const Scene& scene, const PolygonSoup& soup, const MeshOptions& options, std::uint32_t first,
                          std::uint32_t last, std::uint32_t polygon);

/// Throws LimitError, with the numbers, when the mesh would have more points than 32 bits count or would take more
/// memory, about, than the options allow.
void refuse_too_large_a_mesh(const Scene& scene, const PolygonSoup& soup, const MeshOptions& options);

}  // namespace exitance
