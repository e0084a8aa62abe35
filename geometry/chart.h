#pragma once
// Boxes around occluders in a gnomonic chart about the source: which pairs of them can meet at all.

#include <algorithm>
#include <limits>
#include <vector>

#include "geometry/cone.h"

namespace exitance {

struct ChartBox {
  double x0 = -std::numeric_limits<double>::infinity(), x1 = -x0, y0 = x0, y1 = -x0;
};

/// Directions are projected onto a plane across the middle of the source's cone. Conservative: boxes are widened by
/// more than the rounding of their making, and what reaches out of the chart gets a box without end.
class Chart {
 public:
  template <class Real>
  void centre_on(const Cone<Real>& source) {
    Vec<double> sum;
    for (const auto& c : source.corners) {
      if (c.kept && c.length > 0) sum = sum + static_cast<double>(1 / c.length) * rounded(c.w);
    }
    const double length = norm(sum);
    axis_ = length > 0 ? (1 / length) * sum : Vec<double>{0, 0, 1};
    const bool x_is_small = std::fabs(axis_.x) < 0.6;
    const Vec<double> other{x_is_small ? 1.0 : 0.0, x_is_small ? 0.0 : 1.0, 0.0};
    u_ = cross(axis_, other);
    u_ = (1 / norm(u_)) * u_;
    v_ = cross(axis_, u_);
    source_ = box_of(source);
  }

  bool meets_source(const ChartBox& box) const {
    return source_.x0 <= box.x1 && box.x0 <= source_.x1 && source_.y0 <= box.y1 && box.y0 <= source_.y1;
  }

  template <class Real>
  ChartBox box_of(const Cone<Real>& cone) const {
    ChartBox box{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
                 std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    for (const auto& c : cone.corners) {
      if (!c.kept) continue;
      const Vec<double> w = rounded(c.w);
      const double depth = dot(axis_, w);
      if (!(depth > 1e-3 * static_cast<double>(c.length))) return {};
      const double x = dot(u_, w) / depth, y = dot(v_, w) / depth;
      // With a depth of at least 1e-3 |w| a coordinate is wrong by less than 1e3 · 1e3 · 8 u.
      box.x0 = std::min(box.x0, x - 1e-9);
      box.x1 = std::max(box.x1, x + 1e-9);
      box.y0 = std::min(box.y0, y - 1e-9);
      box.y1 = std::max(box.y1, y + 1e-9);
    }
    return box;
  }

  /// Keeps the box of item i; items are set in order.
  void set(std::size_t i, const ChartBox& box) {
    for (auto* v : {&x0_, &x1_, &y0_, &y1_}) v->resize(i);
    x0_.push_back(box.x0);
    x1_.push_back(box.x1);
    y0_.push_back(box.y0);
    y1_.push_back(box.y1);
  }

  /// Calls f(j), ascending, for every item j ≠ i of the first n whose box meets item i's.
  template <class F>
  void for_each_overlap(std::size_t i, std::size_t n, const F& f) const {
    constexpr std::size_t kBlock = 16;
    const double a0 = x0_[i], a1 = x1_[i], b0 = y0_[i], b1 = y1_[i];
    for (std::size_t first = 0; first < n; first += kBlock) {
      const std::size_t last = std::min(n, first + kBlock);
      std::uint8_t meets[kBlock] = {};
      for (std::size_t j = first; j < last; ++j) {
        meets[j - first] = (x0_[j] <= a1) & (a0 <= x1_[j]) & (y0_[j] <= b1) & (b0 <= y1_[j]);
      }
      for (std::size_t j = first; j < last; ++j) {
        if (meets[j - first] != 0 && j != i) f(j);
      }
    }
  }

 private:
  template <class Real>
  static Vec<double> rounded(const Vec<Real>& a) {
    return {static_cast<double>(a.x), static_cast<double>(a.y), static_cast<double>(a.z)};
  }

  Vec<double> axis_, u_, v_;
  ChartBox source_;
  std::vector<double> x0_, x1_, y0_, y1_;
};

}  // namespace exitance
