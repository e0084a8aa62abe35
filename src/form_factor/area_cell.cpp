#include "src/form_factor/area_cell.h"

#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <stdexcept>

#include "geometry/predicates.h"

namespace exitance {
namespace {

struct Rule {
  std::vector<double> node, weight;  ///< on [0, 1]
};

template <unsigned Order>
Rule make_rule() {
  using Gauss = boost::math::quadrature::gauss<double, Order>;
  Rule rule;
  const auto add = [&](double x, double w) {
    rule.node.push_back(0.5 * (1 + x));
    rule.weight.push_back(0.5 * w);
  };
  for (std::size_t k = 0; k < Gauss::abscissa().size(); ++k) {
    const double x = Gauss::abscissa()[k], w = Gauss::weights()[k];
    add(x, w);
    if (x != 0) add(-x, w);
  }
  return rule;
}

const Rule& rule_of(int order) {
  static const Rule three = make_rule<3>(), four = make_rule<4>(), six = make_rule<6>(), eight = make_rule<8>();
  switch (order) {
    case 3:
      return three;
    case 4:
      return four;
    case 6:
      return six;
    case 8:
      return eight;
    default:
      throw std::invalid_argument("gauss_points: order must be 3, 4, 6 or 8");
  }
}

/// Most and least of a plane's functional over a cell, less than rounding taken as zero.
struct Range {
  double below = 0, above = 0, rounding = 0;
};

Range range_of(const AreaCell& cell, const CutPlane& plane) {
  Range r;
  double size = 0;
  for (const Vec3& v : cell.loop()) {
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

}  // namespace

double AreaCell::area() const {
  const Vec3 a = cross(corner[1] - corner[0], corner[2] - corner[0]);
  return 0.5 * (corners == 3 ? norm(a) : norm(a) + norm(cross(corner[2] - corner[0], corner[3] - corner[0])));
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

bool crosses(const AreaCell& cell, const CutPlane& plane) {
  return crosses(range_of(cell, plane));
}

std::vector<AreaCell> cut(const AreaCell& cell, const CutPlane& plane) {
  const Range range = range_of(cell, plane);
  if (!crosses(range)) return {};
  std::vector<Vec3> above, below;
  const auto loop = cell.loop();
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
  const auto middle = [](const Vec3& a, const Vec3& b) { return a + 0.5 * (b - a); };
  const auto& c = cell.corner;
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
  const Vec3 &a = cell.corner[0], &b = cell.corner[1], &c = cell.corner[2],
             &d = cell.corners == 3 ? cell.corner[2] : cell.corner[3];
  const Vec3 ab = b - a, ad = d - a, bow = (c - b) - ad;
  for (std::size_t i = 0; i < rule.node.size(); ++i) {
    for (std::size_t j = 0; j < rule.node.size(); ++j) {
      const double s = rule.node[i], t = rule.node[j];
      const Vec3 along_s = ab + t * bow, along_t = ad + s * bow;
      points.push_back({a + s * ab + t * along_t, rule.weight[i] * rule.weight[j] * norm(cross(along_s, along_t))});
    }
  }
}

}  // namespace exitance
