#pragma once
// Events of three edges: where a receiver's point sees three edges meet in one direction (EEE events in Gigus and Malik
// 1990), and cells cut along them.

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "geometry/viewpoint.h"
#include "src/form_factor/area_cell.h"

namespace exitance {

/// Three lines in space, and the points x from which one line of sight meets them all: the normals (a − x) × (b − x) of
/// the planes through x and each line have determinant 0. On a plane that is a conic, because the cubic terms cancel;
/// where two of the lines meet in a vertex, a straight line.
class EdgeEvent {
 public:
  explicit EdgeEvent(std::span<const SeenEdge, 3> edges);

  /// The determinant, quadratic on any plane.
  double at(const Vec3& x) const;
  /// The straight line, where two of the edges share a vertex.
  const std::optional<CutPlane>& plane() const { return plane_; }
  /// The same for the same three edges in any order.
  std::uint64_t id() const { return id_; }

 private:
  std::array<std::array<Vec3, 2>, 3> line_;
  std::optional<CutPlane> plane_;
  std::uint64_t id_ = 0;
};

/// Events that may have happened between two points of view next to each other, from what each sees of a source, the
/// likeliest first.
std::vector<EdgeEvent> events_between(std::span<const SeenEdge> here, std::span<const SeenEdge> there);

/// An event that a rule's points do not show, because all of them lie on one side of it; `beyond` lies on the other.
struct HiddenEvent {
  EdgeEvent event;
  Vec3 beyond;
};

/// Events that may happen within a cell although its points see one and the same outline, as seen from one of them, x:
/// where another edge comes to where two of the outline's cross. `edges`: all that may. Found along the cell's sides.
/// `stop`, asked before each crossing, ends the search with what it has found; may be empty.
std::vector<HiddenEvent> hidden_events(std::span<const SeenEdge> outline, std::span<const SeenEdge> edges,
                                       const Vec3& x, const AreaCell& cell, const std::function<bool()>& stop = {});

/// Cuts a cell along an event; the pieces next to it have it as a side. Nothing where the event does not cross the cell
/// from one side to another in one arc, which is flat enough for a rule, or, of a bent cell, not beside the bent sides.
std::vector<AreaCell> cut(const AreaCell& cell, const EdgeEvent& event);

}  // namespace exitance
