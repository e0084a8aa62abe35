#pragma once
// The polygons of a scene, cut into facets, with what does not depend on the point of view: merged vertices, planes,
// neighbours, coplanar contacts and a spatial index. Immutable, so any number of threads may look at it.

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/polygon.h"
#include "geometry/spatial_index.h"

namespace exitance {

/// How a polygon takes part (DESIGN: coplanar and overlapping).
enum class Role : std::uint8_t {
  patch,       ///< emits, receives and occludes; a later patch lying in its plane and facing the same way covers it
  sheet,       ///< occludes only; covers every patch in whose plane it lies
  solid_face,  ///< a face, outward, of a closed polyhedron that occludes only; covers a patch in its plane which it faces
  unoccluding  ///< can be asked about, hides nothing
};

inline constexpr std::uint32_t kNone = 0xffffffffu;

/// A facet's plane: 0 = normal · (v − origin). The normal is the rounded cross product of two edges (not of unit length),
/// each component of it wrong by at most normal_error.
struct Plane {
  Vec3 origin;
  Vec3 normal;
  double normal_error = 0;
  std::uint32_t a = kNone, b = kNone, c = kNone;  ///< three vertices, counter-clockwise, that define the exact plane
};

struct Facet {
  std::uint32_t first = 0;    ///< of its corners
  std::uint32_t count = 0;
  std::uint32_t polygon = 0;  ///< index of the input polygon
  std::uint32_t shell = kNone;  ///< closed shell (outward faces) it belongs to; kNone when it belongs to none
  Plane plane;
};

struct Corner {
  std::uint32_t vertex = 0;
  std::uint32_t neighbour = kNone;  ///< the one facet across the edge from this corner to the next; kNone: none, or several
};

/// A closed, consistently outward manifold shell; seen from outside its box, its back faces hide nothing that its front
/// faces do not.
struct Shell {
  Box box;
};

class PolygonSoup {
 public:
  /// Takes polygons without defects other than zero area. roles: one for each polygon, or empty for all `patch`.
  explicit PolygonSoup(std::span<const Polygon> polygons, std::span<const Role> roles = {});

  std::span<const Vec3> vertices() const { return vertices_; }
  std::span<const Facet> facets() const { return facets_; }
  std::span<const Corner> corners() const { return corners_; }
  std::span<const Corner> corners(const Facet& f) const { return {corners_.data() + f.first, f.count}; }
  std::span<const Shell> shells() const { return shells_; }
  Role role(std::uint32_t polygon) const { return roles_[polygon]; }
  std::size_t polygon_count() const { return roles_.size(); }

  /// The facets of polygon p are facets()[first_facet(p)] … facets()[first_facet(p + 1) − 1].
  std::uint32_t first_facet(std::uint32_t polygon) const { return first_facet_[polygon]; }

  /// Facets that lie exactly in the plane of facet f and overlap its box, f itself and its polygon's others excepted.
  std::span<const std::uint32_t> coplanar(std::uint32_t f) const {
    return {coplanar_.data() + coplanar_first_[f], coplanar_.data() + coplanar_first_[f + 1]};
  }
  /// Whether facet t, one of coplanar(f), covers f where they overlap.
  bool covers(std::uint32_t t, std::uint32_t f) const;

  const SpatialIndex& index() const { return index_; }  ///< of the facets that occlude

 private:
  std::vector<Vec3> vertices_;
  std::vector<Facet> facets_;
  std::vector<Corner> corners_;
  std::vector<Shell> shells_;
  std::vector<Role> roles_;
  std::vector<std::uint32_t> first_facet_;
  std::vector<std::uint32_t> coplanar_, coplanar_first_;
  SpatialIndex index_;
};

}  // namespace exitance
