#pragma once
// A scene whose radiosity has a closed form: a floor below an emitter, and just above it a sheet with a small shadow.

#include <algorithm>

#include "src/scene/scene.h"
#include "tests/reference/half_shadow.h"

namespace exitance {

/// A square parallel to the floor, with its middle at x, y.
struct SmallSheet {
  double x = 0, y = 0, edge = 0, height = 0;
};

/// That of half_shadow(), but the sheet (surface 2) is small.
inline Scene small_shadow(const SmallSheet& sheet) {
  Scene scene = half_shadow(0);
  const double r = 0.5 * sheet.edge, z = sheet.height;
  scene.name = "small shadow";
  scene.surfaces[2].polygon.outer = {{sheet.x - r, sheet.y - r, z},
                                     {sheet.x + r, sheet.y - r, z},
                                     {sheet.x + r, sheet.y + r, z},
                                     {sheet.x - r, sheet.y + r, z}};
  return scene;
}

/// B of the floor at x, y: what is seen of the emitter, without the sheet's projection onto it.
inline double small_shadow_B(const SmallSheet& sheet, double x, double y) {
  struct Interval {
    double from, to;
  };
  const auto F = [](Interval a, Interval b) {
    return to_corner(a.to, b.to) - to_corner(a.from, b.to) - to_corner(a.to, b.from) + to_corner(a.from, b.from);
  };
  const auto projected = [&](double middle, double from) {  // relative to the point
    const double r = 0.5 * sheet.edge;
    return Interval{std::clamp((middle - r - from) / sheet.height, -from, 1 - from),
                    std::clamp((middle + r - from) / sheet.height, -from, 1 - from)};
  };
  return 0.5 * (F({-x, 1 - x}, {-y, 1 - y}) - F(projected(sheet.x, x), projected(sheet.y, y)));
}

}  // namespace exitance
