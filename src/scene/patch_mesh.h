#pragma once
// Patches (which shoot) and elements (which receive): the surfaces of a scene cut to a requested size.

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/polygon_soup.h"
#include "geometry/viewpoint.h"
#include "src/scene/scene.h"

namespace exitance {

/// A convex piece of a facet, as a source of light. Empty loop (loop_count 0): the whole facet.
struct PatchPiece {
  std::uint32_t facet = 0;
  std::uint32_t loop_first = 0, loop_count = 0;  ///< in PatchMesh::points
  double area = 0;                               ///< [m²]
};

/// The unit that shoots. Its pieces and its elements are contiguous.
struct Patch {
  std::uint32_t surface = 0;
  std::uint32_t piece_first = 0, piece_count = 0;
  std::uint32_t element_first = 0, element_count = 0;
  double area = 0;  ///< [m²], the sum of its elements'
};

/// The unit that receives, with one sample point: interior to it and to the facet it is on, away from the facet's edges.
struct Element {
  std::uint32_t patch = 0;
  std::uint32_t facet = 0;  ///< on which the sample point lies, by identity
  Vec3 sample;
  Vec3 normal;        ///< of that facet, unit length
  double area = 0;    ///< [m²]
  std::uint32_t loop_first = 0, loop_count = 0;  ///< its outline in PatchMesh::points, counter-clockwise from the front
};

struct PatchMesh {
  std::vector<Vec3> points;
  std::vector<PatchPiece> pieces;
  std::vector<Patch> patches;
  std::vector<Element> elements;

  std::span<const Vec3> loop(const PatchPiece& p) const { return {points.data() + p.loop_first, p.loop_count}; }
  std::span<const Vec3> loop(const Element& e) const { return {points.data() + e.loop_first, e.loop_count}; }
};

struct MeshOptions {
  double patch_size = 0;            ///< longest edge of a patch [m]; 0: every surface is one patch
  std::uint32_t elements_per_edge = 1;  ///< a quadrilateral patch has this many squared elements, a triangle likewise
};

/// The polygon soup of a scene: surface k is polygon k, obstruction-only surfaces are sheets.
PolygonSoup make_soup(const Scene& scene);

/// Cuts every surface that is not obstruction-only. Surfaces of zero area give no patch. Patch order is surface order.
PatchMesh make_patch_mesh(const Scene& scene, const PolygonSoup& soup, const MeshOptions& options);

}  // namespace exitance
