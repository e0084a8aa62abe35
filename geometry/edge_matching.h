#pragma once
// Which edges of polygons meet, and what is left open: the topology of a polygon soup, found from exact coordinates.

#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "geometry/polygon.h"

namespace exitance {

/// An edge of a polygon, or a stretch of one; the polygon lies to its left seen from the front.
struct DirectedEdge {
  Vec3 from, to;
  std::uint32_t polygon = 0;
};

struct EdgeMatching {
  /// The piece of connected surface that each polygon belongs to, counted from 0 in the order of first polygons.
  /// Polygons are connected where their edges cancel (see below), not where pieces only touch.
  std::vector<std::uint32_t> piece;
  std::uint32_t pieces = 0;
  std::vector<DirectedEdge> open;  ///< what no other edge of its piece cancels
};

/// Two edges cancel where they run along each other in opposite directions. Edges are equal only if their coordinates
/// are (−0 equals 0). A vertex that lies exactly on an edge cuts it (T-junction), so a long edge may be cancelled by
/// several short ones. Where more than two edges meet, those cancel that bound matter between their backs: two boxes
/// that touch along an edge, or with a whole face, stay two pieces. Repeated vertices make no edge. Takes n log n in
/// the edges. near [m]: a vertex so near to an edge, and farther from its ends, cuts it, too, as far as double precision
/// tells: T-junctions of turned scenes. REQUIRES: finite coordinates.
EdgeMatching match_edges(std::span<const Polygon> polygons, double near = 0);

/// Of edges between the same two points, those that bound matter between the backs of their polygons, by their indices
/// in the group: going round the line, matter begins at one and ends at the other. Each edge is in one pair at most.
/// normal(p): the normal of polygon p, of any length but zero; polygons whose angles round the line differ by less than
/// 1e-9 are taken to lie on each other.
std::vector<std::pair<std::size_t, std::size_t>> pairs_round_line(std::span<const DirectedEdge> group,
                                                                  const std::function<Vec3(std::uint32_t)>& normal);

/// All edges: the outer loops', and the holes', turned round where needed so that the polygon lies to the left.
std::vector<DirectedEdge> directed_edges(std::span<const Polygon> polygons);

}  // namespace exitance
