#include "src/form_factor/pole.h"

#include <algorithm>
#include <boost/math/constants/constants.hpp>
#include <cmath>
#include <complex>
#include <optional>
#include <vector>

namespace exitance {
namespace {

/// By measurement: the size of poles is estimated from above, but no more than a hundred times.
constexpr double kSize = 0.2;
/// The same of corners: what they add to a rule's error was up to 0.4 of d² V |z + √(z² − 1)|^-2n.
constexpr double kCornerSize = 2;
/// Unit vectors that differ by less are the same direction.
constexpr double kSame = 1e-9;

bool meet(const SeenEdge& e, const SeenEdge& g) {
  const auto same = [](const Vec3& p, const Vec3& q) { return norm(p - q) < kSame; };
  return same(e.from, g.from) || same(e.from, g.to) || same(e.to, g.from) || same(e.to, g.to);
}

bool in_one_plane(const SeenEdge& e, const SeenEdge& g) {
  const Vec3 d = e.b - e.a, f = g.b - g.a, apart = g.a - e.a;
  return std::fabs(dot(cross(f, d), apart)) <= 1e-10 * norm(d) * norm(f) * (norm(apart) + norm(d) + norm(f));
}

/// Where two lines that are seen to meet in a direction from x meet in space; nothing where one of them passes behind.
std::optional<Vec3> meeting_point(const SeenEdge& e, const SeenEdge& g, const Vec3& x, const Vec3& direction) {
  if (!in_one_plane(e, g)) return {};
  const Vec3 d = e.b - e.a, f = g.b - g.a, across = cross(d, f);
  const double size = dot(across, across);
  if (!(size > kSame * kSame * dot(d, d) * dot(f, f))) return {};
  const Vec3 at = e.a + (dot(cross(g.a - e.a, f), across) / size) * d;
  return norm((1 / norm(at - x)) * (at - x) - direction) < kSame ? std::optional(at) : std::nullopt;
}

/// The cell's corners, and points halfway along its bent sides.
std::vector<Vec3> places_of(const AreaCell& cell) {
  std::vector<Vec3> places(cell.loop().begin(), cell.loop().end());
  if (!cell.is_straight()) {
    places.push_back(first_side(cell, 0.5).at);
    places.push_back(opposite_side(cell, 0.5).at);
  }
  return places;
}

struct Nearest {
  Vec3 point;
  bool is_corner = false;
};

/// The point of a loop's sides that is nearest to a point.
Nearest nearest_of(std::span<const Vec3> loop, const Vec3& at) {
  Nearest nearest;
  double least = INFINITY;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const Vec3 a = loop[k], side = loop[(k + 1) % loop.size()] - a;
    const double length = dot(side, side), s = length > 0 ? std::clamp(dot(at - a, side) / length, 0.0, 1.0) : 0;
    const Vec3 p = a + s * side;
    if (norm(at - p) >= least) continue;
    least = norm(at - p);
    nearest = {p, s == 0 || s == 1};
  }
  return nearest;
}

void add(PoleError& sum, double& worst, double error, double rate) {
  sum.error += error;
  if (error <= worst) return;
  worst = error;
  sum.fall = 1 / rate;
}

/// The sum of half axes of the ellipse about −1 and 1 that a point of the complex plane lies on.
double ellipse_through(const std::complex<double>& z) {
  const std::complex<double> root = std::sqrt(z * z - 1.0);
  return std::max(std::abs(z + root), std::abs(z - root));
}

/// What an edge contributes to the form factor from a point (Lambert's sum), without sign.
double contribution(const SeenEdge& e, const Vec3& x, const Vec3& normal) {
  const Vec3 p = e.a - x, q = e.b - x, across = cross(p, q);
  const double size = norm(across);
  // On the edge's line: at most half of what is seen, of an edge that stands upright nothing.
  if (!(size > 0)) return 0.5 * norm(cross(e.b - e.a, normal)) / (norm(e.b - e.a) * norm(normal));
  return std::atan2(size, dot(p, q)) * std::fabs(dot(across, normal)) /
         (size * norm(normal) * boost::math::constants::two_pi<double>());
}

}  // namespace

PoleError crossing_poles(std::span<const SeenEdge> edges, const AreaCell& cell, int order) {
  const std::vector<Vec3> places = places_of(cell);
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
      add(result, worst, size * std::pow(rate, -2 * order), rate);
    }
  }
  result.error *= cell.area();
  return result;
}

PoleError corner_poles(std::span<const SeenEdge> edges, const Vec3& x, std::span<const Vec3> contacts,
                       const AreaCell& cell, int order) {
  const std::vector<Vec3> places = places_of(cell);
  const auto& c = cell.corner;
  const Vec3 normal = vector_area(cell);
  std::vector<WeightedPoint> points;
  gauss_points(cell, 2, points);
  const double area = cell.area();
  if (!(area > 0)) return {};
  Vec3 middle;
  for (const WeightedPoint& p : points) middle = middle + (p.weight / area) * p.point;
  PoleError result;
  double worst = 0;
  // `differs`: what is seen from a point beside the corner and from the middle, by how much.
  const auto add_corner = [&](const Vec3& at, const auto& differs) {
    const Vec3 far = std::ranges::max(places, {}, [&](const Vec3& p) { return norm(p - at); });
    const Nearest nearest = nearest_of(places, at);
    const Vec3 near = nearest.point, along = far - near;
    const double width = norm(along), apart = norm(at - near),
                 d = apart > kSame * width ? apart : width / (order * order);
    if (!(d < width) || (cell.corners == 3 && norm(cell.corner[2] - at) < kSame * width)) return;
    // Beside a side the corner has part of the cell to its left and to its right.
    const double there = nearest.is_corner ? dot(at - near, along) / width : 0.5 * width,
                 beside = nearest.is_corner ? std::sqrt(std::max(0.0, d * d - there * there)) : d;
    const double rate = ellipse_through({2 * there / width - 1, 2 * beside / width});
    const bool of_cell = apart <= kSame * width || (cell.corners == 3 && norm(c[2] - near) < kSame * width);
    const double beside_it = of_cell ? area * (d / width) * (d / width) : std::min(area, d * d);
    add(result, worst, kCornerSize * beside_it * differs(near) * std::pow(rate, -2 * order), rate);
  };
  const auto add_end = [&](const SeenEdge& e, const Vec3& at) {
    add_corner(at, [&](const Vec3& near) {
      const double beside = contribution(e, near, normal);
      double most = std::fabs(beside - contribution(e, middle, normal));
      for (const Vec3& p : places) most = std::max(most, std::fabs(beside - contribution(e, p, normal)));
      return most;
    });
  };
  // An edge that turns sweeps over those that it meets.
  const auto add_foot = [&](const SeenEdge& e, const Vec3& at) {
    add_corner(at, [&](const Vec3& near) {
      double most = 0;
      for (const SeenEdge& g : edges) {
        if (g.id != e.id && meet(e, g)) most = std::max(most, contribution(g, near, normal));
      }
      return most;
    });
  };
  for (const SeenEdge& e : edges) {
    for (const Vec3& end : {e.from, e.to}) {
      const auto is_end = [&](const Vec3& v) { return norm((1 / norm(v - x)) * (v - x) - end) < kSame; };
      if (is_end(e.a)) {
        add_end(e, e.a);
      } else if (is_end(e.b)) {
        add_end(e, e.b);
      } else if (const auto at = std::ranges::find_if(contacts, is_end); at != contacts.end()) {
        add_end(e, *at);
      } else {
        for (const SeenEdge& g : edges) {
          if (norm(g.from - end) >= kSame && norm(g.to - end) >= kSame) continue;
          if (const auto pierced = meeting_point(e, g, x, end)) {
            add_end(e, *pierced);
            break;
          }
        }
      }
    }
    // Seen elsewhere than from where it stands on the cell's plane, an edge turns about that point as well.
    const double height = dot(normal, c[0] - e.a), rise = dot(normal, e.b - e.a);
    if (rise == 0 || !(height / rise > -kSame) || !(height / rise < 1 + kSame)) continue;
    const Vec3 foot = e.a + (height / rise) * (e.b - e.a), direction = (1 / norm(foot - x)) * (foot - x);
    if (norm(direction - e.from) >= kSame && norm(direction - e.to) >= kSame) add_foot(e, foot);
  }
  return result;
}

double ray_fall(std::span<const Vec3> contacts, const AreaCell& cell) {
  if (cell.corners != 3 || !cell.is_straight()) return 0;
  const Vec3 &a = cell.corner[0], &apex = cell.corner[2], side = cell.corner[1] - a;
  const double width = norm(side);
  const auto is_apex = [&](const Vec3& c) { return norm(apex - c) <= kSame * width; };
  if (!(width > 0) || std::ranges::none_of(contacts, is_apex)) return 0;
  const double there = dot(apex - a, side) / width, beside = norm(cross(apex - a, side)) / width;
  return 1 / ellipse_through({2 * there / width - 1, 2 * beside / width});
}

}  // namespace exitance
