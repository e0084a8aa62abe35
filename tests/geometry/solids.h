#pragma once
// Solids of tests, most of them not convex: their faces, which look out.

#include <array>
#include <cmath>
#include <vector>

#include "geometry/polygon.h"

namespace exitance {

using Faces = std::vector<Polygon>;

/// A turn and a shift that round coordinates off all lattices.
inline Vec3 turned(const Vec3& p) {
  const double s = 1.0 / 7;
  return Vec3{0.1, 0.2, 0.3} + p.x * Vec3{2 * s, 3 * s, 6 * s} + p.y * Vec3{-6 * s, -2 * s, 3 * s} +
         p.z * Vec3{3 * s, -6 * s, 2 * s};
}

/// Over a polygon of the lattice, counter-clockwise from above.
inline Faces prism(const std::vector<std::array<int, 2>>& base, int bottom, int top) {
  const auto ring = [&](int z) {
    std::vector<Vec3> loop;
    for (const auto& [x, y] : base) loop.push_back({double(x), double(y), double(z)});
    return loop;
  };
  const auto low = ring(bottom), high = ring(top);
  Faces faces{{{low.rbegin(), low.rend()}, {}}, {high, {}}};
  for (std::size_t k = 0, n = base.size(); k < n; ++k) {
    faces.push_back({{low[k], low[(k + 1) % n], high[(k + 1) % n], high[k]}, {}});
  }
  return faces;
}

/// A ring around (0, 0): walls without a top or bottom of their own but the annuli, cut into four each.
inline Faces ring(int inner, int outer, int bottom, int top) {
  Faces faces;
  const std::array<std::array<int, 2>, 4> corner{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
  const auto at = [&](std::size_t k, int radius, int z) {
    return Vec3{double(radius * corner[k % 4][0]), double(radius * corner[k % 4][1]), double(z)};
  };
  for (std::size_t k = 0; k < 4; ++k) {
    faces.push_back({{at(k, outer, bottom), at(k + 1, outer, bottom), at(k + 1, outer, top), at(k, outer, top)}, {}});
    faces.push_back({{at(k + 1, inner, bottom), at(k, inner, bottom), at(k, inner, top), at(k + 1, inner, top)}, {}});
    faces.push_back({{at(k, outer, top), at(k + 1, outer, top), at(k + 1, inner, top), at(k, inner, top)}, {}});
    faces.push_back(
        {{at(k, inner, bottom), at(k + 1, inner, bottom), at(k + 1, outer, bottom), at(k, outer, bottom)}, {}});
  }
  return faces;
}

/// A vase of several bands around the vertical, of which every other one is narrow.
inline Faces vase(int sides, int bands, int bottom) {
  const auto at = [&](int k, int band) {
    const double turn = 2 * std::acos(-1.0) * k / sides, radius = band % 2 == 0 ? 1.5 : 0.5;
    return Vec3{radius * std::cos(turn), radius * std::sin(turn), double(bottom) + 0.5 * band};
  };
  Faces faces(2);
  for (int k = 0; k < sides; ++k) {
    faces[0].outer.insert(faces[0].outer.begin(), at(k, 0));
    faces[1].outer.push_back(at(k, bands));
    for (int b = 0; b < bands; ++b) {  // bent: two triangles each
      faces.push_back({{at(k, b), at((k + 1) % sides, b), at((k + 1) % sides, b + 1), at(k, b + 1)}, {}});
    }
  }
  return faces;
}

}  // namespace exitance
