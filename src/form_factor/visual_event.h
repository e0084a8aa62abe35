#pragma once
// A line on a receiver along which the shape of what it sees changes.

#include <cmath>
#include <span>

#include "src/form_factor/sight_plane.h"

namespace exitance {

/// A plane whose trace on the receiver matters only along a stretch, at the points x where dot(along, x − plane.point)
/// lies in it.
struct VisualEvent {
  CutPlane plane;
  Vec3 along;  ///< unit vector
  LineStretch stretch{-INFINITY, INFINITY};

  /// Whether the event may happen within a convex loop, at a line that cuts it.
  bool concerns(std::span<const Vec3> loop) const;
};

}  // namespace exitance
