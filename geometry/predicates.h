#pragma once
// Exact signs of small polynomials in input coordinates, decided in stages: double with a proven bound, interval,
// exact.

#include <cstdint>
#include <optional>

#include "geometry/vec3.h"

namespace exitance {

/// How many predicates each stage decided.
struct StageCounts {
  std::uint64_t filter = 0, interval = 0, exact = 0;

  StageCounts& operator+=(const StageCounts& other) {
    filter += other.filter;
    interval += other.interval;
    exact += other.exact;
    return *this;
  }
};

/// Unit roundoff of double.
inline constexpr double kRoundoff = 0x1p-53;

/// Sign of det(b − a, c − a, v − a): +1 when v lies in front of triangle abc (seen from v it is counter-clockwise).
///  1. exchanging two arguments negates it;
///  2. it is 0 exactly when the four points are coplanar, coincident points and collinear triples included.
/// REQUIRES: finite coordinates.
int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& v, StageCounts& counts);

/// Sign of normal · (v − x): +1 above the plane through x. 0 exactly on it.
int horizon_side(const Vec3& x, const Vec3& normal, const Vec3& v, StageCounts& counts);

/// The stages of `orientation` by themselves; a stage that can't decide says nothing.
std::optional<int> orientation_filter(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& v);
std::optional<int> orientation_interval(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& v);
int orientation_exact(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& v);

// --- Planes through the point of view -----------------------------------------------------------------------------

/// Three points that define a plane exactly, counter-clockwise seen from its front.
struct PlanePoints {
  const Vec3 *a = nullptr, *b = nullptr, *c = nullptr;
};

/// A plane through the point of view x, as a functional that is linear on points v.
struct ViewPlane {
  enum class Kind : std::uint8_t {
    edge,     ///< det(c − x, d − x, v − x), through an edge cd
    horizon,  ///< normal · (v − x)
    cut  ///< S(x) T(v) − T(x) S(v), through the line in which the planes S (the source's) and T (an occluder's) meet
  };
  Kind kind = Kind::edge;
  int sign = 1;                           ///< factor that makes the functional positive inside
  const Vec3 *c = nullptr, *d = nullptr;  ///< of an edge
  const PlanePoints* T = nullptr;         ///< of a cut
  bool dropped = false;                   ///< c and d stand for where they drop onto S
};

/// A point: an input vertex a, or the point in which the edge ab crosses the horizon or the source's plane S,
/// (w(a) b − w(b) a) / (w(a) − w(b)) with w the plane's functional; it is never rounded.
struct ViewPoint {
  enum class Kind : std::uint8_t { vertex, at_horizon, at_source_plane };
  Kind kind = Kind::vertex;
  bool dropped = false;  ///< a and b stand for where they drop onto S
  int sign_at_a = 0;     ///< of w(a), for crossings
  const Vec3 *a = nullptr, *b = nullptr;
};

/// What all planes and points of one question have in common. A rounded point v that lies in S by identity stands for
/// the point exactly in S where it drops along an axis, v − S(v) / N e: e the axis's unit vector, N that component of
/// the normal of S, which is not 0.
struct ViewFrame {
  Vec3 x, normal;
  PlanePoints S;
  int axis = 0;       ///< of e
  int axis_sign = 1;  ///< of N
};

/// A functional's value with its exact sign.
struct ExactValue {
  double value = 0;
  double error = 0;  ///< bound
  int sign = 0;
};

/// Value of the functional at the point, by interval and, where those are wide, by exact arithmetic (the double filter
/// is the caller's, who has the values at hand). Its sign is exact, its relative error at most `accuracy` or 2^-44.
ExactValue exact_value_at(const ViewFrame& frame, const ViewPlane& plane, const ViewPoint& point, StageCounts& counts,
                          double accuracy = 0x1p-44);

/// Sign that breaks a tie, a functional that is 0 at a point: what it becomes when the point is moved by an
/// infinitesimal (ε, ε², ε³), the first sign that is not 0 of its gradient's components (after Edelsbrunner and Mücke
/// 1990, but for a whole body at once). 0 for an edge that runs towards x.
int gradient_sign(const ViewFrame& frame, const ViewPlane& plane);

/// det(b − a, c − a, v − a) for the points of a plane, relative error at most 2^-48.
ExactValue exact_plane_value(const PlanePoints& plane, const Vec3& v);

/// (c − x) × (d − x), each component correctly rounded up to 2^-50.
Vec3 exact_cross(const Vec3& x, const Vec3& c, const Vec3& d);

/// The same of an edge's plane whose points drop onto S.
Vec3 exact_cross(const ViewFrame& frame, const ViewPlane& plane);

/// How far a point drops onto S along the axis, S(v) / N, relative error at most 2^-50.
double exact_drop(const ViewFrame& frame, const Vec3& v);

}  // namespace exitance
