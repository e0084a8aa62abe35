#pragma once
// Ways to answer what a point sees of a polygon.

#include <string>

#include "src/stress/contender.h"

namespace exitance {

/// What plain doubles may err by before it counts as wrong: far above what rounding costs them where they decide
/// rightly, far below what a wrong decision does.
inline constexpr double kPlainMargin = 1e-9;

/// By name: "exact" (what `answer` says, with more digits where the relative error would exceed 1e-10 at F ≥ 1e-15),
/// "plain-double", "rays:N", "rays:N:fast" (Embree without its robust mode) or "cgal-epeck". Throws
/// std::invalid_argument on other names.
Contender point_contender_named(const std::string& name);

}  // namespace exitance
