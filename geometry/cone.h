#pragma once
// The cone of directions in which a convex polygon is seen from a point: its sides are planes through the point. All
// values are held in a number type Real (double, or extended precision) with proven error bounds; signs are always
// exact.

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <type_traits>
#include <vector>

#include "geometry/lanes.h"
#include "geometry/predicates.h"

namespace exitance {

template <class Real>
struct Vec {
  Real x{}, y{}, z{};
};
template <class Real>
Vec<Real> operator-(const Vec<Real>& a, const Vec<Real>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class Real>
Vec<Real> operator+(const Vec<Real>& a, const Vec<Real>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class Real>
Vec<Real> operator*(const Real& s, const Vec<Real>& a) {
  return {s * a.x, s * a.y, s * a.z};
}
template <class Real>
Real dot(const Vec<Real>& a, const Vec<Real>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class Real>
Vec<Real> cross(const Vec<Real>& a, const Vec<Real>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class Real>
Real norm(const Vec<Real>& a) {
  using std::sqrt;
  return sqrt(dot(a, a));
}
template <class Real>
Vec<Real> difference(const Vec3& a, const Vec3& b) {
  return {Real(a.x) - Real(b.x), Real(a.y) - Real(b.y), Real(a.z) - Real(b.z)};
}

/// A value, a bound of its error, and the exact sign of the true value. A true zero is held as 0 ± 0.
template <class Real>
struct Signed {
  Real value{}, error{};
  int sign = 0;
};

/// A stretch of an edge, by its parameter from 0 (first corner) to 1, each end with a bound of its error.
template <class Real>
struct Stretch {
  Real lo{0}, hi{1}, lo_error{0}, hi_error{0};
  bool empty = false;   ///< by an exact decision
  bool narrow = false;  ///< whether it may have been narrowed, by however little
};

/// Corners as seen from the point of view.
template <class Real>
class Corners {
 public:
  struct alignas(64) Block {
    std::array<Real, kLanes> x, y, z;  ///< w, from the point of view
    std::array<Real, kLanes> length;   ///< |w|
    std::array<Real, kLanes> error;    ///< bound of |error of w| beyond the rounding of the difference of input points
    /// 1 for a corner of the cone, 0 where a clip cut it off and only an edge's line still needs it.
    SignBytes kept = 0;
    SignBytes horizon = 0;  ///< signs against the receiver's horizon, where they were asked for
  };

  std::size_t size() const { return exact_.size(); }
  std::size_t block_count() const { return blocks_.size(); }
  Block& block(std::size_t b) { return blocks_[b]; }
  const Block& block(std::size_t b) const { return blocks_[b]; }
  /// Of a block: 1 for every corner that there is.
  SignBytes present(std::size_t b) const {
    const std::size_t n = size() - b * kLanes;
    return n >= kLanes ? kOnes : kOnes & ((SignBytes{1} << (8 * n)) - 1);
  }

  Vec<Real> w(std::size_t k) const {
    const Block& b = blocks_[k / kLanes];
    return {b.x[k % kLanes], b.y[k % kLanes], b.z[k % kLanes]};
  }
  const Real& length(std::size_t k) const { return blocks_[k / kLanes].length[k % kLanes]; }
  const Real& error(std::size_t k) const { return blocks_[k / kLanes].error[k % kLanes]; }
  bool is_kept(std::size_t k) const { return sign_byte(blocks_[k / kLanes].kept, k % kLanes) != 0; }
  void set_kept(std::size_t k, bool keep) { set_sign_byte(blocks_[k / kLanes].kept, k % kLanes, keep ? 1 : 0); }
  ViewPoint& exact(std::size_t k) { return exact_[k]; }
  const ViewPoint& exact(std::size_t k) const { return exact_[k]; }

  /// n corners, all kept, their numbers still to be set.
  void resize(std::size_t n) {
    exact_.resize(n);
    blocks_.resize((n + kLanes - 1) / kLanes);
    for (std::size_t b = 0; b < blocks_.size(); ++b) blocks_[b].kept = present(b);
  }
  void add(const Vec<Real>& w, const Real& w_error, const ViewPoint& point) {
    const std::size_t k = size(), lane = k % kLanes;
    if (lane == 0) blocks_.emplace_back();
    exact_.push_back(point);
    set_kept(k, true);
    Block& b = blocks_.back();
    b.x[lane] = w.x;
    b.y[lane] = w.y;
    b.z[lane] = w.z;
    b.length[lane] = norm(w);
    b.error[lane] = w_error;
  }

 private:
  std::vector<Block> blocks_;
  std::vector<ViewPoint> exact_;
};

template <class Real>
struct ConeSide {
  Vec<Real> m;    ///< inward normal, not of unit length
  Real length{};  ///< |m|
  Real error{};   ///< |m − true m| ≤ error and |m · w − true| ≤ error |w| for a corner without error
  ViewPlane exact;
  Real sweep{1};                       ///< bound of |dθ/dt| along the edge, θ the angle under which x sees it
  std::uint32_t from = 0, to = 0;      ///< corners
  Stretch<Real> stretch;               ///< of the edge between them that bounds the cone
  std::uint32_t across = 0xffffffffu;  ///< facet that shares the edge; none: kNone
};

template <class Real>
struct Cone {
  Corners<Real> corners;
  std::vector<ConeSide<Real>> sides;
  int turn = 1;  ///< sign of det(from, to, v) of a side's corners, as seen from x, for v inside of it
};

/// Unit roundoff of the number type: 2^-53 for double.
template <class Real>
Real roundoff() {
  return std::numeric_limits<Real>::epsilon() / 2;
}

/// What belongs to an edge and the point of view: |w| of its first corner, and the plane through both (ConeSide). N: a
/// number, or Doubles for several edges at once.
template <class N>
struct EdgePlane {
  N from_length, length, error, sweep;
  Vec<N> m;
};

template <class Real>
Real square_root(const Real& v) {
  using std::sqrt;
  return sqrt(v);
}

/// Of an edge e from corner `from` to corner `to`, both as seen from x. m = w × e, times `sign`, with w the nearer
/// corner.
///
/// w has relative error u in each component, so has the edge e when taken from the input; the cross product w × e adds
/// two roundings: each component is wrong by at most 4.01 u |w||e| (Cauchy–Schwarz on its two products), the vector by
/// √3 times that, 7 u |w||e|. Its product with w_v adds at most (1 + 3.01) u |w||e||w_v|: 11 u in all; 12 covers the
/// rounding of the bound.
///
/// dθ/dt = |m| / |w(t)|², and the nearest that the edge comes is |m| / |e| when its foot lies between its corners.
template <class Real, class N>
[[gnu::always_inline]] inline EdgePlane<N> edge_plane(const Vec<N>& from, const Vec<N>& to, const Vec<N>& e, int sign) {
  EdgePlane<N> plane;
  plane.from_length = square_root(dot(from, from));
  const N to_length = square_root(dot(to, to));
  const auto from_nearer = plane.from_length < to_length;
  const Vec<N> w{from_nearer ? from.x : to.x, from_nearer ? from.y : to.y, from_nearer ? from.z : to.z};
  const N near = from_nearer ? plane.from_length : to_length;
  const Vec<N> m = cross(w, e);
  const Real s = Real(sign);
  plane.m = {s * m.x, s * m.y, s * m.z};
  const N square = dot(m, m), e_square = dot(e, e);
  plane.length = square_root(square);
  plane.error = Real(12 * roundoff<Real>()) * near * square_root(e_square);
  const auto foot_between = (dot(from, e) < Real(0)) & (dot(to, e) > Real(0));
  const N foot_square = square / e_square, near_square = near * near;
  plane.sweep = plane.length / (foot_between ? foot_square : near_square);
  return plane;
}

/// Of corners that stand for where they drop onto the source's plane (ViewFrame).
struct Drop {
  const ViewFrame& frame;
  std::span<const double> height;  ///< of each corner, a bound of how far it drops
};

/// How far a corner drops along the frame's axis, S(v) / N, and a bound of the error.
template <class Real>
struct DropOf {
  Real by{0}, error{0};
};

/// 0 where no corner drops. In long double the drop is the rounded exact one, since arithmetic of 64 bits knows that of
/// a sliver, whose |N| is small against |p||q|, far worse than to a rounding. In Extended: n is wrong by at most 8 u
/// |p||q| in all and so is N, n · d by that times |d| and by 7 u of |n||d|, where |n| ≤ |p||q|.
template <class Real>
DropOf<Real> drop_of(const Drop* drop, const Vec3& v) {
  using std::fabs;
  if (drop == nullptr) return {};
  if constexpr (std::is_same_v<Real, long double>) {
    const Real by = exact_drop(drop->frame, v);
    return {by, Real(0x1p-50) * fabs(by)};
  } else {
    const PlanePoints& S = drop->frame.S;
    const Vec<Real> p = difference<Real>(*S.b, *S.a), q = difference<Real>(*S.c, *S.a), n = cross(p, q),
                    d = difference<Real>(v, *S.a);
    const Real N = drop->frame.axis == 0 ? n.x : drop->frame.axis == 1 ? n.y : n.z;
    const Real by = dot(n, d) / N;
    const Real relative = Real(16 * roundoff<Real>()) * norm(p) * norm(q) / fabs(N);
    return {by, Real(Real(1.1) * relative * (norm(d) + fabs(by)))};
  }
}

/// Sets the cone of a polygon of input points, or of what these stand for, a side from each corner to the next; it runs
/// so that sign · det(c − x, d − x, v − x) is positive inside. Of several loops `next` tells which corner is next to
/// each.
///
/// In double precision corners that drop are left where they are, and what they drop is taken as their error δ. The
/// sides then err by |(w + δ) × (w' + δ') − w × w'| ≤ |δ||w'| + |δ'||w| + |δ||δ'|. In other number types they are
/// dropped: that rounds w and e once more, for which the sides' error is doubled; δ is the error of the drop itself,
/// and 3 u of it where w is small against it.
template <class Real>
void set_cone(Cone<Real>& cone, const Vec3& x, std::span<const Vec3* const> loop, int sign, const Drop* drop = nullptr,
              std::span<const std::uint32_t> next = {}) {
  const std::size_t n = loop.size();
  const auto next_to = [&](std::size_t k) { return !next.empty() ? next[k] : k + 1 < n ? k + 1 : 0; };
  using std::fabs;
  cone.turn = sign;
  Corners<Real>& corners = cone.corners;
  corners.resize(n);
  cone.sides.resize(n);
  std::array<Real, kLanes> from_x{}, from_y{}, from_z{}, to_x{}, to_y{}, to_z{}, e_x{}, e_y{}, e_z{}, m_x, m_y, m_z,
      length, error, sweep, from_drop{}, to_drop{};
  for (std::size_t first = 0; first < n; first += kLanes) {
    const std::size_t used = std::min(kLanes, n - first);
    for (std::size_t k = 0; k < used; ++k) {
      const Vec3 &p = *loop[first + k], &q = *loop[next_to(first + k)];
      from_x[k] = Real(p.x) - Real(x.x);
      from_y[k] = Real(p.y) - Real(x.y);
      from_z[k] = Real(p.z) - Real(x.z);
      to_x[k] = Real(q.x) - Real(x.x);
      to_y[k] = Real(q.y) - Real(x.y);
      to_z[k] = Real(q.z) - Real(x.z);
      e_x[k] = Real(q.x) - Real(p.x);
      e_y[k] = Real(q.y) - Real(p.y);
      e_z[k] = Real(q.z) - Real(p.z);
      corners.exact(first + k) = {ViewPoint::Kind::vertex, drop != nullptr, 0, &p, nullptr};
    }
    if constexpr (!std::is_same_v<Real, double>) {
      for (std::size_t k = 0; k < used && drop != nullptr; ++k) {
        auto& from = drop->frame.axis == 0 ? from_x : drop->frame.axis == 1 ? from_y : from_z;
        auto& to = drop->frame.axis == 0 ? to_x : drop->frame.axis == 1 ? to_y : to_z;
        auto& e = drop->frame.axis == 0 ? e_x : drop->frame.axis == 1 ? e_y : e_z;
        const DropOf<Real> at_from = drop_of<Real>(drop, *loop[first + k]),
                           at_to = drop_of<Real>(drop, *loop[next_to(first + k)]);
        from[k] -= at_from.by;
        to[k] -= at_to.by;
        e[k] -= at_to.by - at_from.by;
        const Real roundings = Real(3 * roundoff<Real>());
        from_drop[k] = at_from.error + roundings * fabs(at_from.by);
        to_drop[k] = at_to.error + roundings * fabs(at_to.by);
      }
    } else {
      for (std::size_t k = 0; k < used && drop != nullptr; ++k) {
        from_drop[k] = drop->height[first + k];
        to_drop[k] = drop->height[next_to(first + k)];
      }
    }
    auto& c = corners.block(first / kLanes);
    c.x = from_x;
    c.y = from_y;
    c.z = from_z;
    c.error = from_drop;
    if constexpr (std::is_same_v<Real, double>) {
      const auto vectors = [](const auto& vx, const auto& vy, const auto& vz) {
        return Vec<Doubles>{load(vx.data()), load(vy.data()), load(vz.data())};
      };
      const auto plane =
          edge_plane<double>(vectors(from_x, from_y, from_z), vectors(to_x, to_y, to_z), vectors(e_x, e_y, e_z), sign);
      store(plane.from_length, c.length.data());
      store(plane.m.x, m_x.data());
      store(plane.m.y, m_y.data());
      store(plane.m.z, m_z.data());
      store(plane.length, length.data());
      store(plane.error, error.data());
      store(plane.sweep, sweep.data());
    } else {
      for (std::size_t k = 0; k < used; ++k) {
        const auto plane =
            edge_plane<Real>(Vec<Real>{from_x[k], from_y[k], from_z[k]}, Vec<Real>{to_x[k], to_y[k], to_z[k]},
                             Vec<Real>{e_x[k], e_y[k], e_z[k]}, sign);
        c.length[k] = plane.from_length;
        m_x[k] = plane.m.x;
        m_y[k] = plane.m.y;
        m_z[k] = plane.m.z;
        length[k] = plane.length;
        error[k] = plane.error;
        sweep[k] = plane.sweep;
      }
    }
    for (std::size_t k = 0; k < used; ++k) {
      ConeSide<Real>& side = cone.sides[first + k];
      side.m = {m_x[k], m_y[k], m_z[k]};
      side.length = length[k];
      side.error = error[k];
      side.sweep = sweep[k];
      side.from = static_cast<std::uint32_t>(first + k);
      side.to = static_cast<std::uint32_t>(next_to(first + k));
      side.exact = {ViewPlane::Kind::edge, sign, loop[side.from], loop[side.to], nullptr, drop != nullptr};
      side.stretch = {};
      side.across = 0xffffffffu;
      if (drop != nullptr) {
        if constexpr (!std::is_same_v<Real, double>) side.error *= 2;
        const Real a = from_drop[k], b = to_drop[k], to_length = norm(Vec<Real>{to_x[k], to_y[k], to_z[k]});
        side.error += Real(1.01) * (a * to_length + b * c.length[k] + a * b);
      }
      if constexpr (std::is_floating_point_v<Real>) {
        if (side.error > 512 * kRoundoff * side.length) {  // the edge's line passes near x
          const Vec3 m =
              sign * (drop ? exact_cross(drop->frame, side.exact) : exact_cross(x, *side.exact.c, *side.exact.d));
          side.m = {m.x, m.y, m.z};
          side.length = norm(side.m);
          side.error = 8 * kRoundoff * side.length;  // 2^-50 of each component, and u in each of w
        }
      }
    }
  }
}

/// The side's functional at a corner, known better: its sign exactly, its value to that relative accuracy.
template <class Real>
Signed<Real> refined_value_at(const ConeSide<Real>& side, const ViewPoint& corner, const ViewFrame& frame,
                              StageCounts& counts, double accuracy = 0x1p-44) {
  const ExactValue v = exact_value_at(frame, side.exact, corner, counts, accuracy);
  // A value that underflows still has its sign.
  if (v.sign != 0 && v.value == 0) return {v.sign * std::numeric_limits<Real>::min(), Real(1), v.sign};
  return {Real(v.value), Real(v.error), v.sign};
}

/// Whether a corner is an end of the edge that the side is through.
template <class Real>
bool is_end_of(const ViewPoint& corner, const ConeSide<Real>& side) {
  return side.exact.kind == ViewPlane::Kind::edge && corner.kind == ViewPoint::Kind::vertex &&
         side.exact.dropped == corner.dropped && (*side.exact.c == *corner.a || *side.exact.d == *corner.a);
}

/// The side's functional at one corner, its sign exact.
template <class Real>
Signed<Real> value_at(const ConeSide<Real>& side, const Corners<Real>& corners, std::size_t k, const ViewFrame& frame,
                      StageCounts& counts) {
  const Real value = dot(side.m, corners.w(k)),
             error = side.error * corners.length(k) + (side.length + side.error) * corners.error(k);
  if (value > error || value < -error) {
    ++counts.filter;
    return {value, error, value > 0 ? 1 : -1};
  }
  if (is_end_of(corners.exact(k), side)) return {};
  // In double precision a crossing is refined where that matters.
  return refined_value_at(side, corners.exact(k), frame, counts, std::is_same_v<Real, double> ? 0.5 : 0x1p-50);
}

/// Values of a side's functional at the corners of a cone, with bounds of their errors and exact signs.
template <class Real>
class Row {
 public:
  void fill(const ConeSide<Real>& side, const Corners<Real>& corners, const ViewFrame& frame, StageCounts& counts) {
    const std::size_t n = corners.block_count();
    if (blocks_.size() < n) blocks_.resize(n);
    SignBytes kept_positive = 0, kept_negative = 0, not_positive = 0;
    for (std::size_t b = 0; b < n; ++b) {
      const SignBytes present = corners.present(b), kept = corners.block(b).kept;
      Block& row = blocks_[b];
      filter(side, corners, b, row);
      const SignBytes unsure = zero_bytes(row.signs) & present;
      if (unsure != 0) decide(unsure, side, corners, b, row, frame, counts);
      counts.filter += static_cast<std::uint64_t>(std::popcount(present & ~unsure));
      const SignBytes positive = positive_bytes(row.signs), negative = negative_bytes(row.signs);
      kept_positive |= positive & kept;
      kept_negative |= negative & kept;
      not_positive |= present & ~positive;
    }
    any_positive_ = kept_positive != 0;
    any_negative_ = kept_negative != 0;
    all_positive_ = not_positive == 0;
  }

  int sign(std::size_t k) const { return sign_byte(blocks_[k / kLanes].signs, k % kLanes); }
  Signed<Real> at(std::size_t k) const {
    const Block& b = blocks_[k / kLanes];
    return {b.value[k % kLanes], b.error[k % kLanes], sign_byte(b.signs, k % kLanes)};
  }

  /// Whether some corner of the cone, those that were cut off left aside, has the sign.
  bool any_positive() const { return any_positive_; }
  bool any_negative() const { return any_negative_; }
  /// Whether all corners do, cut off or not.
  bool all_positive() const { return all_positive_; }

 private:
  struct alignas(64) Block {
    std::array<Real, kLanes> value, error;
    SignBytes signs = 0;
  };

  /// Values, errors and those signs that are certain.
  static void filter(const ConeSide<Real>& side, const Corners<Real>& corners, std::size_t b, Block& row) {
    const auto& c = corners.block(b);
    if constexpr (std::is_same_v<Real, double>) {
      const Doubles value = side.m.x * load(c.x.data()) + side.m.y * load(c.y.data()) + side.m.z * load(c.z.data());
      const Doubles error = side.error * load(c.length.data()) + (side.length + side.error) * load(c.error.data());
      store(value, row.value.data());
      store(error, row.error.data());
      row.signs = certain_signs(value, error);
    } else {
      row.signs = 0;
      for (std::size_t k = 0; k < std::min(kLanes, corners.size() - b * kLanes); ++k) {
        row.value[k] = side.m.x * c.x[k] + side.m.y * c.y[k] + side.m.z * c.z[k];
        row.error[k] = side.error * c.length[k] + (side.length + side.error) * c.error[k];
        set_sign_byte(row.signs, k, row.value[k] > row.error[k] ? 1 : row.value[k] < -row.error[k] ? -1 : 0);
      }
    }
  }

  static void decide(SignBytes unsure, const ConeSide<Real>& side, const Corners<Real>& corners, std::size_t b,
                     Block& row, const ViewFrame& frame, StageCounts& counts) {
    for_each_byte(unsure, [&](std::size_t k) {
      const ViewPoint& corner = corners.exact(b * kLanes + k);
      constexpr double accuracy = std::is_same_v<Real, double> ? 0.5 : 0x1p-50;
      const auto s = is_end_of(corner, side) ? Signed<Real>{} : refined_value_at(side, corner, frame, counts, accuracy);
      row.value[k] = s.value;
      row.error[k] = s.error;
      set_sign_byte(row.signs, k, s.sign);
    });
  }

  std::vector<Block> blocks_;
  bool any_positive_ = false, any_negative_ = false, all_positive_ = false;
};

/// Sides of a cone side by side; of places without a side all is 0.
template <class Real>
class SideBlocks {
 public:
  struct alignas(64) Block {
    std::array<Real, kLanes> x{}, y{}, z{}, length{}, error{};
  };

  void set(std::span<const ConeSide<Real>> sides) {
    sides_ = sides;
    blocks_.resize((sides.size() + kLanes - 1) / kLanes);
    if (!blocks_.empty()) blocks_.back() = {};
    for (std::size_t k = 0; k < sides.size(); ++k) {
      Block& b = blocks_[k / kLanes];
      const std::size_t lane = k % kLanes;
      b.x[lane] = sides[k].m.x;
      b.y[lane] = sides[k].m.y;
      b.z[lane] = sides[k].m.z;
      b.length[lane] = sides[k].length;
      b.error[lane] = sides[k].error;
    }
  }

  std::span<const Block> blocks() const { return blocks_; }
  std::span<const ConeSide<Real>> sides() const { return sides_; }

 private:
  std::vector<Block> blocks_;
  std::span<const ConeSide<Real>> sides_;
};

/// Values of the functionals of a cone's sides at the ends of an edge, with exact signs: what rows hold, but of one
/// edge only.
template <class Real>
class Columns {
 public:
  /// False when all of the edge surely lies outside of one side; else calls f(side, value at from, value at to) for
  /// those sides that neither end lies inside of, or only one, until it says false, and gives what it said last.
  template <class F>
  bool each(const SideBlocks<Real>& sides, const Corners<Real>& corners, const ConeSide<Real>& edge,
            const ViewFrame& frame, StageCounts& counts, const F& f) {
    const auto blocks = sides.blocks();
    if (ends_.size() < blocks.size()) ends_.resize(blocks.size());
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      filter(blocks[b], corners, edge.from, ends_[b].from);
      filter(blocks[b], corners, edge.to, ends_[b].to);
      if ((negative_bytes(ends_[b].from.signs) & negative_bytes(ends_[b].to.signs)) != 0) return false;
    }
    for (std::size_t k = 0; k < sides.sides().size(); ++k) {
      const ConeSide<Real>& side = sides.sides()[k];
      const Ends& ends = ends_[k / kLanes];
      const Signed<Real> from = at(ends.from, k % kLanes, side, corners.exact(edge.from), frame, counts),
                         to = at(ends.to, k % kLanes, side, corners.exact(edge.to), frame, counts);
      if (from.sign + to.sign <= 0 && !f(side, from, to)) return false;
    }
    return true;
  }

 private:
  /// Of one corner, for a block of sides.
  struct Column {
    std::array<Real, kLanes> value, error;
    SignBytes signs = 0;
  };
  struct alignas(64) Ends {
    Column from, to;
  };

  /// As Row's.
  static void filter(const typename SideBlocks<Real>::Block& sides, const Corners<Real>& corners, std::size_t corner,
                     Column& column) {
    const Vec<Real> w = corners.w(corner);
    const Real& length = corners.length(corner);
    const Real& w_error = corners.error(corner);
    if constexpr (std::is_same_v<Real, double>) {
      const Doubles value = load(sides.x.data()) * w.x + load(sides.y.data()) * w.y + load(sides.z.data()) * w.z;
      const Doubles side_error = load(sides.error.data());
      const Doubles error = side_error * length + (load(sides.length.data()) + side_error) * w_error;
      store(value, column.value.data());
      store(error, column.error.data());
      column.signs = certain_signs(value, error);
    } else {
      column.signs = 0;
      for (std::size_t k = 0; k < kLanes; ++k) {
        column.value[k] = sides.x[k] * w.x + sides.y[k] * w.y + sides.z[k] * w.z;
        column.error[k] = sides.error[k] * length + (sides.length[k] + sides.error[k]) * w_error;
        set_sign_byte(column.signs, k,
                      column.value[k] > column.error[k]    ? 1
                      : column.value[k] < -column.error[k] ? -1
                                                           : 0);
      }
    }
  }

  static Signed<Real> at(const Column& column, std::size_t lane, const ConeSide<Real>& side, const ViewPoint& corner,
                         const ViewFrame& frame, StageCounts& counts) {
    const int sign = sign_byte(column.signs, lane);
    if (sign != 0) {
      ++counts.filter;
      return {column.value[lane], column.error[lane], sign};
    }
    constexpr double accuracy = std::is_same_v<Real, double> ? 0.5 : 0x1p-50;
    return is_end_of(corner, side) ? Signed<Real>{} : refined_value_at(side, corner, frame, counts, accuracy);
  }

  std::vector<Ends> ends_;
};

/// Narrows the stretch to where the linear function from a (at 0) to b (at 1) is positive. Both zero is the caller's
/// case. refine(a, b, accuracy): called when the error of the crossing times `weight` exceeds 1, with ever better
/// accuracies, to make a and b known to that or better.
template <class Real, class Refine>
void narrow(Stretch<Real>& stretch, Signed<Real> a, Signed<Real> b, const Real& weight, const Refine& refine) {
  using std::fabs;
  if (a.sign <= 0 && b.sign <= 0) {
    stretch.empty = true;
  } else if (a.sign * b.sign < 0) {
    // t = |a| / (|a| + |b|): |δt| ≤ (|b| δa + |a| δb) / (|a| + |b|)² to first order; where the errors are not small
    // against the sum, all is open.
    Real t, error;
    const auto find_crossing = [&] {
      const Real size_a = fabs(a.value), size_b = fabs(b.value), span = size_a + size_b;
      const Real part = 1 / span;
      t = size_a * part;
      error = 100 * (a.error + b.error) < span ? Real(Real(1.05) * (size_b * part * a.error + t * b.error) * part)
                                               : Real(1);
    };
    find_crossing();
    for (const double accuracy : {0.5, 0x1p-44}) {
      if (!(error * weight > 1)) break;
      refine(a, b, accuracy);
      find_crossing();
    }
    error += 5 * roundoff<Real>();
    if (a.sign > 0) {
      if (t - error < stretch.hi + stretch.hi_error) {
        stretch.narrow = true;
        if (error > stretch.hi_error) stretch.hi_error = error;
      }
      if (t < stretch.hi) stretch.hi = t;
    } else {
      if (t + error > stretch.lo - stretch.lo_error) {
        stretch.narrow = true;
        if (error > stretch.lo_error) stretch.lo_error = error;
      }
      if (t > stretch.lo) stretch.lo = t;
    }
  }
}

/// Cuts the cone of a convex polygon (side i runs from corner i to corner i + 1) down to where `weight`, a functional
/// known at its corners, is positive; `closing` is the side that the cut makes, without its corners. New corners stay
/// implicit. A polygon that only touches the plane is not changed; one without a positive corner must not be given.
template <class Real>
void clip(Cone<Real>& cone, const std::vector<Signed<Real>>& weight, ViewPoint::Kind kind,
          const ConeSide<Real>& closing) {
  const auto n = static_cast<std::uint32_t>(cone.sides.size());
  std::uint32_t start = 0;
  while (weight[start].sign <= 0) ++start;
  bool inside = true;
  std::uint32_t exit = 0;
  std::vector<ConeSide<Real>> sides;
  Corners<Real>& corners = cone.corners;

  const auto crossing = [&](const ConeSide<Real>& side, const Stretch<Real>& s, const Real& t) {
    const Vec<Real> a = corners.w(side.from), e = corners.w(side.to) - a;
    const Real dt = s.lo_error > s.hi_error ? s.lo_error : s.hi_error;
    const Real error = norm(e) * dt + 8 * roundoff<Real>() * (corners.length(side.from) + corners.length(side.to)) +
                       corners.error(side.from) + corners.error(side.to);
    const ViewPoint p = corners.exact(side.from), q = corners.exact(side.to);
    corners.add(a + t * e, error, {kind, p.dropped, weight[side.from].sign, p.a, q.a});
    return static_cast<std::uint32_t>(corners.size() - 1);
  };
  const auto close = [&](std::uint32_t from, std::uint32_t to) {
    sides.push_back(closing);
    sides.back().from = from;
    sides.back().to = to;
  };

  for (std::uint32_t k = 0; k < n; ++k) {
    ConeSide<Real> side = cone.sides[(start + k) % n];
    const Signed<Real>&a = weight[side.from], &b = weight[side.to];
    if (a.sign * b.sign < 0) {
      narrow(side.stretch, a, b, Real(1), [](auto&, auto&, double) {});
      const std::uint32_t point = crossing(side, side.stretch, inside ? side.stretch.hi : side.stretch.lo);
      if (!inside) close(exit, point);
      exit = point;
      inside = !inside;
      sides.push_back(side);
    } else if (inside && b.sign < 0) {  // leaves through its corner a
      exit = side.from;
      inside = false;
    } else if (!inside && b.sign > 0) {  // comes back through its corner a
      close(exit, side.from);
      inside = true;
      sides.push_back(side);
    } else if (inside) {
      sides.push_back(side);
    }
  }
  for (std::uint32_t i = 0; i < n; ++i) corners.set_kept(i, weight[i].sign >= 0);
  cone.sides = std::move(sides);
}

}  // namespace exitance
