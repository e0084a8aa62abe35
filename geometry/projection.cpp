#include "geometry/projection.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>
#include <array>

namespace exitance {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

bool is_collinear(Projection projection, const std::vector<Vec3>& loop) {
  const auto flat = [&](const Vec3& p) { return std::pair{projection.u(p), projection.v(p)}; };
  const auto other = std::find_if(loop.begin(), loop.end(), [&](const Vec3& p) { return flat(p) != flat(loop[0]); });
  return std::all_of(other, loop.end(), [&](const Vec3& p) { return turn(projection, loop[0], *other, p) == 0; });
}

}  // namespace

int turn(Projection projection, const Vec3& a, const Vec3& b, const Vec3& c) {
  const auto flat = [&](const Vec3& p) { return Kernel::Point_2(projection.u(p), projection.v(p)); };
  return CGAL::orientation(flat(a), flat(b), flat(c));
}

std::optional<Projection> largest_projection(const std::vector<Vec3>& loop) {
  const Vec3 area = area_vector(loop);
  std::array<int, 3> axes{0, 1, 2};
  std::stable_sort(axes.begin(), axes.end(), [&](int a, int b) { return std::abs(area[a]) > std::abs(area[b]); });
  // Points of which no projection is more than a segment lie on one line.
  for (const int axis : axes) {
    if (!is_collinear({axis}, loop)) return Projection{axis};
  }
  return std::nullopt;
}

std::vector<Vec3> without_repeats(const std::vector<Vec3>& loop) {
  std::vector<Vec3> distinct;
  std::unique_copy(loop.begin(), loop.end(), std::back_inserter(distinct));
  while (distinct.size() > 1 && distinct.front() == distinct.back()) distinct.pop_back();
  return distinct;
}

}  // namespace exitance
