#pragma once
// The projection of a polygon along a coordinate axis, in which its turns are decided exactly.

#include <optional>

#include "geometry/polygon.h"

namespace exitance {

/// Drops along an axis. Keeps the sense of rotation of what faces in the axis' direction, turns the rest over.
struct Projection {
  int axis = 2;

  constexpr double u(const Vec3& p) const { return p[(axis + 1) % 3]; }
  constexpr double v(const Vec3& p) const { return p[(axis + 2) % 3]; }
};

/// The projection in which a loop's area is largest, as far as rounding can tell; it is never one in which the loop
/// shrinks to a segment. None if all points lie on one line in space, exactly.
std::optional<Projection> largest_projection(const std::vector<Vec3>& loop);

/// Sign of the turn a → b → c in the projection, exact: +1 to the left, 0 straight (or back, or standing), −1 to the
/// right.
int turn(Projection projection, const Vec3& a, const Vec3& b, const Vec3& c);

/// The loop without its repetitions of a point directly after itself, the last and the first point included.
std::vector<Vec3> without_repeats(const std::vector<Vec3>& loop);

}  // namespace exitance
