#include "src/scene/scene_extent.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/radiator.h"
#include "src/scene/input_error.h"

namespace exitance {

double extent(const Polygon& polygon) {
  double largest = 0;
  const auto look = [&](const std::vector<Vec3>& loop) {
    for (const Vec3& p : loop) {
      largest = is_finite(p) ? std::max({largest, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)})
                             : std::numeric_limits<double>::infinity();
    }
  };
  look(polygon.outer);
  std::ranges::for_each(polygon.holes, look);
  return largest;
}

double extent(const Scene& scene) {
  double largest = 0;
  for (const Surface& surface : scene.surfaces) largest = std::max(largest, extent(surface.polygon));
  return largest;
}

std::string find_bad_extent(const Polygon& polygon, double scene_extent) {
  const double own = extent(polygon);
  if (own > kLargestExtent)
    return fmt::format("a coordinate is {:.3g}, which may be {:.0e} at most; scale the scene down", own,
                       kLargestExtent);
  if (scene_extent < kSmallestExtent)
    return fmt::format("no coordinate of the scene is larger than {:.3g}, which must be {:.0e} at least; scale it up",
                       scene_extent, kSmallestExtent);
  if (scene_extent > kLargestExtent) return {};  // said of the surface that reaches out so far
  const double smallest = kSmallestArea * scene_extent * scene_extent;
  if (norm(area_vector(polygon)) >= smallest) return {};
  const double area = Radiator(polygon).area();  // of needles, too
  if (area >= smallest || find_defect(polygon) == PolygonDefect::zero_area) return {};
  return fmt::format("its area of {:.3g} m^2 is nothing beside coordinates of {:.3g} m; remove it", area, scene_extent);
}

void refuse_bad_extents(const Scene& scene, const std::filesystem::path& path) {
  const double largest = extent(scene);
  bool any_patch = false;
  for (const Surface& surface : scene.surfaces) {
    const std::string& file = scene.objects[surface.object].file;
    const auto refuse = [&](const std::string& what) {
      throw InputError(file.empty() ? path.string() : file, surface.line, what);
    };
    if (const std::string what = find_bad_extent(surface.polygon, largest); !what.empty()) refuse(what);
    any_patch = any_patch || (!surface.obstruction_only && find_defect(surface.polygon) == PolygonDefect::none);
  }
  if (!any_patch) {
    throw InputError(path.string(), 0,
                     "no surface has an area and is more than an obstruction, so there is nothing to solve; add one");
  }
}

}  // namespace exitance
