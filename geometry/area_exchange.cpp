#include "geometry/area_exchange.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "geometry/gauss_rule.h"

namespace exitance {
namespace {

constexpr int kHighest = 12;
constexpr std::size_t kMostPoints = 6000, kMostCells = 600;

/// A convex quadrilateral, or a triangle with a double last corner.
template <class Real>
struct Cell {
  std::array<Vec<Real>, 4> corner;
  std::array<double, 3> jacobian{};  ///< of the bilinear map from the square, at (0, 0), (1, 0) and (0, 1)

  double area() const { return 0.5 * (jacobian[1] + jacobian[2]); }
  std::pair<Cell, Cell> halves(bool across_s) const {
    const auto middle = [](const Vec<Real>& p, const Vec<Real>& q) { return Real(0.5) * (p + q); };
    const auto& [a, b, c, d] = corner;
    const double j11 = jacobian[1] + jacobian[2] - jacobian[0];
    const auto mean = [](double x, double y) { return 0.25 * (x + y); };  // each half has half the map
    const auto& j = jacobian;
    if (across_s) {
      const Vec<Real> m = middle(a, b), n = middle(d, c);
      return {{{a, m, n, d}, {0.5 * j[0], mean(j[0], j[1]), 0.5 * j[2]}},
              {{m, b, c, n}, {mean(j[0], j[1]), 0.5 * j[1], mean(j[2], j11)}}};
    }
    const Vec<Real> m = middle(b, c), n = middle(a, d);
    return {{{a, b, m, n}, {0.5 * j[0], 0.5 * j[1], mean(j[0], j[2])}},
            {{n, m, c, d}, {mean(j[0], j[2]), mean(j[1], j11), 0.5 * j[2]}}};
  }
};

template <class Real>
struct SourceEdge {
  Vec<Real> from, edge;
  double length = 0;
  bool in_plane = false;  ///< of the receiver
};

template <class Real>
double length_of(const Vec<Real>& v) {
  return static_cast<double>(norm(v));
}

template <class Real>
struct Question {
  Vec<Real> normal;
  boost::container::small_vector<Cell<Real>, 64> cells;
  boost::container::small_vector<SourceEdge<Real>, 8> source;
  double area = 0, displacement = 0, relative_error = 0x1p-46;  // of the area
};

/// Corners of a part, relative to an origin, and the sum of their displacements.
template <class Real>
boost::container::small_vector<Vec<Real>, 8> corners_of(const RadiatorFacet& facet, const ClippedLoop& loop,
                                                        const RadiatorFacet& plane, const Vec3& origin,
                                                        double& displacement) {
  boost::container::small_vector<Vec<Real>, 8> points;
  for (const ClippedCorner& c : loop) {
    double moved = 0;
    points.push_back(position<Real>(facet, c, plane.plane(), origin, moved));
    displacement = std::max(displacement, moved);
  }
  return points;
}

template <class Real>
Question<Real> question(const RadiatorFacet& receiver, const ClippedLoop& receiving, const RadiatorFacet& source,
                        const ClippedLoop& sending) {
  const double u = static_cast<double>(std::numeric_limits<Real>::epsilon());
  const Vec3& origin = receiver.loop[receiving.front().from];
  Question<Real> q;
  const auto points = corners_of<Real>(receiver, receiving, source, origin, q.displacement);
  const auto others = corners_of<Real>(source, sending, receiver, origin, q.displacement);

  if constexpr (std::is_same_v<Real, double>) {
    q.normal = {receiver.normal.x, receiver.normal.y, receiver.normal.z};
  } else {  // a needle's normal needs digits that its edges' cross product loses
    const PlanePoints plane = receiver.plane();
    Vec<Extended> n = cross(difference<Extended>(*plane.b, *plane.a), difference<Extended>(*plane.c, *plane.a));
    n = Extended(1 / norm(n)) * n;
    q.normal = {static_cast<Real>(n.x), static_cast<Real>(n.y), static_cast<Real>(n.z)};
  }

  double extent = 0;
  bool clipped = false;
  for (const ClippedCorner& c : receiving) clipped = clipped || c.is_crossing();
  for (std::size_t k = 1; k + 1 < points.size(); k += 2) {
    const std::array<std::size_t, 4> index{0, k, k + 1, std::min(k + 2, points.size() - 1)};
    const auto twice = [&](std::size_t i, std::size_t j, std::size_t l) {
      const ClippedCorner &a = receiving[index[i]], &b = receiving[index[j]], &c = receiving[index[l]];
      if (a.is_crossing() || b.is_crossing() || c.is_crossing()) {
        return length_of(cross(points[index[j]] - points[index[i]], points[index[l]] - points[index[i]]));
      }
      return doubled_area(receiver.loop[a.from], receiver.loop[b.from], receiver.loop[c.from]);
    };
    const bool triangle = index[3] == index[2];
    const double j00 = twice(0, 1, triangle ? 2 : 3);
    const Cell<Real> cell{{points[index[0]], points[index[1]], points[index[2]], points[index[3]]},
                          {j00, triangle ? j00 : twice(0, 1, 2), triangle ? 0 : twice(0, 2, 3)}};
    for (const Vec<Real>& p : cell.corner) extent = std::max(extent, length_of(p));
    q.area += cell.area();
    q.cells.push_back(cell);
  }
  if (clipped) q.relative_error += 8 * q.displacement * extent / q.area;
  for (std::size_t k = 0; k < others.size(); ++k) {
    const Vec<Real>&p = others[k], &r = others[k + 1 < others.size() ? k + 1 : 0];
    const auto flat = [&](const Vec<Real>& v) {
      return std::fabs(static_cast<double>(dot(q.normal, v))) <= 8 * q.displacement + 8 * u * length_of(v);
    };
    const Vec<Real> e = r - p;
    const double length = length_of(e);
    if (length > 0) q.source.push_back({p, e, length, flat(p) && flat(r)});
  }
  return q;
}

/// A lower bound of how far a ball is from where the point form factor is not analytic: the source's outline, of edges
/// in the receiver's plane no more than their ends.
template <class Real>
double gap_around(const Question<Real>& q, const Vec<Real>& centre, double radius) {
  double gap = 1e300;
  for (const SourceEdge<Real>& e : q.source) {
    const Vec<Real> w = centre - e.from;
    const double along = static_cast<double>(dot(w, e.edge)) / (e.length * e.length);
    const double t = e.in_plane ? std::round(std::clamp(along, 0.0, 1.0)) : std::clamp(along, 0.0, 1.0);
    gap = std::min(gap, length_of(Vec<Real>(w - Real(t) * e.edge)));
  }
  return gap - radius;
}

/// Σ θ n·m, and the sum of the angles θ.
template <class Real>
Real lambert_sum(const Question<Real>& q, const Vec<Real>& x, Real& angles) {
  using std::atan2;
  Real sum(0);
  for (const SourceEdge<Real>& e : q.source) {
    const Vec<Real> p = e.from - x, m = cross(p, e.edge);
    const Real length = norm(m);
    if (!(length > 0)) continue;
    const Real angle = atan2(length, dot(p, p + e.edge));
    sum -= dot(q.normal, m) / length * angle;
    angles += angle;
  }
  return sum;
}

/// The lowest order whose error is below `relative`, a share of the cell's area. θ and n·m are of the order of 1 on the
/// ellipse; the Jacobian, linear, brings a power less.
int order_for(double half, double gap, double relative, double& error) {
  const double r = gap / half, decay = std::sqrt(1 + r * r) - r;
  double power = decay;
  for (int n = 1; n <= kHighest; ++n) {
    if (8 * power <= relative) {
      error += 8 * power;
      return n;
    }
    power *= decay * decay;
  }
  return kHighest + 1;
}

}  // namespace

template <class Real>
std::optional<Exchange> area_exchange(const FacetPair& pair, double tolerance) {
  const bool a_receives = pair.a->area <= pair.b->area;
  const RadiatorFacet &receiver = a_receives ? *pair.a : *pair.b, &source = a_receives ? *pair.b : *pair.a;
  Question<Real> q = a_receives ? question<Real>(receiver, pair.of_a, source, pair.of_b)
                                : question<Real>(receiver, pair.of_b, source, pair.of_a);
  if (q.cells.empty() || !(q.area > 0)) return std::nullopt;
  const double u = static_cast<double>(std::numeric_limits<Real>::epsilon()), relative = tolerance / q.area;
  Real sum(0);
  double error = 0;
  std::size_t points = 0, cells = 0;
  while (!q.cells.empty()) {
    const Cell<Real> cell = q.cells.back();
    q.cells.pop_back();
    if (++cells > kMostCells || points > kMostPoints) return std::nullopt;
    const auto& c = cell.corner;
    const double half_s = 0.5 * std::max(length_of(c[1] - c[0]), length_of(c[2] - c[3])),
                 half_t = 0.5 * std::max(length_of(c[2] - c[1]), length_of(c[3] - c[0]));
    const Vec<Real> centre = Real(0.25) * ((c[0] + c[1]) + (c[2] + c[3]));
    double radius = 0;
    for (const Vec<Real>& p : c) radius = std::max(radius, length_of(p - centre));
    const double gap = gap_around(q, centre, radius), area = cell.area();
    // What is too small to matter is taken as one point.
    const bool negligible = area <= 0.01 * tolerance;
    double truncation = 0;
    int order_s = 1, order_t = 1;
    if (!negligible) {
      order_s = gap > 0 ? order_for(half_s, gap, relative, truncation) : kHighest + 1;
      order_t = gap > 0 ? order_for(half_t, gap, relative, truncation) : kHighest + 1;
      if (order_s > kHighest || order_t > kHighest) {
        const auto [one, other] = cell.halves(half_s > half_t);
        q.cells.push_back(one);
        q.cells.push_back(other);
        continue;
      }
    } else {
      truncation = 1;
    }
    const GaussRule<double>&rule_s = gauss_rule<double>(order_s), &rule_t = gauss_rule<double>(order_t);
    Real value(0), angles(0);
    for (std::size_t i = 0; i < rule_s.node.size(); ++i) {
      const double s = 0.5 * (1 + rule_s.node[i]);
      const Vec<Real> low = c[0] + Real(s) * (c[1] - c[0]), high = c[3] + Real(s) * (c[2] - c[3]);
      for (std::size_t j = 0; j < rule_t.node.size(); ++j) {
        const double t = 0.5 * (1 + rule_t.node[j]);
        const double weight =
            0.25 * rule_s.weight[i] * rule_t.weight[j] *
            (cell.jacobian[0] + s * (cell.jacobian[1] - cell.jacobian[0]) + t * (cell.jacobian[2] - cell.jacobian[0]));
        Real seen(0);
        value += Real(weight) * lambert_sum(q, Vec<Real>(low + Real(t) * (high - low)), seen);
        angles += Real(weight) * seen;
        ++points;
      }
    }
    sum += value;
    const double near = std::max(gap, 0.1 * radius);
    // A normal in double carries 2^-49, 16 roundings of which 8 are others'.
    error += area * truncation + 16 * u * static_cast<double>(angles) + area * std::min(1.0, 4 * q.displacement / near);
  }
  Exchange result;
  result.integral = static_cast<double>(sum) / (2 * std::numbers::pi);
  result.error = error / (2 * std::numbers::pi) + q.relative_error * std::fabs(result.integral);
  return result;
}

template std::optional<Exchange> area_exchange<double>(const FacetPair&, double);
template std::optional<Exchange> area_exchange<long double>(const FacetPair&, double);

}  // namespace exitance
