#pragma once
// Cells that a receiver is cut into for integration, and Gauss rules over them.

#include <array>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "geometry/vec3.h"

namespace exitance {

/// A plane that cuts cells: the functional normal · (v − point).
struct CutPlane {
  Vec3 normal, point;
  double at(const Vec3& v) const { return dot(normal, v - point); }
};

/// A convex triangle or quadrilateral, counter-clockwise seen from the front.
struct AreaCell {
  std::array<Vec3, 4> corner;
  int corners = 3;

  std::span<const Vec3> loop() const { return {corner.data(), static_cast<std::size_t>(corners)}; }
  double area() const;
};

/// Cuts a convex loop into cells.
std::vector<AreaCell> cells_of(std::span<const Vec3> loop);

/// Cuts a cell by a plane; nothing where the plane leaves it whole up to rounding.
std::vector<AreaCell> cut(const AreaCell& cell, const CutPlane& plane);

/// Whether cut() would cut.
bool crosses(const AreaCell& cell, const CutPlane& plane);

/// Halves a cell across its longer side.
std::pair<AreaCell, AreaCell> bisect(const AreaCell& cell);

struct WeightedPoint {
  Vec3 point;
  double weight = 0;  ///< all weights of a rule sum to the cell's area
};

/// Product Gauss rule of `order` points along each side: 3, 4, 6 or 8. The square is mapped bilinearly onto the cell; a
/// triangle is a quadrilateral with a double corner. All points lie in the cell's interior.
void gauss_points(const AreaCell& cell, int order, std::vector<WeightedPoint>& points);

}  // namespace exitance
