#pragma once
// Sizes that can be computed with: products of coordinates, areas and volumes neither overflow nor vanish.

#include <filesystem>
#include <string>

#include "src/scene/scene.h"

namespace exitance {

/// Of coordinates and of the scene as a whole, from the origin [m].
inline constexpr double kLargestExtent = 1e50, kSmallestExtent = 1e-50;
/// Of surfaces, as a share of the square of the scene's extent.
inline constexpr double kSmallestArea = 1e-50;

/// The largest |coordinate| [m]; infinite where one is not finite, 0 where there is none.
double extent(const Polygon& polygon);
double extent(const Scene& scene);

/// Why a polygon cannot be computed with in a scene of this extent, in words; empty where it can. Zero area is small
/// enough to be left out, so that nothing is said of it. REQUIRES: no defect but zero area (find_defect).
std::string find_bad_extent(const Polygon& polygon, double scene_extent);

/// Throws InputError for the first surface that cannot be computed with, and for a scene in which no surface has an
/// area and is more than an obstruction. path: what stands for the file of a surface that comes from none.
void refuse_bad_extents(const Scene& scene, const std::filesystem::path& path);

}  // namespace exitance
