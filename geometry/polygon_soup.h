#pragma once
// The polygons of a scene, cut into facets, with what does not depend on the point of view: merged vertices, planes,
// neighbours, shells, coplanar contacts and a spatial index. Immutable, so any number of threads may look at it. A soup
// that another was made from by an edit shares with it all that is the same.

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "geometry/level.h"
#include "geometry/paged.h"
#include "geometry/polygon.h"
#include "geometry/predicates.h"
#include "geometry/spatial_index.h"

namespace exitance {

/// How a polygon takes part.
enum class Role : std::uint8_t {
  patch,  ///< emits, receives and occludes; covers an earlier patch in its plane that faces the same way and, where
          ///< matter is behind it (matter.h), one that it faces: what lies between is buried
  sheet,  ///< occludes only; covers every patch in whose plane it lies
  solid_face,  ///< a face, outward, of a closed polyhedron that occludes only; covers a patch in its plane which it
               ///< faces
  unoccluding  ///< can be asked about, hides nothing
};

inline constexpr std::uint32_t kNone = 0xffffffffu;

/// When facets of different polygons count as in one plane.
enum class Planes : std::uint8_t {
  as_written,  ///< where their coordinates say so, exactly
  rounded      ///< also where they are level (level.h) within kLevel of the extent, as those of turned scenes are
};

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
  std::uint32_t shell = kNone;  ///< as the facet's
  bool all = false;             ///< there are no others
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
  /// Where polygons stand among others that lie in the same plane: what is less counts as earlier in the scene.
  using Rank = std::uint64_t;

  /// Takes polygons without defects other than zero area (those have no facets). roles: one for each polygon, or empty
  /// for all `patch`. ranks: likewise, or empty for the order in which they are given. spare: room for so many facets
  /// that later edits bring (`edited`), and for as many polygons.
  explicit PolygonSoup(std::span<const Polygon> polygons, std::span<const Role> roles = {},
                       std::span<const Rank> ranks = {}, std::uint32_t spare = 0, Planes planes = Planes::as_written);

  struct Arrival {
    std::span<const Polygon> polygons;
    std::span<const Role> roles;  ///< one for each; none is unoccluding
    std::span<const Rank> ranks;  ///< one for each
  };
  struct PolygonRange {
    std::uint32_t first = 0, last = 0;
  };

  /// The soup in which the polygons first … last − 1 of `before` are gone and others have come (`arrived`). All other
  /// polygons, facets and shells keep their numbers; those that are gone are there still, but in nothing that is
  /// searched. Takes time and memory by what goes and comes and by what lies beside that, not by all. None where it
  /// cannot be told from that alone what others become, and the soup must be made anew: what goes or comes meets edges
  /// of others or, with edges that it leaves open, their faces; patches lie against each other where none did; what
  /// comes is a few roundings off others (level_chain.h) or, where any are or were, what goes or comes lies on others;
  /// the extent changes; the spare room is used up. No two threads may make soups from `before`, or from soups that
  /// share with it, at a time.
  static std::optional<PolygonSoup> edited(const PolygonSoup& before, PolygonRange gone, const Arrival& arrival);

  PolygonSoup(const PolygonSoup&) = delete;  // only edits share
  PolygonSoup& operator=(const PolygonSoup&) = delete;
  PolygonSoup(PolygonSoup&&) = default;
  PolygonSoup& operator=(PolygonSoup&&) = default;

  /// Whether one was made from the other, or both from a third, by edits.
  bool shares_with(const PolygonSoup& other) const { return store_ == other.store_; }
  /// The numbers of the polygons that came with the last edit.
  PolygonRange arrived() const { return arrived_; }
  /// Facets that lie beside what the last edit changed, and the new ones; ascending.
  std::span<const std::uint32_t> touched() const { return touched_; }

  std::span<const Vec3> vertices() const { return vertices_; }
  /// With those that are gone, and spare ones, which have no corners.
  std::span<const Facet> facets() const { return facets_; }
  bool is_present(std::uint32_t facet) const;
  std::span<const Corner> corners(const Facet& f) const { return {corners_.data() + f.first, f.count}; }
  const FirstCorners& first_corners(std::uint32_t facet) const { return first_corners_[facet]; }
  Box box_of(std::uint32_t facet) const;  ///< around its corners

  /// With those that are gone.
  std::size_t polygon_count() const { return roles_.size(); }
  Role role(std::uint32_t polygon) const { return roles_[polygon]; }

  /// The facets of polygon p are first_facet(p) … first_facet(p + 1) − 1.
  std::uint32_t first_facet(std::uint32_t polygon) const { return first_facet_[polygon]; }

  /// With those that are gone. Closed manifolds that bound a solid (shell.h). A ray from outside the box meets a front
  /// face of the shell before any back face: back faces hide nothing that front faces do not.
  std::span<const Shell> shells() const { return shells_; }

  /// Other facets that lie exactly in the plane of facet f, or of the same polygon within rounding (2^-40 of f's size),
  /// and touch its box, and those level with it (Planes) or, of what occludes, in a chain (level_chain.h), ascending.
  std::span<const std::uint32_t> coplanar(std::uint32_t f) const { return coplanar_[f]; }

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
  /// The same of nothing but first_corners.
  void prefetch_corners(std::span<const std::uint32_t> items) const;

  /// Largest absolute coordinate.
  double extent() const { return extent_; }
  /// [m] How far apart facets may lie that count as in one plane: 0 where only coordinates count.
  double level() const { return planes_ == Planes::rounded ? kLevel * extent_ : 0; }
  /// [m] The same by way of others (level_chain.h): 65 sheets, each level with the next, are no farther apart.
  double pile() const { return 64 * level(); }

 private:
  struct Store;  // what edited soups share: each place of its arrays is written once
  using Cut = std::vector<std::vector<std::vector<Vec3>>>;  // by polygon, the corners of its facets

  PolygonSoup() = default;
  void set_spans();
  void add_facets(const Cut& cut, const PolygonSoup* known);
  std::uint32_t vertex_at(const Vec3& point) const;
  void find_neighbours(std::uint32_t first);
  void find_shells(std::uint32_t first);
  void find_coplanar();
  void find_what_is_behind(std::span<const Polygon> polygons);
  void build_index();
  bool lies_in_plane(std::uint32_t t, std::uint32_t f) const;
  bool is_coplanar(std::uint32_t t, std::uint32_t f) const;
  bool lie_on_others(std::uint32_t first, std::uint32_t last) const;
  bool is_piled(std::uint32_t f) const;
  void find_facets(const Box& box, std::vector<std::uint32_t>& found) const;
  bool joins_others(std::uint32_t first, std::uint32_t last, std::vector<std::uint32_t>& beside) const;
  bool joins(std::uint32_t f, std::uint32_t g, double near) const;
  void leave(std::uint32_t first, std::uint32_t last);
  void update_coplanar(std::uint32_t first, std::span<const std::uint32_t> beside);
  bool is_against_patch(std::uint32_t f) const;
  std::vector<SpatialIndex::Item> items_from(std::uint32_t first_facet, std::uint32_t first_shell) const;
  std::pair<int, std::int64_t> depth_in_plane(std::uint32_t f, bool from_front) const;

  std::shared_ptr<Store> store_;
  std::span<const Vec3> vertices_;
  std::span<const Facet> facets_;
  std::span<const Corner> corners_;
  std::span<const FirstCorners> first_corners_;  // by facet
  std::span<const Shell> shells_;
  std::span<const Role> roles_;                                // by polygon
  std::span<const std::uint32_t> first_facet_;                 // by polygon, and the end
  Paged<std::vector<std::uint32_t>> coplanar_;                 // by facet
  std::vector<std::pair<std::uint32_t, std::uint32_t>> gone_;  // facets first … last − 1, ascending
  std::uint32_t used_ = 0;                                     ///< facets before the spare ones
  PolygonRange arrived_;
  std::vector<std::uint32_t> touched_;
  SpatialIndex index_;
  double extent_ = 0;
  Planes planes_ = Planes::as_written;
  bool piled_ = false;  ///< some facets are, or once were, apart as ends of chains are
};

}  // namespace exitance
