#include "src/form_factor/area_cell.h"

#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/special_functions/legendre.hpp>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "geometry/predicates.h"

namespace exitance {
namespace {

/// Gauss–Legendre on [0, 1], ascending.
struct Rule {
  std::vector<double> node, weight;
  std::vector<double> legendre;  ///< [k * order + i]: (2k + 1) P_k at node i, P_k on [0, 1]
};

template <unsigned Order>
Rule make_rule() {
  using Gauss = boost::math::quadrature::gauss<double, Order>;
  std::vector<std::pair<double, double>> places;
  for (std::size_t k = 0; k < Gauss::abscissa().size(); ++k) {
    const double x = Gauss::abscissa()[k], w = Gauss::weights()[k];
    places.emplace_back(0.5 * (1 + x), 0.5 * w);
    if (x != 0) places.emplace_back(0.5 * (1 - x), 0.5 * w);
  }
  std::sort(places.begin(), places.end());
  Rule rule;
  for (const auto& [node, weight] : places) {
    rule.node.push_back(node);
    rule.weight.push_back(weight);
  }
  for (unsigned k = 0; k < Order; ++k) {
    for (const double x : rule.node) {
      rule.legendre.push_back((2 * k + 1) * boost::math::legendre_p(static_cast<int>(k), 2 * x - 1));
    }
  }
  return rule;
}

template <unsigned... Less>
std::array<Rule, sizeof...(Less)> make_rules(std::integer_sequence<unsigned, Less...>) {
  return {make_rule<Less + 2>()...};
}

const Rule& rule_of(int order) {
  static const auto rules = make_rules(std::make_integer_sequence<unsigned, kHighestOrder - 1>());
  if (order < 2 || order > kHighestOrder) throw std::invalid_argument("gauss_points: order must be 2 to 16");
  return rules[static_cast<std::size_t>(order - 2)];
}

/// Most and least of a plane's functional over a cell, less than rounding taken as zero.
struct Range {
  double below = 0, above = 0, rounding = 0;
};

Range range_of(std::span<const Vec3> loop, const CutPlane& plane) {
  Range r;
  double size = 0;
  for (const Vec3& v : loop) {
    const double d = plane.at(v);
    r.below = std::min(r.below, d);
    r.above = std::max(r.above, d);
    for (int axis = 0; axis < 3; ++axis) size = std::max(size, std::fabs(v[axis]));
    for (int axis = 0; axis < 3; ++axis) size = std::max(size, std::fabs(plane.point[axis]));
  }
  r.rounding = std::max(32 * kRoundoff * norm(plane.normal) * size, 1e-13 * std::max(r.above, -r.below));
  return r;
}

bool crosses(const Range& r) {
  return r.above > r.rounding && -r.below > r.rounding;
}

Vec3 middle(const Vec3& a, const Vec3& b) {
  return a + 0.5 * (b - a);
}

SidePoint point_of(const Vec3& a, const Vec3& b, const Bend& bend, double s) {
  const Vec3 ab = b - a;
  if (bend.weight == 0) return {a + s * ab, ab};
  // a + n / d, both quadratic in s.
  const double w = bend.weight, d = 1 + 2 * (w - 1) * s * (1 - s), d_s = 2 * (w - 1) * (1 - 2 * s);
  const Vec3 ac = w * (bend.control - a), n = 2 * s * (1 - s) * ac + s * s * ab,
             n_s = 2 * (1 - 2 * s) * ac + 2 * s * ab;
  return {a + (1 / d) * n, (1 / d) * (n_s - (d_s / d) * n)};
}

/// The halves of a conic from a to b.
std::pair<Bend, Bend> halves(const Vec3& a, const Vec3& b, const Bend& bend) {
  const double w = bend.weight, share = w / (1 + w), half = w > 0 ? std::sqrt(0.5 * (1 + w)) : 0;
  return {{a + share * (bend.control - a), half}, {b + share * (bend.control - b), half}};
}

/// Across the bent sides, or between them by a straight line, which must not meet them: where a bent side starts along
/// the side next to it, as an event through a contact does, that is told only by whether the halves are regular.
std::pair<AreaCell, AreaCell> bisect_bent(const AreaCell& cell) {
  const Vec3 &a = cell.corner[0], &b = cell.corner[1], &c = cell.corner[2],
             &d = cell.corners == 3 ? cell.corner[2] : cell.corner[3];
  const double along = norm(b - a) + norm(c - d), across = norm(d - a) + norm(c - b);
  const Vec3 m = first_side(cell, 0.5).at, n = opposite_side(cell, 0.5).at;
  const double height = std::max(norm(m - middle(a, b)), norm(n - middle(c, d)));
  if (along < across && 8 * height <= across) {
    const Vec3 p = middle(a, d), q = middle(b, c), normal = vector_area(cell);
    const AreaCell near{{a, b, q, p}, 4, cell.bend};
    const AreaCell far = cell.corners == 3 ? AreaCell{{p, q, c, p}, 3} : AreaCell{{p, q, c, d}, 4, {}, cell.opposite};
    if (is_regular(near, normal) && is_regular(far, normal)) return {near, far};
  }
  const auto [one, other] = halves(a, b, cell.bend);
  const auto [near_d, near_c] = halves(d, c, cell.opposite);
  return {{{a, m, n, d}, cell.corners, one, near_d}, {{m, b, c, n}, cell.corners, other, near_c}};
}

}  // namespace

// The integral of the map's vectors, however it folds.
Vec3 vector_area(const AreaCell& cell) {
  constexpr int kOrder = 4;
  const Rule& rule = rule_of(kOrder);
  Vec3 total;
  for (std::size_t i = 0; i < rule.node.size(); ++i) {
    const SidePoint from = first_side(cell, rule.node[i]), to = opposite_side(cell, rule.node[i]);
    total = total + rule.weight[i] * cross(from.along + 0.5 * (to.along - from.along), to.at - from.at);
  }
  return total;
}

double AreaCell::area() const {
  if (!is_straight()) {
    std::vector<WeightedPoint> points;
    gauss_points(*this, 4, points);
    return std::accumulate(points.begin(), points.end(), 0.0,
                           [](double sum, const WeightedPoint& p) { return sum + p.weight; });
  }
  const Vec3 a = cross(corner[1] - corner[0], corner[2] - corner[0]);
  return 0.5 * (corners == 3 ? norm(a) : norm(a) + norm(cross(corner[2] - corner[0], corner[3] - corner[0])));
}

SidePoint first_side(const AreaCell& cell, double s) {
  return point_of(cell.corner[0], cell.corner[1], cell.bend, s);
}
SidePoint opposite_side(const AreaCell& cell, double s) {
  return point_of(cell.corners == 3 ? cell.corner[2] : cell.corner[3], cell.corner[2], cell.opposite, s);
}

bool is_regular(const AreaCell& cell, const Vec3& normal) {
  // Between the sides the map is linear, so that it folds at one of them first; near a corner it does so where a bent
  // side runs beside the one next to it.
  constexpr std::array kPlaces{0.0,   1.0 / 256, 1.0 / 64, 1.0 / 16,  0.125,     0.25,        0.375, 0.5,
                               0.625, 0.75,      0.875,    15.0 / 16, 63.0 / 64, 255.0 / 256, 1.0};
  constexpr double kRounding = 1e-12;
  for (const double s : kPlaces) {
    const SidePoint from = first_side(cell, s), to = opposite_side(cell, s);
    const Vec3 across = to.at - from.at;
    const auto folds = [&](const Vec3& along) {
      return dot(cross(along, across), normal) < -kRounding * norm(along) * norm(across) * norm(normal);
    };
    if (folds(from.along) || folds(to.along)) return false;
  }
  return true;
}

std::vector<AreaCell> cells_of(std::span<const Vec3> loop) {
  std::vector<AreaCell> cells;
  for (std::size_t k = 1; k + 1 < loop.size(); k += 2) {
    const bool four = k + 2 < loop.size();
    AreaCell cell{{loop[0], loop[k], loop[k + 1], four ? loop[k + 2] : loop[0]}, four ? 4 : 3};
    if (cell.area() > 0) cells.push_back(cell);
  }
  return cells;
}

bool crosses(std::span<const Vec3> loop, const CutPlane& plane) {
  return crosses(range_of(loop, plane));
}

std::vector<AreaCell> cut(const AreaCell& cell, const CutPlane& plane) {
  const auto loop = cell.loop();
  const Range range = range_of(loop, plane);
  if (!crosses(range)) return {};
  std::vector<Vec3> above, below;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const Vec3 &a = loop[k], &b = loop[(k + 1) % loop.size()];
    const double da = plane.at(a), db = plane.at(b);
    if (da >= -range.rounding) above.push_back(a);
    if (da <= range.rounding) below.push_back(a);
    if (std::min(da, db) < -range.rounding && std::max(da, db) > range.rounding) {
      const Vec3 v = std::fabs(da) < std::fabs(db) ? a + (da / (da - db)) * (b - a) : b + (db / (db - da)) * (a - b);
      above.push_back(v);
      below.push_back(v);
    }
  }
  std::vector<AreaCell> cells = cells_of(above);
  for (const AreaCell& c : cells_of(below)) cells.push_back(c);
  return cells;
}

std::pair<AreaCell, AreaCell> bisect(const AreaCell& cell) {
  const auto& c = cell.corner;
  if (!cell.is_straight()) return bisect_bent(cell);
  if (cell.corners == 3) {
    int longest = 0;
    double length = 0;
    for (int k = 0; k < 3; ++k) {
      const double l = norm(c[static_cast<std::size_t>((k + 1) % 3)] - c[static_cast<std::size_t>(k)]);
      if (l > length) {
        length = l;
        longest = k;
      }
    }
    const Vec3 &a = c[static_cast<std::size_t>(longest)], &b = c[static_cast<std::size_t>((longest + 1) % 3)],
               &apex = c[static_cast<std::size_t>((longest + 2) % 3)];
    const Vec3 m = middle(a, b);
    return {{{a, m, apex, a}, 3}, {{m, b, apex, m}, 3}};
  }
  const bool along_first = norm(c[1] - c[0]) + norm(c[2] - c[3]) > norm(c[2] - c[1]) + norm(c[3] - c[0]);
  const std::size_t s = along_first ? 0 : 1;
  const Vec3 &a = c[s], &b = c[s + 1], &p = c[(s + 2) % 4], &q = c[(s + 3) % 4];
  const Vec3 m = middle(a, b), n = middle(p, q);
  return {{{a, m, n, q}, 4}, {{m, b, p, n}, 4}};
}

void gauss_points(const AreaCell& cell, int order, std::vector<WeightedPoint>& points) {
  points.clear();
  const Rule& rule = rule_of(order);
  const Vec3 normal = cell.is_straight() ? Vec3{} : vector_area(cell);
  for (std::size_t i = 0; i < rule.node.size(); ++i) {
    const SidePoint from = first_side(cell, rule.node[i]), to = opposite_side(cell, rule.node[i]);
    const Vec3 across = to.at - from.at, change = to.along - from.along;
    for (std::size_t j = 0; j < rule.node.size(); ++j) {
      const double t = rule.node[j];
      const Vec3 along = from.along + t * change, area = cross(along, across);
      const double size = dot(area, normal) < 0 ? -norm(area) : norm(area);
      points.push_back({from.at + t * across, rule.weight[i] * rule.weight[j] * size});
    }
  }
}

Truncation truncation_of(std::span<const double> weighted, int order) {
  const Rule& rule = rule_of(order);
  const auto n = static_cast<std::size_t>(order);
  // c_kl = Σ_ij P_k(i) P_l(j) weighted_ij, where c_00 is the integral.
  std::array<double, kHighestOrder * kHighestOrder> half{};
  std::array<double, kHighestOrder> ring{};
  for (std::size_t k = 0; k < n; ++k) {
    for (std::size_t j = 0; j < n; ++j) {
      for (std::size_t i = 0; i < n; ++i) half[k * n + j] += rule.legendre[k * n + i] * weighted[i * n + j];
    }
  }
  double size = 0;
  for (std::size_t k = 0; k < n; ++k) {
    for (std::size_t l = 0; l < n; ++l) {
      double c = 0;
      for (std::size_t j = 0; j < n; ++j) c += rule.legendre[l * n + j] * half[k * n + j];
      const std::size_t r = std::max(k, l);
      ring[r] = std::max(ring[r], std::fabs(c));
      size = std::max(size, ring[r]);
    }
  }
  if (size == 0) return {};
  const double tiny = 1e-17 * size;
  const auto at = [&](std::size_t k) { return std::max(ring[k], tiny); };
  const auto rate = [](double from, double to, std::size_t steps) {
    return std::pow(std::min(1.0, to / from), 1 / static_cast<double>(steps));
  };
  // Rings of even or of odd order vanish by symmetry, others by chance: what the last but one and the one before let
  // expect of the last counts, too.
  double last = at(n - 1);
  for (std::size_t back = 1; back <= 2 && back + 1 < n; ++back) {
    const std::size_t k = n - 1 - back;
    last = std::max(last, at(k) * std::pow(rate(size, at(k), k), static_cast<double>(back)));
  }
  // The fall on the whole and that at the end: the slower one counts.
  double fall = rate(size, last, n - 1);
  if (n > 4) fall = std::max(fall, rate(std::max(at(n - 4), at(n - 3)), last, 3));
  const double trust = std::clamp((0.6 - fall) / 0.3, 0.0, 1.0);
  const auto behind = [&](double orders) { return last * std::pow(fall, 1 + orders); };
  return {30 * behind(trust * static_cast<double>(n)), behind(static_cast<double>(n)), last, fall};
}

}  // namespace exitance
