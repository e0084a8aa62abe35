#pragma once
// Where along its trace on the receiver a visual event can be seen.

#include <cstdint>
#include <array>
#include <span>
#include <vector>

#include "geometry/viewpoint.h"
#include "src/form_factor/sight_plane.h"

namespace exitance {

/// An event is seen from where a line of sight runs through what makes it and on to the source, and nothing else blocks
/// that. What blocks is found a little smaller, and what is left a little larger, than it is: by 1e-9 of the receiver's
/// size and more, so that rounding hides none that is longer, unless the scene's coordinates are 10,000 times as large
/// as the receiver.
class EventReach {
 public:
  /// items: what may stand between, of the soup's index.
  EventReach(const PolygonSoup& soup, const Source& receiver, const Source& source,
             std::span<const std::uint32_t> items);

  /// How a line of sight runs from the receiver to the source.
  enum class Way : std::uint8_t {
    vertex_edge,    ///< past a vertex, then past an edge
    edge_vertex,    ///< past an edge, then past a vertex
    vertex_source,  ///< past a vertex to an edge of the source
    edge_source     ///< past an edge to a vertex of the source
  };
  /// Of a vertex in line with an edge: their plane, through the vertex; stretches along `along`, from plane.point on.
  std::vector<LineStretch> of_vertex_edge(const CutPlane& plane, const Vec3& vertex, const Vec3& from, const Vec3& to,
                                          Way way, Vec3& along) const;

  /// Of two edges in one plane.
  std::vector<LineStretch> of_edges(const CutPlane& plane, std::span<const Vec3, 2> one, std::span<const Vec3, 2> other,
                                    Vec3& along) const;

  /// Of a facet seen edge-on, and where it meets the receiver.
  std::vector<LineStretch> of_facet(const CutPlane& plane, std::span<const Vec3> facet, Vec3& along) const;

 private:
  struct Blocker {
    std::vector<Vec3> loop;
    std::uint32_t item = 0;
  };
  LineStretch shadow_of(const SightPlane& sight, std::span<const Vec3> facet) const;
  bool clip_to_front(std::array<Vec3, 2>& segment) const;
  void take_out_blocked(const SightPlane& sight, const Vec3& vertex, std::vector<LineStretch>& stretches) const;

  CutPlane receiver_, source_plane_;
  std::vector<Vec3> loop_, source_;
  double size_ = 0;  ///< of the receiver
  std::vector<Blocker> blockers_;
};

}  // namespace exitance
