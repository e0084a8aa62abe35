#pragma once
// Boxes around occluders in a gnomonic chart about the source: which pairs of them can meet at all.

#include <algorithm>
#include <limits>
#include <span>
#include <vector>

#include "geometry/cone.h"
#include "geometry/polygon_soup.h"

namespace exitance {

/// A box in the chart; empty until extended.
struct ChartBox {
  double x0 = std::numeric_limits<double>::infinity(), x1 = -x0, y0 = x0, y1 = -x0;
};

/// Directions are projected onto a plane across the middle of the source's cone. Conservative: boxes are widened by
/// more than the rounding of their making, and what reaches out of the chart gets a box without end.
class Chart {
 public:
  template <class Real>
  void centre_on(const Cone<Real>& source) {
    Vec<double> sum;
    const Corners<Real>& c = source.corners;
    for (std::size_t k = 0; k < c.size(); ++k) {
      if (c.is_kept(k) && c.length(k) > 0) sum = sum + static_cast<double>(1 / c.length(k)) * rounded(c.w(k));
    }
    const double length = norm(sum);
    axis_ = length > 0 ? (1 / length) * sum : Vec<double>{0, 0, 1};
    const bool x_is_small = std::fabs(axis_.x) < 0.6;
    const Vec<double> other{x_is_small ? 1.0 : 0.0, x_is_small ? 0.0 : 1.0, 0.0};
    u_ = cross(axis_, other);
    u_ = (1 / norm(u_)) * u_;
    v_ = cross(axis_, u_);
  }

  /// Of unit length, to the middle of the source's cone.
  const Vec<double>& axis() const { return axis_; }

  template <class Real>
  ChartBox box_of(const Cone<Real>& cone) const {
    ChartBox box;
    const Corners<Real>& c = cone.corners;
    for (std::size_t k = 0; k < c.size(); ++k) {
      if (c.is_kept(k)) extend(box, rounded(c.w(k)), static_cast<double>(c.length(k)));
    }
    return box;
  }

  /// Of points as they are seen from x.
  ChartBox box_of(const Vec3& x, std::span<const Corner> corners) const {
    ChartBox box;
    for (const Corner& c : corners) {
      const Vec<double> w{c.at.x - x.x, c.at.y - x.y, c.at.z - x.z};
      extend(box, w, norm(w));
    }
    return box;
  }

  /// Extends a box by a stretch of a cone's edge, its ends as far out as their errors allow.
  template <class Real>
  void extend(ChartBox& box, const Cone<Real>& cone, const ConeSide<Real>& edge, const Stretch<Real>& stretch) const {
    const Vec<double> a = rounded(cone.corners.w(edge.from)), e = rounded(cone.corners.w(edge.to)) - a;
    const double reach = static_cast<double>(cone.corners.length(edge.from) + cone.corners.length(edge.to));
    for (const Real& t : {Real(stretch.lo - stretch.lo_error), Real(stretch.hi + stretch.hi_error)}) {
      extend(box, a + std::clamp(static_cast<double>(t), 0.0, 1.0) * e, reach);
    }
  }

  /// Keeps the box of item i.
  void set(std::size_t i, const ChartBox& box) {
    if (x0_.size() <= i) {
      for (auto* v : {&x0_, &x1_, &y0_, &y1_}) v->resize(2 * i + 8);
    }
    x0_[i] = box.x0;
    x1_[i] = box.x1;
    y0_[i] = box.y0;
    y1_[i] = box.y1;
  }

  /// Calls f(j), ascending, for items j ≠ i of the first n whose box meets the box, until one says true.
  template <class F>
  void until_overlap(const ChartBox& box, std::size_t i, std::size_t n, const F& f) const {
    const double a0 = box.x0, a1 = box.x1, b0 = box.y0, b1 = box.y1;
    constexpr std::size_t kStep = 8;
    for (std::size_t first = 0; first < n; first += kStep) {
      const std::size_t last = std::min(n, first + kStep);
      std::uint8_t meets[kStep] = {};
      for (std::size_t j = first; j < last; ++j) {
        meets[j - first] = (x0_[j] <= a1) & (a0 <= x1_[j]) & (y0_[j] <= b1) & (b0 <= y1_[j]);
      }
      for (std::size_t j = first; j < last; ++j) {
        if (meets[j - first] != 0 && j != i && f(j)) return;
      }
    }
  }

 private:
  /// `size`: at least |w|, and as large as the numbers that w was computed from.
  void extend(ChartBox& box, const Vec<double>& w, double size) const {
    const double depth = dot(axis_, w);
    if (!(depth > 1e-3 * size)) {
      constexpr double kInfinity = std::numeric_limits<double>::infinity();
      box = {-kInfinity, kInfinity, -kInfinity, kInfinity};
      return;
    }
    // With a depth of at least 1e-3 of the size a coordinate is wrong by less than 1e3 · 1e3 · 16 u.
    const double scale = 1 / depth, x = dot(u_, w) * scale, y = dot(v_, w) * scale;
    box.x0 = std::min(box.x0, x - 1e-8);
    box.x1 = std::max(box.x1, x + 1e-8);
    box.y0 = std::min(box.y0, y - 1e-8);
    box.y1 = std::max(box.y1, y + 1e-8);
  }

  template <class Real>
  static Vec<double> rounded(const Vec<Real>& a) {
    return {static_cast<double>(a.x), static_cast<double>(a.y), static_cast<double>(a.z)};
  }

  Vec<double> axis_, u_, v_;
  std::vector<double> x0_, x1_, y0_, y1_;
};

}  // namespace exitance
