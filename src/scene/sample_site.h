#pragma once
// Where on an element irradiance is evaluated.

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/polygon_soup.h"

namespace exitance {

struct Element;    // patch_mesh.h
struct PatchMesh;  // likewise

/// Of a convex loop [m].
Vec3 centroid(std::span<const Vec3> loop);

/// Finds where sample points go. The corners of patches are rounded: from a point at a distance d of an edge, patches
/// that end there miss or overlap what they should tile by the rounding over d, up to the whole view where d is a
/// rounding itself. So sample points keep away from where other surfaces end or pass. Holds scratch memory; the soup
/// must outlive it.
class SampleSite {
 public:
  explicit SampleSite(const PolygonSoup& soup) : soup_(soup) {}

  /// A point of the convex piece `loop` of a facet: its centroid, or, where another polygon's edge or a polygon that
  /// crosses the facet is nearer to that than 2^-20 of the scene's extent, or than 1/64 of the way to the nearest
  /// corner where that is less, the one of some points around it that is farthest from such (at most so far). What lies
  /// in the facet's plane and reaches beyond that distance all around is no hindrance.
  Vec3 choose(std::uint32_t facet, std::span<const Vec3> loop);

  /// Of an element: a point of its largest piece.
  Vec3 choose(const PatchMesh& mesh, const Element& element);

  /// [m] What is farther from a piece than this does not matter to its point.
  double reach() const;

 private:
  double clearance(const Vec3& p, std::uint32_t facet, double enough);
  double clearance_of(const Vec3& p, const Facet& other, const Facet& own, double enough) const;

  const PolygonSoup& soup_;
  std::vector<std::uint32_t> found_;
  std::vector<Vec3> loop_;
};

}  // namespace exitance
