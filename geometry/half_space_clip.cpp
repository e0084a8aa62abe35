#include "geometry/half_space_clip.h"

namespace exitance {

ClippedLoop clip_in_front(const RadiatorFacet& facet, const RadiatorFacet& plane) {
  const PlanePoints points = plane.plane();
  const Vec3& origin = *points.a;
  StageCounts counts;
  boost::container::small_vector<int, 8> sign;
  bool in_front = false;
  for (const Vec3& v : facet.loop) {
    // Unit normal and difference are known to a few roundings; what is not clear of them is decided exactly.
    const Vec3 w = v - origin;
    const double height = dot(plane.normal, w);
    const double bound = 0x1p-46 * (std::fabs(w.x) + std::fabs(w.y) + std::fabs(w.z));
    const int s = height > bound ? 1 : height < -bound ? -1 : orientation(*points.a, *points.b, *points.c, v, counts);
    sign.push_back(s);
    in_front = in_front || s > 0;
  }
  ClippedLoop kept;
  if (!in_front) return kept;
  const auto n = static_cast<std::uint32_t>(sign.size());
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t next = i + 1 < n ? i + 1 : 0;
    if (sign[i] >= 0) kept.push_back({i, i});
    if (sign[i] * sign[next] < 0) kept.push_back({i, next});
  }
  return kept;
}

}  // namespace exitance
