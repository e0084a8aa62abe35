#include "src/form_factor/visual_event.h"

namespace exitance {

bool VisualEvent::concerns(std::span<const Vec3> loop) const {
  if (!crosses(loop, plane)) return false;
  LineStretch chord;
  Vec3 a = loop.back();
  double at_a = plane.at(a);
  for (const Vec3& b : loop) {
    const double at_b = plane.at(b);
    if (at_b == 0) chord.add(dot(along, b - plane.point));
    if (at_a * at_b < 0) chord.add(dot(along, a + (at_a / (at_a - at_b)) * (b - a) - plane.point));
    a = b;
    at_a = at_b;
  }
  return chord.to >= stretch.from && chord.from <= stretch.to;
}

}  // namespace exitance
