#include "src/stress/stage.h"

#include <algorithm>

namespace exitance {

Loop at_height(double z, const Points2& points) {
  Loop loop;
  for (const auto& [x, y] : points) loop.push_back({x, y, z});
  return loop;
}

Loop rectangle(double z, double x0, double y0, double x1, double y1) {
  return at_height(z, {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}});
}

Loop reversed(Loop loop) {
  std::reverse(loop.begin(), loop.end());
  return loop;
}

Loop parallelogram(const Vec3& corner, const Vec3& u, const Vec3& v) {
  return {corner, corner + u, corner + u + v, corner + v};
}

Obstacle sheet(Loop loop) {
  return {{{std::move(loop), {}}}, false};
}

Obstacle box(const Vec3& a, const Vec3& b) {
  const auto corner = [&](int i) { return Vec3{i & 1 ? b.x : a.x, i & 2 ? b.y : a.y, i & 4 ? b.z : a.z}; };
  Obstacle solid{{}, true};
  for (const auto& f : {std::array{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}) {
    solid.faces.push_back({{corner(f[0]), corner(f[1]), corner(f[2]), corner(f[3])}, {}});
  }
  return solid;
}

Obstacle octahedron(const Vec3& centre, double radius) {
  Obstacle solid{{}, true};
  for (int octant = 0; octant < 8; ++octant) {
    const auto along = [&](int bit) { return octant & bit ? -radius : radius; };
    const Vec3 x{along(1), 0, 0}, y{0, along(2), 0}, z{0, 0, along(4)};
    const bool mirrored = along(1) * along(2) * along(4) < 0;
    solid.faces.push_back({{centre + x, centre + (mirrored ? z : y), centre + (mirrored ? y : z)}, {}});
  }
  return solid;
}

Obstacle tetrahedron(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  if (dot(cross(b - a, c - a), d - a) > 0) return tetrahedron(a, c, b, d);
  return {{{{a, b, c}, {}}, {{a, d, b}, {}}, {{b, d, c}, {}}, {{c, d, a}, {}}}, true};
}

Obstacle prism(const Points2& base, double bottom, double top) {
  const Loop low = at_height(bottom, base), high = at_height(top, base);
  Obstacle solid{{{reversed(low), {}}, {high, {}}}, true};
  for (std::size_t k = 0, n = base.size(); k < n; ++k) {
    solid.faces.push_back({{low[k], low[(k + 1) % n], high[(k + 1) % n], high[k]}, {}});
  }
  return solid;
}

Stage::Stage(Random& numbers, double s) : random(numbers), size(s) {
  question.normal = {0, 0, 1};
  question.source = {reversed(rectangle(kSourceHeight, -kHalfSource, -kHalfSource, kHalfSource, kHalfSource)), {}};
}

Vec3 Stage::step(int most) {
  Vec3 v;
  while (v == Vec3{}) v = Vec3{1.0 * whole(-most, most), 1.0 * whole(-most, most), 1.0 * whole(-most, most)};
  return v;
}

Vec3 Stage::between() {
  const double z = whole(3, 12);
  return {std::round(whole(-8, 8) * z / 16), std::round(whole(-8, 8) * z / 16), z};
}

void Stage::add_box(const Vec3& at, int most) {
  add(box(at, at + Vec3{1.0 * whole(1, most), 1.0 * whole(1, most), 1.0 * whole(1, most)}));
}

void Stage::add_something() {
  switch (whole(0, 2)) {
    case 0:
      return add_box(between(), 3);
    case 1:
      return add_sheet({between(), between(), between()});
    default:
      return add_sheet(parallelogram(between(), step(3), step(3)));
  }
}

}  // namespace exitance
