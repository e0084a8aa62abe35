#include "geometry/shell_interior.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>
#include <utility>

#include "geometry/projection.h"

namespace exitance {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

constexpr Projection kAlongX{0};  // u = y, v = z

// How often the loop, seen along x, winds around p: +1 when it faces +x, −1 when it faces −x, 0 beside it. An edge is
// tested in the same order from both its facets, so that a ray through it meets one of them.
int winding(const Loop& loop, const Vec3& p) {
  int count = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec3 &a = loop[i], &b = loop[(i + 1) % loop.size()];
    const bool a_above = a.z > p.z, b_above = b.z > p.z;
    if (a_above == b_above) continue;
    const bool p_left = b_above ? turn(kAlongX, a, b, p) > 0 : turn(kAlongX, b, a, p) > 0;
    if (p_left) count += b_above ? 1 : -1;
  }
  return count;
}

// Whether p lies on the −x side of the facet's plane. REQUIRES: the plane is not parallel to x.
bool is_before(const Loop& loop, const Vec3& p) {
  const std::size_t n = loop.size();
  std::size_t k = 0;
  int sense = 0;
  while ((sense = turn(kAlongX, loop[k], loop[(k + 1) % n], loop[(k + 2) % n])) == 0) ++k;
  const auto point = [](const Vec3& q) { return Kernel::Point_3(q.x, q.y, q.z); };
  const auto side = CGAL::orientation(point(loop[k]), point(loop[(k + 1) % n]), point(loop[(k + 2) % n]), point(p));
  return static_cast<int>(side) * sense < 0;
}

}  // namespace

ShellInterior::ShellInterior(std::vector<Loop> facets) : facets_(std::move(facets)) {
  for (const Loop& facet : facets_) {
    for (const Vec3& p : facet) box_.extend(p);
  }
  cells_per_axis_ = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(facets_.size()))));
  cells_.resize(cells_per_axis_ * cells_per_axis_);
  for (std::uint32_t i = 0; i < facets_.size(); ++i) {
    Box box;
    for (const Vec3& p : facets_[i]) box.extend(p);
    for (std::size_t y = cell(box.lower.y, 1); y <= cell(box.upper.y, 1); ++y) {
      for (std::size_t z = cell(box.lower.z, 2); z <= cell(box.upper.z, 2); ++z) {
        cells_[y * cells_per_axis_ + z].push_back(i);
      }
    }
  }
}

std::size_t ShellInterior::cell(double value, int axis) const {
  const double extent = box_.upper[axis] - box_.lower[axis];
  if (!(extent > 0)) return 0;
  const double position = (value - box_.lower[axis]) / extent * static_cast<double>(cells_per_axis_);
  return std::min(static_cast<std::size_t>(std::max(position, 0.0)), cells_per_axis_ - 1);
}

bool ShellInterior::contains(const Vec3& p) const {
  if (!box_.contains(p)) return false;
  int crossings = 0;
  for (const std::uint32_t i : cells_[cell(p.y, 1) * cells_per_axis_ + cell(p.z, 2)]) {
    const int count = winding(facets_[i], p);
    if (count != 0 && is_before(facets_[i], p)) crossings += count;
  }
  return crossings != 0;
}

}  // namespace exitance
