#include "geometry/separated_exchange.h"

#include <algorithm>
#include <array>
#include <boost/container/static_vector.hpp>
#include <cmath>
#include <numbers>

#include "geometry/gauss_rule.h"

namespace exitance {
namespace {

/// Pairs of points beyond which the contour is cheaper.
constexpr int kMostPairs = 2500;
constexpr int kHighest = 8;

/// A convex quadrilateral, or a triangle with a double last corner, with the heights of its corners above the other
/// facet's plane. The square is mapped bilinearly onto it; the map's Jacobian is then linear.
struct Cell {
  std::array<Vec3, 4> corner;
  std::array<double, 4> height{};
  double jacobian = 0, along_s = 0, along_t = 0;  ///< at (0, 0), and its slopes
  double half_s = 0, half_t = 0;                  ///< half the longest side in each direction
  double height_variation = 0, jacobian_variation = 0;
};

struct Cells {
  boost::container::static_vector<Cell, 4> cell;
  bool well_known = true;
  double displacement = 0;    ///< of corners
  double relative_error = 0;  ///< of areas and heights
};

double max3(double a, double b, double c) {
  return std::max(a, std::max(b, c));
}

/// How much a positive linear function varies over a cell: from 1 − result to 1 + result times its mean.
double variation(double least, double most) {
  return most > 0 ? (most - least) / (most + least) : 0;
}

Cells cells_of(const RadiatorFacet& facet, const ClippedLoop& loop, const RadiatorFacet& plane, const Vec3& origin) {
  Cells cells;
  if (loop.size() > 8) {
    cells.well_known = false;
    return cells;
  }
  boost::container::static_vector<Vec3, 8> point;
  boost::container::static_vector<double, 8> height;
  double highest = 0, displacement = 0, worst = 0, size = 0;
  bool clipped = false;
  const PlanePoints points = plane.plane();
  for (const ClippedCorner& c : loop) {
    double moved = 0;
    const Vec<double> p = position<double>(facet, c, points, origin, moved);
    point.push_back({p.x, p.y, p.z});
    clipped = clipped || c.is_crossing();
    displacement = std::max(displacement, moved);
    const Vec3 w = facet.loop[c.from] - *points.a;
    height.push_back(c.is_crossing() ? 0 : std::max(0.0, dot(plane.normal, w)));
    highest = std::max(highest, height.back());
    worst = std::max(worst, 8 * kRoundoff * norm(w));
  }
  if (worst > 0x1p-44 * highest) {
    const Vec3 doubled = exact_cross(*points.a, *points.b, *points.c);
    for (std::size_t k = 0; k < loop.size(); ++k) {
      if (loop[k].is_crossing()) continue;
      height[k] = exact_plane_value(points, facet.loop[loop[k].from]).value / norm(doubled);
      highest = std::max(highest, height[k]);
    }
    worst = 0x1p-45 * highest;
  }
  double area = 0;
  for (std::size_t k = 1; k + 1 < loop.size(); k += 2) {
    const std::size_t last = std::min(k + 2, loop.size() - 1);
    const std::array<std::size_t, 4> index{0, k, k + 1, last};
    Cell cell;
    for (std::size_t i = 0; i < 4; ++i) {
      cell.corner[i] = point[index[i]];
      cell.height[i] = height[index[i]];
    }
    const auto& c = cell.corner;
    // Of input vertices, where possible: a sliver's area is lost in rounded differences.
    const auto twice = [&](std::size_t i, std::size_t j, std::size_t l) {
      const ClippedCorner &p = loop[index[i]], &q = loop[index[j]], &r = loop[index[l]];
      if (p.is_crossing() || q.is_crossing() || r.is_crossing()) return doubled_area(c[i], c[j], c[l]);
      return doubled_area(facet.loop[p.from], facet.loop[q.from], facet.loop[r.from]);
    };
    const bool triangle = last == k + 1;
    const double j00 = twice(0, 1, triangle ? 2 : 3), j10 = triangle ? j00 : twice(0, 1, 2),
                 j01 = triangle ? 0 : twice(0, 2, 3);
    cell.jacobian = j00;
    cell.along_s = j10 - j00;
    cell.along_t = j01 - j00;
    const auto side = [&](std::size_t i, std::size_t j) { return norm(c[j] - c[i]); };
    const double d01 = side(0, 1), d12 = side(1, 2), d23 = side(2, 3), d30 = side(3, 0);
    cell.half_s = 0.5 * std::max(d01, d23);
    cell.half_t = 0.5 * std::max(d12, d30);
    const auto [lowest, top] = std::minmax_element(cell.height.begin(), cell.height.end());
    cell.height_variation = variation(*lowest, *top);
    cell.jacobian_variation = variation(std::max(0.0, std::min(std::min(j00, j10 + j01 - j00), std::min(j10, j01))),
                                        std::max(std::max(j00, j10 + j01 - j00), std::max(j10, j01)));
    size = max3(size, cell.half_s, cell.half_t);
    const double a = 0.5 * (j00 + 0.5 * (j10 - j00) + 0.5 * (j01 - j00)) * 2;
    if (!(a > 0)) continue;
    area += a;
    cells.cell.push_back(cell);
  }
  if (cells.cell.empty() || !(highest > 0)) {
    cells.well_known = false;
    return cells;
  }
  // Corners moved by rounding change a clipped area by no more than the outline's length times that.
  cells.displacement = displacement;
  cells.relative_error = (clipped ? 8 * displacement * size / area : 0) + 8 * worst / highest + 16 * kRoundoff;
  return cells;
}

/// Points of a rule on a cell, their weights times heights.
struct Points {
  std::array<double, kHighest * kHighest> x, y, z, weight;
  std::size_t count = 0;
};

void fill(Points& points, const Cell& cell, int order_s, int order_t) {
  const GaussRule<double>&rule_s = gauss_rule<double>(order_s), &rule_t = gauss_rule<double>(order_t);
  points.count = 0;
  const auto& c = cell.corner;
  const auto& h = cell.height;
  for (std::size_t i = 0; i < rule_s.node.size(); ++i) {
    const double s = 0.5 * (1 + rule_s.node[i]), r = 1 - s;
    const Vec3 low = r * c[0] + s * c[1], high = r * c[3] + s * c[2];
    const double h_low = r * h[0] + s * h[1], h_high = r * h[3] + s * h[2];
    for (std::size_t j = 0; j < rule_t.node.size(); ++j) {
      const double t = 0.5 * (1 + rule_t.node[j]), q = 1 - t;
      const std::size_t k = points.count++;
      const Vec3 p = q * low + t * high;
      points.x[k] = p.x;
      points.y[k] = p.y;
      points.z[k] = p.z;
      points.weight[k] = 0.25 * rule_s.weight[i] * rule_t.weight[j] *
                         (cell.jacobian + s * cell.along_s + t * cell.along_t) * (q * h_low + t * h_high);
    }
  }
}

double kernel_sum(const Points& a, const Points& b) {
  std::array<double, kHighest * kHighest> sum;
  for (std::size_t i = 0; i < a.count; ++i) sum[i] = 0;
  for (std::size_t j = 0; j < b.count; ++j) {
    const double x = b.x[j], y = b.y[j], z = b.z[j], weight = b.weight[j];
    for (std::size_t i = 0; i < a.count; ++i) {
      const double dx = a.x[i] - x, dy = a.y[i] - y, dz = a.z[i] - z;
      const double square = dx * dx + dy * dy + dz * dz;
      sum[i] += weight / (square * square);
    }
  }
  double total = 0;
  for (std::size_t i = 0; i < a.count; ++i) total += a.weight[i] * sum[i];
  return total / std::numbers::pi;
}

/// A lower bound of the distance between two cells: their gap along the line of centres or above either's corners.
double gap_between(const Cell& a, const Cell& b) {
  const auto gap_along = [&](const Vec3& direction) {
    double a_low = 1e300, a_high = -1e300, b_low = 1e300, b_high = -1e300;
    for (std::size_t k = 0; k < 4; ++k) {
      const double at_a = dot(direction, a.corner[k]), at_b = dot(direction, b.corner[k]);
      a_low = std::min(a_low, at_a);
      a_high = std::max(a_high, at_a);
      b_low = std::min(b_low, at_b);
      b_high = std::max(b_high, at_b);
    }
    return std::max(b_low - a_high, a_low - b_high);
  };
  const auto centre = [](const Cell& c) { return 0.25 * ((c.corner[0] + c.corner[1]) + (c.corner[2] + c.corner[3])); };
  const Vec3 line = centre(b) - centre(a);
  const double distance = norm(line);
  double gap = distance > 0 ? gap_along((1 / distance) * line) : 0;
  const double above_a = *std::min_element(b.height.begin(), b.height.end()),
               above_b = *std::min_element(a.height.begin(), a.height.end());
  return max3(gap, above_a, above_b);
}

/// The lowest order whose relative error is below `relative`, which is added to `error`. The kernel r^-4 has Gegenbauer
/// coefficients binom(k + 3, 3) ρ^-k, ρ belonging to the nearest pole that a point at the distance `gap` of a segment
/// can make; n points see those from k = 2n on. Heights and Jacobian are linear and bring a lower one in each.
int order_for(double half, double gap, double height_variation, double jacobian_variation, double relative,
              double& error) {
  const double q = gap / half, decay = std::sqrt(1 + q * q) - q;
  double power = 1;  // ρ^-(2n-2)
  for (int n = 1; n <= kHighest; ++n) {
    const double estimate = 2.0 * (2 * n + 3) * (2 * n + 2) * (2 * n + 1) / 6 * power * (decay + height_variation) *
                            (decay + jacobian_variation);
    if (estimate <= relative) {
      error += estimate;
      return n;
    }
    power *= decay * decay;
  }
  return kHighest + 1;
}

}  // namespace

std::optional<Exchange> separated_exchange(const FacetPair& pair, double relative) {
  // Whole facets nearer than that need too many points.
  if (pair.of_a.size() == pair.a->loop.size() && pair.of_b.size() == pair.b->loop.size() &&
      norm(pair.b->centre - pair.a->centre) < 1.5 * std::max(pair.a->radius, pair.b->radius)) {
    return std::nullopt;
  }
  const Vec3 origin = pair.a->centre;
  const Cells of_a = cells_of(*pair.a, pair.of_a, *pair.b, origin);
  if (!of_a.well_known) return std::nullopt;
  const Cells of_b = cells_of(*pair.b, pair.of_b, *pair.a, origin);
  if (!of_b.well_known) return std::nullopt;

  Exchange total;
  Points points_a, points_b;
  for (const Cell& a : of_a.cell) {
    for (const Cell& b : of_b.cell) {
      const double gap = gap_between(a, b);
      if (!(gap > 0)) return std::nullopt;
      double truncation = 0;
      std::array<int, 4> order{};
      int pairs = 1;
      const std::array<double, 4> half{a.half_s, a.half_t, b.half_s, b.half_t};
      for (std::size_t k = 0; k < 4; ++k) {
        const Cell& cell = k < 2 ? a : b;
        order[k] = order_for(half[k], gap, cell.height_variation, cell.jacobian_variation, relative, truncation);
        if (order[k] > kHighest) return std::nullopt;
        pairs *= order[k];
      }
      if (pairs > kMostPairs) return std::nullopt;
      fill(points_a, a, order[0], order[1]);
      fill(points_b, b, order[2], order[3]);
      const double part = kernel_sum(points_a, points_b);
      total.integral += part;
      total.error += part * (truncation + 4 * (of_a.displacement + of_b.displacement) / gap);
    }
  }
  total.error += total.integral * (of_a.relative_error + of_b.relative_error + 32 * kRoundoff);
  return total;
}

}  // namespace exitance
