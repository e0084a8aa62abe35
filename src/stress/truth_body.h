#pragma once
// Polygons and bodies in long double, for the exchange of energy by another route (exchange_truth.h).

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace exitance::truth {

using Real = long double;

struct Point {
  Real x = 0, y = 0, z = 0;
};
inline Point operator-(const Point& a, const Point& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Point operator+(const Point& a, const Point& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Point operator*(Real s, const Point& a) {
  return {s * a.x, s * a.y, s * a.z};
}
inline Real dot(const Point& a, const Point& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Point cross(const Point& a, const Point& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Point unit(const Point& a) {
  return (1 / std::sqrt(dot(a, a))) * a;
}
inline bool operator<(const Point& a, const Point& b) {
  return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
}

using Face = std::vector<Point>;  ///< planar, convex

/// The plane through a point, and how far in front of it others are.
struct Side {
  Point normal, origin;
  Real at(const Point& p) const { return dot(normal, p - origin); }
};

/// Of a loop of at least three corners; its normal is not a number where they lie in a line.
Side plane_of(const Face& loop);

/// What of a face lies in front of a plane, empty where that has no area; points within `rounding` of it are on it.
Face clip(const Face& face, const Side& side, Real rounding);

/// Corners and edges, each once.
struct Body {
  std::vector<Point> points;
  std::vector<std::array<std::size_t, 2>> edges;
};

/// Of faces that share corners bit for bit.
Body body_of(const std::vector<Face>& faces);

/// Whether a plane through three corners of the two polygons has both on one side and the body on the other, to within
/// `rounding`: then it hides nothing.
bool is_beside(const Body& body, const Face& a, const Face& b, Real rounding);

}  // namespace exitance::truth
