#include "geometry/open_region.h"

#include <CGAL/Mpzf.h>

#include <algorithm>
#include <limits>

namespace exitance {
namespace {

using Exact = CGAL::Mpzf;

struct ExactVector {
  Exact x, y, z;
  ExactVector(const Vec3& p, const Vec3& q)
      : x(Exact(p.x) - Exact(q.x)), y(Exact(p.y) - Exact(q.y)), z(Exact(p.z) - Exact(q.z)) {}
  ExactVector(const Exact& a, const Exact& b, const Exact& c) : x(a), y(b), z(c) {}
};

ExactVector cross(const ExactVector& a, const ExactVector& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

Exact dot(const ExactVector& a, const ExactVector& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

int sign_of(const Exact& value) {
  return static_cast<int>(CGAL::sign(value));
}

double largest(const Vec3& v) {
  return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
}

}  // namespace

void OpenRegion::clear(const Vec3& origin, double reach) {
  origin_ = origin;
  reach_ = reach;
  count_ = 0;
  sides_.clear();
  blocks_.clear();
}

void OpenRegion::put(std::size_t i, const Vec3& normal, double offset, double error) {
  Block& block = blocks_[i / kLanes];
  const std::size_t lane = i % kLanes;
  block.x[lane] = normal.x;
  block.y[lane] = normal.y;
  block.z[lane] = normal.z;
  block.offset[lane] = offset;
  block.error[lane] = error;
}

/// normal_error: of each of the normal's components. The error of a value: both points' differences to the origin, the
/// products and sums are wrong by less than 10 roundings of |normal| reach, and the normal's error acts on the
/// difference of two points. Underflow in a product of three adds less than 2^-1000. Where values might overflow every
/// sign is uncertain.
void OpenRegion::append(const Side& side, const Vec3& normal, double normal_error) {
  if (count_ == blocks_.size() * kLanes) {
    blocks_.emplace_back();
    for (std::size_t lane = 0; lane < kLanes; ++lane) put(count_ + lane, {0, 0, 0}, -1, 0);
  }
  double error = (2.02 * normal_error + 32 * kRoundoff * largest(normal)) * reach_ + 0x1p-1000;
  if (!(error < 0x1p900)) error = std::numeric_limits<double>::infinity();
  put(count_, normal, dot(normal, *side.points.a - origin_), error);
  sides_.push_back(side);
  ++count_;
}

void OpenRegion::add(const Plane& plane, int sign) {
  append({plane.points, sign, plane.axis, sign * plane.axis_sign}, sign * plane.normal, plane.normal_error);
}

void OpenRegion::add(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 p = b - a, q = c - a, normal = cross(p, q);
  // Each of the two products of a component carries two roundings of differences, one of its own and one of the
  // subtraction.
  const double normal_error = 8.1 * kRoundoff * largest(p) * largest(q) + 0x1p-1000;
  Side side{{&a, &b, &c}, 1, -1, 0};
  for (int axis = 0; axis < 3; ++axis) {
    if (a[axis] == b[axis] && a[axis] == c[axis] && std::fabs(normal[axis]) > normal_error) {
      side.axis = axis;
      side.axis_sign = normal[axis] > 0 ? 1 : -1;
    }
  }
  append(side, normal, normal_error);
}

void OpenRegion::remove_last() {
  put(--count_, {0, 0, 0}, -1, 0);
  sides_.pop_back();
}

HalfSpace OpenRegion::half_space(std::size_t i, double extent) const {
  const Block& block = blocks_[i / kLanes];
  const std::size_t lane = i % kLanes;
  const Vec3 normal{block.x[lane], block.y[lane], block.z[lane]};
  // block.error holds the normal's error times the reach; what it is worth at coordinates up to the extent follows.
  const double slack = block.error[lane] * (1 + 8 * extent / reach_) + 64 * kRoundoff * largest(normal) * extent;
  return {normal, dot(normal, *sides_[i].points.a) - slack};
}

int OpenRegion::certain_side(std::size_t i, const Vec3& v, StageCounts& counts) const {
  const Block& block = blocks_[i / kLanes];
  const std::size_t lane = i % kLanes;
  const Vec3 w = v - origin_;
  const double value = block.x[lane] * w.x + block.y[lane] * w.y + block.z[lane] * w.z - block.offset[lane];
  if (value > block.error[lane] || value < -block.error[lane]) {
    ++counts.filter;
    return value > 0 ? 1 : -1;
  }
  return 0;
}

int OpenRegion::exact_side(std::size_t i, const Vec3& v, StageCounts& counts) const {
  const Side& side = sides_[i];
  const Vec3 &a = *side.points.a, &b = *side.points.b, &c = *side.points.c;
  ++counts.filter;
  if (side.axis >= 0) {
    const double at = v[side.axis], of_plane = a[side.axis];
    return at > of_plane ? side.axis_sign : at < of_plane ? -side.axis_sign : 0;
  }
  // In buildings nearly all zeros can be seen: v is one of the points, or a and b lie on a line along an axis that also
  // holds v or is parallel to that from c to v.
  if (v == a || v == b || v == c) return 0;
  const bool x = a.x == b.x, y = a.y == b.y, z = a.z == b.z;
  if ((x && y) || (y && z) || (z && x)) {
    const auto same = [&](const Vec3& p) { return (!x || p.x == v.x) && (!y || p.y == v.y) && (!z || p.z == v.z); };
    if (same(a) || same(c)) return 0;
  }
  --counts.filter;
  return side.sign * orientation(a, b, c, v, counts);
}

std::optional<bool> OpenRegion::meets_at_sight(std::span<const Corner> facet, StageCounts& counts) {
  const std::size_t stride = blocks_.size() * kLanes;
  values_.resize(facet.size() * stride);
  signs_.assign(blocks_.size(), {});
  for (std::size_t k = 0; k < facet.size(); ++k) {
    const Vec3 w = facet[k].at - origin_;
    bool inside = true;
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      const Block& block = blocks_[b];
      const Doubles value = load(block.x) * w.x + load(block.y) * w.y + load(block.z) * w.z - load(block.offset);
      store(value, &values_[k * stride + b * kLanes]);
      const SignBytes signs = certain_signs(value, load(block.error)), positive = positive_bytes(signs);
      signs_[b].some_inside |= positive;
      signs_[b].all_inside &= positive;
      signs_[b].all_outside &= negative_bytes(signs);
      inside = inside && positive == kOnes;
    }
    if (inside) return ++counts.filter, true;
  }
  if (std::any_of(signs_.begin(), signs_.end(), [](const Signs& s) { return s.all_outside != 0; })) {
    return ++counts.filter, false;
  }
  cutting_.clear();
  bool separated = false;
  for (std::size_t b = 0; b < blocks_.size() && !separated; ++b) {
    for_each_byte(~signs_[b].all_inside & kOnes, [&](std::size_t lane) {
      const std::size_t i = b * kLanes + lane;
      cutting_.push_back(static_cast<std::uint32_t>(i));
      if (separated || sign_byte(signs_[b].some_inside, lane) != 0) return;
      const double error = blocks_[b].error[lane];
      separated = true;
      for (std::size_t k = 0; k < facet.size() && separated; ++k) {
        separated = values_[k * stride + i] < -error || exact_side(i, facet[k].at, counts) <= 0;
      }
    });
  }
  if (separated) return false;
  return std::nullopt;
}

/// Clips the facet by all planes, each moved by `slack` times its error: outward if that is positive. A point of the
/// facet is a convex combination of its corners and so are its values; clipping them takes no coordinates. A value
/// interpolated up to c times is wrong by less than c times the error of a corner's value (that holds 32 roundings of
/// the largest), so that with a slack of c + 1
///  - moved inward, what is left is a part of the region,
///  - moved outward, what is cut away has nothing of it.
bool OpenRegion::clip_leaves_some(std::size_t corners, double slack) {
  const std::size_t c = cutting_.size(), stride = blocks_.size() * kLanes;
  rows_.clear();
  for (std::size_t k = 0; k < corners; ++k) {
    for (const std::uint32_t i : cutting_) {
      rows_.push_back(values_[k * stride + i] + slack * blocks_[i / kLanes].error[i % kLanes]);
    }
  }
  for (std::size_t i = 0; i < c; ++i) {
    const std::size_t n = rows_.size() / c;
    std::size_t kept = 0;
    for (std::size_t k = 0; k < n; ++k) kept += rows_[k * c + i] >= 0;
    if (kept == 0) return false;
    if (kept == n) continue;
    next_.clear();
    for (std::size_t k = 0; k < n; ++k) {
      const double* p = &rows_[k * c];
      const double* q = &rows_[(k + 1 < n ? k + 1 : 0) * c];
      if (p[i] >= 0) next_.insert(next_.end(), p, p + c);
      if ((p[i] >= 0) != (q[i] >= 0)) {
        const double t = p[i] / (p[i] - q[i]);
        for (std::size_t j = 0; j < c; ++j) next_.push_back(p[j] + t * (q[j] - p[j]));
      }
    }
    rows_.swap(next_);
  }
  return true;
}

/// The same, exact. A corner of what is left is a corner of the facet, or where one of its edges meets a plane, or
/// where two planes meet in the facet's; each is known by these, so that signs are those of polynomials of bounded
/// degree in the values at the facet's corners and at three points that span its plane.
bool OpenRegion::clip_leaves_some_exactly(std::span<const Corner> facet, const PlanePoints& plane) const {
  const std::size_t n = facet.size(), c = cutting_.size();
  std::vector<Exact> at_corner(n * c);
  std::vector<ExactVector> at_three;
  for (std::size_t q = 0; q < c; ++q) {
    const Side& side = sides_[cutting_[q]];
    const Vec3& a = *side.points.a;
    const ExactVector normal = side.sign > 0 ? cross(ExactVector(*side.points.b, a), ExactVector(*side.points.c, a))
                                             : cross(ExactVector(*side.points.c, a), ExactVector(*side.points.b, a));
    const auto value = [&](const Vec3& v) { return dot(normal, ExactVector(v, a)); };
    for (std::size_t k = 0; k < n; ++k) at_corner[k * c + q] = value(facet[k].at);
    at_three.push_back({value(*plane.a), value(*plane.b), value(*plane.c)});
  }

  constexpr std::size_t kNothing = static_cast<std::size_t>(-1);
  /// Runs along an edge of the facet, or along a plane.
  struct Line {
    std::size_t edge = kNothing, plane = kNothing;
  };
  struct Point {
    Line on;  ///< of a facet's corner: the edge that starts there
    std::size_t cut_by = kNothing;
    Line next;  ///< to the next point
  };
  const auto sign_at = [&](const Point& point, std::size_t q) {
    if (point.cut_by == kNothing) return sign_of(at_corner[point.on.edge * c + q]);
    if (point.on.edge != kNothing) {
      const Exact* from = &at_corner[point.on.edge * c];
      const Exact* to = &at_corner[(point.on.edge + 1) % n * c];
      return sign_of(from[point.cut_by]) * sign_of(from[point.cut_by] * to[q] - to[point.cut_by] * from[q]);
    }
    const ExactVector weights = cross(at_three[point.on.plane], at_three[point.cut_by]);
    return sign_of(weights.x + weights.y + weights.z) * sign_of(dot(weights, at_three[q]));
  };

  std::vector<Point> left, kept;
  std::vector<int> signs;
  for (std::size_t k = 0; k < n; ++k) left.push_back({{k, kNothing}, kNothing, {k, kNothing}});
  for (std::size_t q = 0; q < c; ++q) {
    signs.clear();
    for (const Point& point : left) signs.push_back(sign_at(point, q));
    // What is left always has an area, so that a point strictly inside means that it keeps some.
    if (std::none_of(signs.begin(), signs.end(), [](int s) { return s > 0; })) return false;
    kept.clear();
    for (std::size_t k = 0; k < left.size(); ++k) {
      const int sign = signs[k], next_sign = signs[k + 1 < left.size() ? k + 1 : 0];
      const Line cut{kNothing, q};
      if (sign >= 0) {
        kept.push_back(left[k]);
        if (sign == 0 && next_sign < 0) kept.back().next = cut;
      }
      if (sign * next_sign < 0) kept.push_back({left[k].next, q, sign > 0 ? cut : left[k].next});
    }
    left.swap(kept);
  }
  return true;
}

bool OpenRegion::meets(std::span<const Corner> facet, const PlanePoints& plane, StageCounts& counts) {
  const auto slack = static_cast<double>(cutting_.size() + 1);
  const bool finite = std::all_of(cutting_.begin(), cutting_.end(), [&](std::uint32_t i) {
    return std::isfinite(blocks_[i / kLanes].error[i % kLanes]);
  });
  if (finite && clip_leaves_some(facet.size(), -slack)) return ++counts.filter, true;
  if (finite && !clip_leaves_some(facet.size(), slack)) return ++counts.filter, false;
  ++counts.exact;
  return clip_leaves_some_exactly(facet, plane);
}

}  // namespace exitance
