#include "src/form_factor/crossing_pole.h"

#include <algorithm>
#include <boost/math/constants/constants.hpp>
#include <cmath>
#include <vector>

namespace exitance {
namespace {

/// By measurement: the size of poles is estimated from above, but no more than a hundred times.
constexpr double kSize = 0.2;

bool meet(const SeenEdge& e, const SeenEdge& g) {
  constexpr double kSame = 1e-9;
  const auto same = [](const Vec3& p, const Vec3& q) { return norm(p - q) < kSame; };
  return same(e.from, g.from) || same(e.from, g.to) || same(e.to, g.from) || same(e.to, g.to);
}

bool in_one_plane(const SeenEdge& e, const SeenEdge& g) {
  const Vec3 d = e.b - e.a, f = g.b - g.a, apart = g.a - e.a;
  return std::fabs(dot(cross(f, d), apart)) <= 1e-10 * norm(d) * norm(f) * (norm(apart) + norm(d) + norm(f));
}

}  // namespace

PoleError pole_error(std::span<const SeenEdge> edges, const AreaCell& cell, int order) {
  std::vector<Vec3> places(cell.loop().begin(), cell.loop().end());
  if (!cell.is_straight()) {
    places.push_back(first_side(cell, 0.5).at);
    places.push_back(opposite_side(cell, 0.5).at);
  }
  PoleError result;
  double worst = 0;
  for (const SeenEdge& e : edges) {
    const Vec3 d = e.b - e.a;
    for (const SeenEdge& g : edges) {
      if (e.id == g.id || !meet(e, g) || in_one_plane(e, g)) continue;
      const auto denominator = [&](const Vec3& x) { return dot(cross(g.a - x, g.b - x), d); };
      const auto [low, high] = std::ranges::minmax(places, {}, denominator);
      const double at_low = denominator(low), at_high = denominator(high);
      if (at_low < 0 && at_high > 0) continue;  // the crossing is not on e all over the cell
      const bool low_is_near = std::fabs(at_low) < std::fabs(at_high);
      const Vec3 x = low_is_near ? low : high;
      const double nearest = std::fabs(low_is_near ? at_low : at_high),
                   farthest = std::fabs(low_is_near ? at_high : at_low), width = farthest - nearest;
      if (!(width > 0)) continue;
      const double distance = 2 * nearest / width, rate = 1 + distance + std::sqrt(distance * (distance + 2));
      const Vec3 p = e.a - x, q = e.b - x;
      const double sweep = std::atan2(norm(cross(p, q)), dot(p, q));
      const double slope = nearest / (norm(cross(g.a - x, g.b - x)) * std::min(norm(p), norm(q)));
      const double size = kSize * distance * sweep * std::min(1.0, slope) / boost::math::constants::two_pi<double>();
      const double error = size * std::pow(rate, -2 * order);
      result.error += error;
      if (error > worst) {
        worst = error;
        result.fall = 1 / rate;
      }
    }
  }
  result.error *= cell.area();
  return result;
}

}  // namespace exitance
