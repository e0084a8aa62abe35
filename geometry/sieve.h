#pragma once
// Tells at a glance, in double precision, of most facets near a source that they hide nothing of it.

#include <algorithm>
#include <functional>
#include <vector>

#include "geometry/cone.h"
#include "geometry/view.h"

namespace exitance {

/// Holds a facet back only if it surely hides nothing. Every test asks for more than a bound of its rounding, or for a
/// corner that is the source's own and so lies on a side or plane by identity; whatever else is close to a decision
/// goes through, to be decided exactly, and so do degenerate sources and facets, whose values are 0.
class Sieve {
 public:
  /// The source's cone as it is seen from the receiver, on side `facing` of the source's plane. `vertices`: those that
  /// facets' corners are numbered by.
  void set(const Receiver& receiver, const Plane& plane, int facing, const Cone<double>& source,
           std::span<const Vec3> vertices) {
    x_ = receiver.point;
    const auto number = [&](const ViewPoint& v) {
      const bool is_vertex = v.kind == ViewPoint::Kind::vertex && !v.dropped && !std::less<>()(v.a, vertices.data()) &&
                             std::less<>()(v.a, vertices.data() + vertices.size());
      return is_vertex ? static_cast<std::uint32_t>(v.a - vertices.data()) : kNone;
    };
    corners_.clear();
    for (std::size_t k = 0; k < source.corners.size(); ++k) {
      if (!source.corners.is_kept(k)) continue;
      const Vec<double> w = source.corners.w(k);
      corners_.push_back(
          {{w.x, w.y, w.z}, size_of({w.x, w.y, w.z}), source.corners.error(k), number(source.corners.exact(k))});
    }
    sides_.clear();
    for (const ConeSide<double>& side : source.sides) {
      const bool of_edge = side.exact.kind == ViewPlane::Kind::edge;
      sides_.push_back({{side.m.x, side.m.y, side.m.z},
                        side.error,
                        of_edge ? number(source.corners.exact(side.from)) : kNone,
                        of_edge ? number(source.corners.exact(side.to)) : kNone});
    }
    // The horizon: as for a closing side, with 5 u.
    const Vec3 n = receiver.normal;
    sides_.push_back({n, 5 * kRoundoff * size_of(n), kNone, kNone});
    // The near side of the plane: as in VisibleRegion::sides_of.
    const Vec3 to_x = x_ - plane.origin;
    near_ = facing * plane.normal;
    near_offset_ = dot(near_, to_x);
    near_per_length_ = 12 * kRoundoff * plane.normal_size + 2 * plane.normal_error;
    near_error_ = near_per_length_ * size_of(to_x);
  }

  enum class Glance : std::uint8_t {
    outside,  ///< surely lies outside of a side of the source's cone, or below the horizon
    back,     ///< surely is seen from its back
    other
  };

  Glance glance(const FirstCorners& facet) const {
    if (!facet.all) return Glance::other;
    const Seen seen = see(facet);
    const auto& [x, y, z, size, vertex] = seen;
    for (const Side& side : sides_) {
      const Doubles value = side.m.x * x + side.m.y * y + side.m.z * z;
      if (all((value < -(side.per_length * size)) | seen.is(side.from) | seen.is(side.to))) return Glance::outside;
    }
    // w × w' · w'' of three corners, wrong by at most 8 u |w|₁|w'|₁|w''|₁, as in `judge`; positive where they are seen
    // to run clockwise.
    const double clockwise =
        (y[0] * z[1] - z[0] * y[1]) * x[2] + (z[0] * x[1] - x[0] * z[1]) * y[2] + (x[0] * y[1] - y[0] * x[1]) * z[2];
    return clockwise > 16 * kRoundoff * size[0] * size[1] * size[2] ? Glance::back : Glance::other;
  }

  enum class Verdict : std::uint8_t {
    held_back,  ///< surely hides nothing of the source: it lies behind the source's plane, or the source on the near
                ///< side of its plane or outside of a side of its cone
    between,  ///< surely lies on the near side of the source's plane, and part of the source on the far side of its own
    inside,   ///< surely does so, above the horizon and within the source's cone, of which it reaches no side
    unsure
  };

  /// facing: the side from which it is seen, ±1.
  Verdict judge(const Plane& plane, const FirstCorners& facet, int facing) const {
    if (!facet.all) return Verdict::unsure;
    const Seen seen = see(facet);
    const Doubles &x = seen.x, &y = seen.y, &z = seen.z, &size = seen.size;  // not by name: Clang 14 captures none
    // The facet's own plane and sides, w × w' from each corner to the next. |w_y w'_z| + |w_z w'_y| and its like are at
    // most |w|₁|w'|₁; with two roundings of differences, of a product and of the subtraction, and four of the product
    // with a corner, all in all 8 u |w|₁|w'|₁|v|₁. Twice that is given.
    const Vec3 to_x = x_ - plane.origin, n = facing * plane.normal;
    const double height = dot(n, to_x), per_length = 12 * kRoundoff * plane.normal_size + 2 * plane.normal_error,
                 away = size_of(to_x);
    const Doubles next_x = turned(x), next_y = turned(y), next_z = turned(z), product = size * turned(size);
    const double sign = facing;
    const Doubles m_x = sign * (y * next_z - z * next_y), m_y = sign * (z * next_x - x * next_z),
                  m_z = sign * (x * next_y - y * next_x);
    const Doubles over_plane = near_.x * x + near_.y * y + near_.z * z + near_offset_,
                  over_error = near_per_length_ * size + near_error_;
    bool source_is_nearer = true, source_reaches_beyond = false;
    Mask outside = ~Mask{}, behind = over_plane < -over_error;
    for (const SourceCorner& v : corners_) {
      const Mask own = seen.is(v.vertex);
      behind |= own;
      const double value = n.x * v.w.x + n.y * v.w.y + n.z * v.w.z + height,
                   error = per_length * (v.size + away) + 2 * plane.normal_size * v.error;
      source_is_nearer = source_is_nearer && (any(own) || value > error);
      source_reaches_beyond = source_reaches_beyond || value < -error;
      outside &= (m_x * v.w.x + m_y * v.w.y + m_z * v.w.z > product * (16 * kRoundoff * v.size + 4 * v.error)) | own |
                 turned(own);
    }
    if (source_is_nearer || any(outside) || all(behind)) return Verdict::held_back;
    if (!source_reaches_beyond || !all(over_plane > over_error)) return Verdict::unsure;
    const bool inside = std::ranges::all_of(sides_, [&](const Side& side) {
      return all(side.m.x * x + side.m.y * y + side.m.z * z > side.per_length * size);
    });
    return inside ? Verdict::inside : Verdict::between;
  }

 private:
  using Mask = std::int64_t __attribute__((vector_size(kLanes * sizeof(std::int64_t))));
  using Numbers = std::uint32_t __attribute__((vector_size(kLanes * sizeof(std::uint32_t))));

  /// A facet's corners from the point of view; size: at least |w|.
  struct Seen {
    Doubles x, y, z, size;
    Numbers vertex;
    Mask is(std::uint32_t number) const { return __builtin_convertvector(vertex == number, Mask); }
  };
  Seen see(const FirstCorners& facet) const {
    const Doubles x = load(facet.x.data()) - x_.x, y = load(facet.y.data()) - x_.y, z = load(facet.z.data()) - x_.z;
    Seen seen{x, y, z, magnitude(x) + magnitude(y) + magnitude(z), {}};
    std::memcpy(&seen.vertex, facet.vertex.data(), sizeof seen.vertex);
    return seen;
  }

  static Doubles magnitude(const Doubles& v) { return v < 0 ? -v : v; }
  /// Of the next corner in place of each.
  template <class V>
  static V turned(const V& v) {
    return __builtin_shufflevector(v, v, 1, 2, 3, 0);
  }
  static bool any(const Mask& m) { return (m[0] | m[1] | m[2] | m[3]) != 0; }
  static bool all(const Mask& m) { return (m[0] & m[1] & m[2] & m[3]) != 0; }
  static double size_of(const Vec3& v) { return std::fabs(v.x) + std::fabs(v.y) + std::fabs(v.z); }

  /// m · w ≥ 0 for all that can hide something, with error per_length |w|; and its edge's vertices.
  struct Side {
    Vec3 m;
    double per_length;
    std::uint32_t from, to;
  };
  struct SourceCorner {
    Vec3 w;
    double size, error;
    std::uint32_t vertex;
  };

  Vec3 x_, near_;
  double near_offset_ = 0, near_per_length_ = 0, near_error_ = 0;  // near_ · w + offset > 0 in front
  std::vector<Side> sides_;
  std::vector<SourceCorner> corners_;
};

}  // namespace exitance
