#pragma once
// The plane of a visual event: lines of sight in it, and where they start on the receiver.

#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "geometry/vec3.h"
#include "src/form_factor/area_cell.h"

namespace exitance {

/// A stretch of a line; empty at first.
struct LineStretch {
  double from = INFINITY, to = -INFINITY;

  bool empty() const { return !(from <= to); }
  void add(double t);
  void add(const LineStretch& other);
  void keep_within(const LineStretch& other);
};

/// What lies in the plane has two coordinates there: along its trace on the receiver, from plane.point on, and the
/// height above it.
class SightPlane {
 public:
  struct Place {
    double along = 0, height = 0;
  };

  /// `plane` cuts the receiver's, whose normal is a unit vector. Points nearer than `blur`, a share of their distance
  /// from plane.point, count as lying in it.
  SightPlane(const CutPlane& receiver, const CutPlane& plane, double blur);

  const Vec3& along() const { return along_; }  ///< unit vector in the direction of the trace
  Place place_of(const Vec3& v) const;

  /// The stretch of a convex loop that lies in the plane; where `across` is asked for, only of one that reaches to both
  /// sides.
  std::optional<std::array<Vec3, 2>> chord_of(std::span<const Vec3> loop, bool across) const;

  enum class Order { before, beyond };
  /// Where lines of sight through the pivot and a segment start, which they meet before or beyond the pivot. Of the
  /// segment only what lies above the receiver counts. The pivot's height must be positive.
  LineStretch through(const Place& pivot, const Place& a, const Place& b, Order order) const;

 private:
  CutPlane receiver_, plane_;
  Vec3 along_;
  double blur_ = 0;
};

/// What is left of stretches when another one is taken out of them.
void take_out(std::vector<LineStretch>& stretches, const LineStretch& gap);

}  // namespace exitance
