#include "src/stress/truth_body.h"

#include <algorithm>
#include <map>
#include <utility>

namespace exitance::truth {

Side plane_of(const Face& loop) {
  Point n;
  for (std::size_t k = 1; k + 1 < loop.size(); ++k) n = n + cross(loop[k] - loop[0], loop[k + 1] - loop[0]);
  return {unit(n), loop[0]};
}

Face clip(const Face& face, const Side& side, Real rounding) {
  std::vector<Real> height;
  for (const Point& p : face) {
    const Real h = side.at(p);
    height.push_back(std::fabs(h) <= rounding ? 0 : h);
  }
  Face kept;
  for (std::size_t k = 0; k < face.size(); ++k) {
    const std::size_t next = (k + 1) % face.size();
    if (height[k] >= 0) kept.push_back(face[k]);
    if ((height[k] > 0 && height[next] < 0) || (height[k] < 0 && height[next] > 0)) {
      // From the lower point up, whichever way the face runs: neighbours share the new point, bit for bit.
      const bool up = height[k] < 0;
      const Point &low = up ? face[k] : face[next], &high = up ? face[next] : face[k];
      const Real a = up ? height[k] : height[next], b = up ? height[next] : height[k];
      kept.push_back(low + (a / (a - b)) * (high - low));
    }
  }
  return kept.size() < 3 ? Face{} : kept;
}

Body body_of(const std::vector<Face>& faces) {
  Body body;
  std::map<Point, std::size_t> number;
  for (const Face& face : faces) {
    for (const Point& p : face) {
      if (number.emplace(p, body.points.size()).second) body.points.push_back(p);
    }
    for (std::size_t k = 0; k < face.size(); ++k) {
      std::size_t a = number[face[k]], b = number[face[(k + 1) % face.size()]];
      if (a > b) std::swap(a, b);
      if (a != b && std::ranges::find(body.edges, std::array{a, b}) == body.edges.end()) body.edges.push_back({a, b});
    }
  }
  return body;
}

bool is_beside(const Body& body, const Face& a, const Face& b, Real rounding) {
  Face corners = a;
  corners.insert(corners.end(), b.begin(), b.end());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    for (std::size_t j = i + 1; j < corners.size(); ++j) {
      for (std::size_t k = j + 1; k < corners.size(); ++k) {
        const Point n = cross(corners[j] - corners[i], corners[k] - corners[i]);
        const Real size = std::sqrt(dot(n, n));
        if (!(size > 0)) continue;
        for (const Real sign : {1, -1}) {
          const Side side{(sign / size) * n, corners[i]};
          const auto below = [&](const Point& p) { return side.at(p) <= rounding; };
          const auto above = [&](const Point& p) { return side.at(p) >= -rounding; };
          if (std::ranges::all_of(corners, below) && std::ranges::all_of(body.points, above)) return true;
        }
      }
    }
  }
  return false;
}

}  // namespace exitance::truth
