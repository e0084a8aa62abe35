#pragma once
// The polygons of a scene, cut into facets, with what does not depend on the point of view: merged vertices, planes,
// neighbours, shells, coplanar contacts and a spatial index. Immutable, so any number of threads may look at it.

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "geometry/polygon.h"
#include "geometry/predicates.h"
#include "geometry/spatial_index.h"

namespace exitance {

/// How a polygon takes part.
enum class Role : std::uint8_t {
  patch,  ///< emits, receives and occludes; covers an earlier patch in its plane that faces the same way and, as part
          ///< of a closed surface, one that it faces: what lies between is buried in a solid
  sheet,  ///< occludes only; covers every patch in whose plane it lies
  solid_face,  ///< a face, outward, of a closed polyhedron that occludes only; covers a patch in its plane which it
               ///< faces
  unoccluding  ///< can be asked about, hides nothing
};

inline constexpr std::uint32_t kNone = 0xffffffffu;

/// A facet's plane: 0 = normal · (v − origin), up to rounding.
struct Plane {
  Vec3 origin;              ///< one of the vertices
  Vec3 normal;              ///< rounded cross product of two edges, not of unit length
  double normal_error = 0;  ///< bound of the error of each of the normal's components
  double normal_size = 0;   ///< largest of |components|
  PlanePoints points;       ///< three vertices, counter-clockwise, that define the plane exactly
  int axis = -1;            ///< 0, 1, 2: exactly perpendicular to that axis; −1: not
  int axis_sign = 0;        ///< of the exact normal along that axis
};

/// Sign of v against the plane, exact: +1 in front.
int side_of(const Plane& plane, const Vec3& v, StageCounts& counts);

/// A convex, exactly planar piece of a polygon.
struct alignas(64) Facet {
  std::uint32_t first = 0;  ///< of its corners
  std::uint32_t count = 0;
  std::uint32_t polygon = 0;    ///< index of the input polygon
  std::uint32_t shell = kNone;  ///< the shell it belongs to, if any
  Plane plane;
};

struct Corner {
  Vec3 at;  ///< vertices()[vertex], here once more because searches for occluders read little else
  std::uint32_t vertex = 0;
  std::uint32_t neighbour =
      kNone;  ///< across the edge from here to the next corner, behind which the same matter lies; kNone: none
};

/// Corners of a facet side by side: its first four, or those of a triangle and once more the first.
struct alignas(32) FirstCorners {
  std::array<double, 4> x, y, z;
  std::array<std::uint32_t, 4> vertex;
  bool all = false;  ///< there are no others
};

/// An edge of a shell: from – to runs counter-clockwise around facet `left`, clockwise around `right`.
struct ShellEdge {
  std::uint32_t from, to, left, right;
};

/// Facets that bound a solid, facing out.
struct Shell {
  Box box;
  bool convex = false;                          ///< exactly, along every edge
  std::vector<std::uint32_t> facets, vertices;  ///< each once, ascending
  std::vector<ShellEdge> edges;                 ///< each once
};

class PolygonSoup {
 public:
  /// Takes polygons without defects other than zero area (those have no facets). roles: one for each polygon, or empty
  /// for all `patch`.
  explicit PolygonSoup(std::span<const Polygon> polygons, std::span<const Role> roles = {});
  PolygonSoup(const PolygonSoup&) = delete;  // planes point into vertices()
  PolygonSoup& operator=(const PolygonSoup&) = delete;
  PolygonSoup(PolygonSoup&&) = default;
  PolygonSoup& operator=(PolygonSoup&&) = default;

  std::span<const Vec3> vertices() const { return vertices_; }
  std::span<const Facet> facets() const { return facets_; }
  std::span<const Corner> corners(const Facet& f) const { return {corners_.data() + f.first, f.count}; }
  const FirstCorners& first_corners(std::uint32_t facet) const { return first_corners_[facet]; }

  std::size_t polygon_count() const { return roles_.size(); }
  Role role(std::uint32_t polygon) const { return roles_[polygon]; }

  /// The facets of polygon p are first_facet(p) … first_facet(p + 1) − 1.
  std::uint32_t first_facet(std::uint32_t polygon) const { return first_facet_[polygon]; }

  /// Closed manifolds that bound a solid (shell.h). A ray from outside the box meets a front face of the shell before
  /// any back face: back faces hide nothing that front faces do not.
  std::span<const Shell> shells() const { return shells_; }

  /// Other facets that lie exactly in the plane of facet f, or of the same polygon within rounding (2^-40 of f's size),
  /// and touch its box, ascending.
  std::span<const std::uint32_t> coplanar(std::uint32_t f) const {
    return {coplanar_.data() + coplanar_first_[f], coplanar_.data() + coplanar_first_[f + 1]};
  }

  /// Whether facet t, one of coplanar(f), covers the front of f where they overlap (Role). Facets of one polygon never
  /// do.
  bool covers(std::uint32_t t, std::uint32_t f) const;

  /// Whether facet t, one of coplanar(f), hides the back of f where they overlap, so that of all in a plane one is seen
  /// from either side: the other side of a sheet does, and of backs that of matter, else the earlier one, which lies
  /// beneath. What is unoccluding is hidden on its front only.
  bool covers_back(std::uint32_t t, std::uint32_t f) const;

  /// Of all that occludes: item k is facet k, or shell k − facets().size() where that is convex; the facets of convex
  /// shells are not items themselves.
  const SpatialIndex& index() const { return index_; }

  /// Asks for the memory of items of the index before it is needed: a search in a large scene meets items that nothing
  /// has looked at for long, and then spends most of its time waiting for one after the other.
  void prefetch(std::span<const std::uint32_t> items) const;

  /// Largest absolute coordinate.
  double extent() const { return extent_; }

 private:
  void add_facets(std::span<const Polygon> polygons);
  void find_neighbours();
  void find_shells();
  void find_coplanar();
  void find_closed(std::span<const Polygon> polygons);
  void build_index();
  std::pair<int, std::int64_t> depth_in_plane(std::uint32_t f, bool from_front) const;

  std::vector<Vec3> vertices_;
  std::vector<Facet> facets_;
  std::vector<Corner> corners_;
  std::vector<FirstCorners> first_corners_;  // by facet
  std::vector<Shell> shells_;
  std::vector<Role> roles_;
  std::vector<bool> closed_;  // by polygon: part of a closed surface; known only where patches lie against each other
  std::vector<std::uint32_t> first_facet_;
  std::vector<std::uint32_t> coplanar_, coplanar_first_;
  SpatialIndex index_;
  double extent_ = 0;
};

}  // namespace exitance
