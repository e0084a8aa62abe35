#pragma once
// The quadtrees of a scene's patches, whose nodes ("sub-patches") are what links join.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/polygon_soup.h"
#include "geometry/shaft.h"
#include "geometry/viewpoint.h"
#include "src/links/lid.h"
#include "src/scene/edit.h"
#include "src/scene/patch_mesh.h"

namespace exitance {

/// A triangle or a convex quadrilateral in a facet's plane.
struct Node {
  std::array<Vec3, 4> corner;  ///< counter-clockwise seen from the front
  std::uint8_t corners = 4;    ///< 3 or 4
  std::uint8_t level = 0;      ///< 0: a root
  bool whole = false;          ///< all of its facet
  bool covered = false;        ///< some of it, by what lies on it, for certain or within rounding
  bool covered_anew = false;   ///< it is or was, and by other things or at other places since the last edits
  bool receives_anew = false;  ///< at other points than before (open_points), as it is covered anew
  std::uint32_t facet = 0;     ///< of the soup
  std::uint32_t root = 0;      ///< of the tree
  std::uint32_t parent = kNone;
  std::uint32_t first_child = kNone;  ///< of four, which stand side by side; kNone: none
  double area = 0;                    ///< [m²]
  double open_area = 0;               ///< [m²] what of it nothing covers

  std::span<const Vec3> loop() const { return {corner.data(), corners}; }
  bool has_children() const { return first_child != kNone; }
};

/// What of a patch is one quadtree. Its nodes are contiguous, parents before their children.
struct Root {
  std::uint32_t node_first = 0, node_count = 0;
  std::uint32_t object = 0;
  std::uint32_t surface = 0;  ///< within its object
  bool present = false;       ///< false: of an object that is not there, or has become others
  bool placed = false;        ///< since it was last seen what covers it
  bool covered_anew = false;  ///< some node is
};

/// A place from which a node receives, and its share of the node's area.
struct NodePoint {
  Vec3 at;
  double weight = 0;
};

struct TreeOptions {
  MeshOptions mesh;  ///< what the patches are; elements_per_edge does not count
  /// Where nodes end: one whose quarters would be smaller than this on average has no children [m², > 0].
  double smallest_area = 1;
  unsigned points_per_edge = 2;  ///< 1 … 20; squared, the points by which nodes receive
};

/// A quadtree a patch: every node that is not too small has four children, whether links reach them or not, so that a
/// node depends on its patch only. Quadrilaterals are divided at the middles of their sides and their corners' mean
/// (both ends of a side in any order give the same bits), triangles at the middles of their sides. A patch of more
/// corners, or on several facets, becomes several roots: fans of quadrilaterals around its first corner.
class PatchTree {
 public:
  /// soup: of the scene as it is. Throws std::invalid_argument on a smallest area that is not positive, LimitError when
  /// there would be more nodes than 2^31, and what make_patch_mesh throws.
  PatchTree(const EditedScene& scene, const PolygonSoup& soup, const TreeOptions& options);

  /// After an edit of the geometry of an object; soup: of the scene as it is now, and each object's polygons there. All
  /// other nodes keep their numbers and places. The object's keep their numbers where it has as many roots as before of
  /// nearly the same areas (1e-6, relative); otherwise they are void and it has new ones behind all others.
  void change_geometry(const EditedScene& scene, const PolygonSoup& soup,
                       std::span<const PolygonSoup::PolygonRange> polygons, std::uint32_t object);

  /// Finds what covers the nodes of a scene, once it was made and when all edits of its geometry have been followed:
  /// by clipping, to 2^-30 of an area, of what lies in their planes exactly or but for rounding. Contacts are those of
  /// the soup.
  void cover(const PolygonSoup& soup, const Contacts& contacts);
  /// The points by which a node receives: those of node_points that nothing covers (cover), or where there are none of
  /// twice, four times … as many an edge, up to 20. Their weights sum to 1; none where nothing, or next to it, is open.
  void open_points(std::uint32_t node, unsigned per_edge, std::vector<NodePoint>& points) const;

  /// By how many links between patches receive; Node::receives_anew is of these.
  unsigned points_per_edge() const { return options_.points_per_edge; }

  std::span<const Node> nodes() const { return nodes_; }
  std::span<const Root> roots() const { return roots_; }
  const Node& node(std::uint32_t n) const { return nodes_[n]; }
  const Root& root(std::uint32_t r) const { return roots_[r]; }
  std::uint32_t object_of(std::uint32_t node) const { return roots_[nodes_[node].root].object; }
  /// Of an object, in the soup that the nodes' facets are those of.
  std::uint32_t facet_first(std::uint32_t object) const { return facet_first_[object]; }

 private:
  std::vector<Node> root_nodes(const EditedScene& scene, const PolygonSoup& soup, std::uint32_t polygon,
                               std::uint32_t object, std::vector<std::uint32_t>& surfaces) const;
  void append(const std::vector<Node>& root_nodes, const std::vector<std::uint32_t>& surfaces, std::uint32_t object);
  void place_children(std::uint32_t node);
  void number_facets(const PolygonSoup& soup, std::span<const PolygonSoup::PolygonRange> polygons);
  void set_open_area(std::uint32_t node, std::span<const Lid> before, std::span<const Lid> lids,
                     std::span<const Lid> changed);

  TreeOptions options_;
  std::vector<Node> nodes_;
  std::vector<Root> roots_;
  std::vector<std::vector<Lid>> lids_;                  ///< by root
  std::vector<std::uint32_t> root_first_, root_count_;  ///< by object
  std::vector<std::uint32_t> facet_first_;              ///< by object, in the soup of the facets as they are numbered
};

/// per_edge² points of the Gauss product rule, weighted by area, in a fixed order; of a triangle the rule of a
/// quadrilateral whose last two corners are one. weights sum to 1. per_edge: 1 … 20.
void node_points(const Node& node, unsigned per_edge, std::vector<NodePoint>& points);

/// Whether some of each node lies in front of the other's plane, by more than 2^-40 of the soup's extent: others
/// exchange nothing that counts and have no link. Depends on the two nodes only.
bool face_each_other(const Node& a, const Node& b, const PolygonSoup& soup);

/// Around a node, about its corners' mean.
struct Ball {
  Vec3 centre;
  double radius = 0;
};
Ball ball_around(const Node& node);

/// At least the form factor from any point of the receiver to the source: by its area, the least distance of the balls
/// around both and the largest cosines at that; 1 where the balls meet.
double most_form_factor(const Node& receiver, const Node& source, const PolygonSoup& soup);

/// A node as one end of a shaft, or as a source; the node must outlive it.
ShaftEnd shaft_end(const Node& node);
Source source_of(const Node& node);

}  // namespace exitance
