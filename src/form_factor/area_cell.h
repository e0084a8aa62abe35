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

/// What bends a side into a conic: where the tangents at its ends meet, and the weight of that point in the rational
/// quadratic curve (Farin 2002). Weight 0: the side is straight.
struct Bend {
  Vec3 control;
  double weight = 0;
};

/// A triangle or quadrilateral, counter-clockwise seen from the front: convex, but for its first side, and the one
/// opposite of it, which may be conics.
struct AreaCell {
  std::array<Vec3, 4> corner;
  int corners = 3;
  Bend bend{};      ///< of the side from corner 0 to 1
  Bend opposite{};  ///< of the side from corner 3 to 2; a triangle has none

  bool is_straight() const { return bend.weight == 0 && opposite.weight == 0; }
  std::span<const Vec3> loop() const { return {corner.data(), static_cast<std::size_t>(corners)}; }
  double area() const;
};

/// The cell's area as a vector normal to it. Not 0 where only the corners lie in one line.
Vec3 vector_area(const AreaCell& cell);

/// A point of a side, and the derivative there; s from 0 to 1.
struct SidePoint {
  Vec3 at, along;
};
SidePoint first_side(const AreaCell& cell, double s);     ///< from corner 0 to 1
SidePoint opposite_side(const AreaCell& cell, double s);  ///< from corner 3 to 2; of a triangle, its last corner

/// Whether the map of the square onto a cell, which gauss_points() tells of, does not fold, in the plane of `normal`,
/// on its side: seen at places along both sides, the denser the nearer to corners. Sides may start from one point, or
/// along each other.
bool is_regular(const AreaCell& cell, const Vec3& normal);

/// Cuts a convex loop into cells.
std::vector<AreaCell> cells_of(std::span<const Vec3> loop);

/// Cuts a straight cell by a plane; nothing where the plane leaves it whole up to rounding.
std::vector<AreaCell> cut(const AreaCell& cell, const CutPlane& plane);

/// Whether the plane has part of a convex loop on each side, by more than rounding: then cut() would cut.
bool crosses(std::span<const Vec3> loop, const CutPlane& plane);

/// Halves a cell across its longer side; a bent one only so that the halves are regular, if either way is.
std::pair<AreaCell, AreaCell> bisect(const AreaCell& cell);

struct WeightedPoint {
  Vec3 point;
  double weight = 0;  ///< all weights of a rule sum to the cell's area; negative where the map of a bent cell folds
};

/// Product Gauss rule of 2 … kHighestOrder points along each side. The square is mapped onto the cell by straight lines
/// from its first side to the opposite one; a triangle is a quadrilateral with a double corner. All points lie in the
/// cell's interior. Point i · order + j has place i along the one side of the square and j along the other.
void gauss_points(const AreaCell& cell, int order, std::vector<WeightedPoint>& points);

inline constexpr int kHighestOrder = 16;

struct Truncation {
  double error = 0;     ///< of an analytic integrand, from above
  double expected = 0;  ///< what it is if the coefficients go on falling as they did
  double last = 0;      ///< size of the coefficients of highest order
  double fall = 0;      ///< at most 1: from one order to the next
};

/// What a product Gauss rule knows of its own error, from the integrand times weight at its points alone. Their
/// expansion in products of Legendre polynomials ends in a ring of highest order; how fast the rings fall tells what
/// comes behind. An analytic function's coefficients fall as ρ^-k, and the rule of order n errs by less than those of
/// order 2n; thirty times as much is given, and more where the fall is so slow that it tells little. Of a function with
/// a kink the rings hardly fall, which the figure shows; but a small kink hides below coefficients that still fall.
Truncation truncation_of(std::span<const double> weighted, int order);

}  // namespace exitance
