#include "tests/geometry/exchange_oracle.h"

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>

#include <algorithm>
#include <array>
#include <boost/math/constants/constants.hpp>
#include <boost/math/quadrature/gauss.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <queue>
#include <sstream>
#include <string>
#include <type_traits>
#include <vector>

#include "geometry/facets.h"

namespace exitance {
namespace {

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using Rational = Kernel::FT;
using ExactPoint = Kernel::Point_3;
using ExactLoop = std::vector<ExactPoint>;
using Fine = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<50>, boost::multiprecision::et_off>;

template <class Real>
Real to_real(const Rational& value) {
  if constexpr (std::is_same_v<Real, long double>) {
    // Through 50 digits: a double would not do.
    return static_cast<long double>(to_real<Fine>(value));
  } else {
    std::ostringstream text;
    text << value.exact();
    const std::string digits = text.str();
    const auto slash = digits.find('/');
    using Wide = boost::multiprecision::cpp_int;
    const Wide over(digits.substr(0, slash)), under(slash == std::string::npos ? "1" : digits.substr(slash + 1));
    using Widest = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<200>>;
    return static_cast<Real>(Widest(over) / Widest(under));
  }
}

template <class Real>
struct Point {
  Real x, y, z;
  friend Point operator+(const Point& a, const Point& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Point operator-(const Point& a, const Point& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Point operator*(const Real& s, const Point& a) { return {s * a.x, s * a.y, s * a.z}; }
  friend Real dot(const Point& a, const Point& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
  friend Point cross(const Point& a, const Point& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  }
  friend Real norm(const Point& a) {
    using std::sqrt;
    return sqrt(dot(a, a));
  }
};

ExactLoop exact(const Loop& loop) {
  ExactLoop points;
  for (const Vec3& p : loop) points.emplace_back(p.x, p.y, p.z);
  return points;
}

ExactLoop clip(const ExactLoop& loop, const ExactLoop& plane) {
  Kernel::Vector_3 normal = CGAL::NULL_VECTOR;
  for (std::size_t i = 2; i < plane.size() && normal == CGAL::NULL_VECTOR; ++i) {
    normal = CGAL::cross_product(plane[1] - plane[0], plane[i] - plane[0]);
  }
  ExactLoop kept;
  bool in_front = false;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const ExactPoint &p = loop[i], &q = loop[(i + 1) % loop.size()];
    const Rational at_p = normal * (p - plane[0]), at_q = normal * (q - plane[0]);
    in_front = in_front || at_p > 0;
    if (at_p >= 0) kept.push_back(p);
    if ((at_p > 0 && at_q < 0) || (at_p < 0 && at_q > 0)) kept.push_back(p + (at_p / (at_p - at_q)) * (q - p));
  }
  return in_front ? kept : ExactLoop{};
}

/// Coordinates relative to an origin, so that nothing is lost to an offset.
template <class Real>
std::vector<Point<Real>> relative(const ExactLoop& loop, const ExactPoint& origin) {
  std::vector<Point<Real>> points;
  for (const ExactPoint& p : loop) {
    points.push_back(
        {to_real<Real>(p.x() - origin.x()), to_real<Real>(p.y() - origin.y()), to_real<Real>(p.z() - origin.z())});
  }
  return points;
}

/// Lambert's formula: what a point of a surface with unit normal n sees of a convex source in front of it.
template <class Real>
struct Lambert {
  std::vector<Point<Real>> source;
  Point<Real> n;

  Real seen_from(const Point<Real>& x) const {
    using std::atan2;
    Real sum(0);
    for (std::size_t k = 0; k < source.size(); ++k) {
      const Point<Real> p = source[k] - x, e = source[(k + 1) % source.size()] - source[k];
      const Point<Real> m = cross(p, e);
      const Real length = norm(m);
      if (length > 0) sum += dot(n, m) / length * atan2(length, dot(p, p + e));
    }
    return -sum / (2 * boost::math::constants::pi<Real>());
  }
};

/// Nodes of the double exponential rule on (0, 1), x and 1 − x both right to their last digit.
struct DoubleExponential {
  std::vector<long double> x, rest, weight;

  explicit DoubleExponential(long double step) {
    const long double pi = boost::math::constants::pi<long double>();
    for (long double t = -3.3L; t <= 3.3L; t += step) {
      const long double s = pi * std::sinh(t), up = 1 / (1 + std::exp(-s)), down = 1 / (1 + std::exp(s));
      x.push_back(up);
      rest.push_back(down);
      weight.push_back(step * pi * std::cosh(t) * up * down);
    }
  }
};

/// Over a convex loop, by triangles from its middle to pieces of its outline. Whatever touches the loop's plane from
/// the front touches its outline, as it is clipped by the source's plane, and there the rule is dense at every scale.
OracleExchange over_outline(const Lambert<long double>& lambert, const std::vector<Point<long double>>& loop) {
  using P = Point<long double>;
  P middle{0, 0, 0};
  for (const P& p : loop) middle = middle + (1.0L / static_cast<long double>(loop.size())) * p;
  static const DoubleExponential coarse(1 / 12.0L), fine(1 / 24.0L);
  OracleExchange result;
  const auto triangle = [&](const P& p, const P& q) {
    const long double doubled = norm(cross(p - middle, q - middle));
    const auto by = [&](const DoubleExponential& rule) {
      long double sum = 0;
      for (std::size_t j = 0; j < rule.x.size(); ++j) {
        const P base = rule.x[j] < rule.rest[j] ? p + rule.x[j] * (q - p) : q + rule.rest[j] * (p - q);
        long double column = 0;
        for (std::size_t i = 0; i < rule.x.size(); ++i) {
          column += rule.weight[i] * rule.rest[i] * lambert.seen_from(base + rule.x[i] * (middle - base));
        }
        sum += rule.weight[j] * column;
      }
      return doubled * sum;
    };
    const long double value = by(fine);
    result.integral += value;
    result.error += std::fabs(value - by(coarse));
  };
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const P &p = loop[k], &q = loop[(k + 1) % loop.size()];
    const long double square = dot(q - p, q - p);
    if (!(square > 0)) continue;
    std::vector<long double> cuts{0, 1};
    for (const P& v : lambert.source) {
      const long double t = dot(v - p, q - p) / square;
      if (1e-12L < t && t < 1 - 1e-12L) cuts.push_back(t);
    }
    std::sort(cuts.begin(), cuts.end());
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
      if (cuts[i] < cuts[i + 1]) triangle(p + cuts[i] * (q - p), p + cuts[i + 1] * (q - p));
    }
  }
  return result;
}

/// Over a convex loop, by adaptive bisection of triangles.
template <class Real>
class AreaIntegral {
 public:
  explicit AreaIntegral(Lambert<Real> lambert) : lambert_(std::move(lambert)) {}

  OracleExchange over(const std::vector<Point<Real>>& loop, double tolerance) {
    for (std::size_t k = 1; k + 1 < loop.size(); ++k) add({loop[0], loop[k], loop[k + 1]});
    constexpr std::size_t most = 60;
    for (std::size_t count = 0; count < most && !(error_ <= Real(tolerance) * sum_); ++count) {
      const Cell worst = cells_.top();
      cells_.pop();
      sum_ -= worst.value;
      error_ -= worst.error;
      // Halved across the longest side.
      std::array<Point<Real>, 3> c = worst.corner;
      std::size_t longest = 0;
      Real length(0);
      for (std::size_t i = 0; i < 3; ++i) {
        const Real l = norm(c[(i + 1) % 3] - c[i]);
        if (l > length) {
          length = l;
          longest = i;
        }
      }
      const Point<Real>&p = c[longest], &q = c[(longest + 1) % 3], &apex = c[(longest + 2) % 3];
      const Point<Real> middle = Real(0.5) * (p + q);
      add({p, middle, apex});
      add({middle, q, apex});
    }
    return {static_cast<long double>(sum_), static_cast<long double>(error_)};
  }

 private:
  struct Cell {
    std::array<Point<Real>, 3> corner;
    Real value, error;
    bool operator<(const Cell& other) const { return error < other.error; }
  };

  template <unsigned Order>
  Real rule(const std::array<Point<Real>, 3>& c) const {
    using Gauss = boost::math::quadrature::gauss<Real, Order>;
    const Point<Real> p = c[1] - c[0], q = c[2] - c[1];
    const Real doubled = norm(cross(p, q));
    const auto along = [](const auto& f) {
      Real sum(0);
      for (std::size_t i = 0; i < Gauss::abscissa().size(); ++i) {
        const Real x = Gauss::abscissa()[i] / 2, w = Gauss::weights()[i] / 2;
        sum += w * f(Real(0.5) + x);
        if (x != 0) sum += w * f(Real(0.5) - x);
      }
      return sum;
    };
    return doubled * along([&](const Real& s) {
             return s * along([&](const Real& t) { return lambert_.seen_from(c[0] + s * (p + t * q)); });
           });
  }

  void add(const std::array<Point<Real>, 3>& corner) {
    using std::fabs;
    const Real coarse = rule<10>(corner), fine = rule<15>(corner);
    const Cell cell{corner, fine, fabs(fine - coarse)};
    sum_ += cell.value;
    error_ += cell.error;
    cells_.push(cell);
  }

  Lambert<Real> lambert_;
  std::priority_queue<Cell> cells_;
  Real sum_{0}, error_{0};
};

template <class Real>
OracleExchange exchange(const Polygon& a, const Polygon& b, [[maybe_unused]] double tolerance = 0) {
  OracleExchange total;
  for (const Loop& f : cut_into_facets(a)) {
    for (const Loop& g : cut_into_facets(b)) {
      const ExactLoop of_f = exact(f), of_g = exact(g);
      const ExactLoop here = clip(of_f, of_g), there = clip(of_g, of_f);
      if (here.empty() || there.empty()) continue;
      const ExactPoint origin = here.front();
      const auto receiver = relative<Real>(here, origin), plane = relative<Real>(of_f, origin);
      Point<Real> normal{};
      for (std::size_t k = 1; k + 1 < plane.size(); ++k) {
        const Point<Real> n = cross(plane[k] - plane[0], plane[k + 1] - plane[0]);
        if (norm(n) > norm(normal)) normal = n;
      }
      normal = (1 / norm(normal)) * normal;
      const Lambert<Real> lambert{relative<Real>(there, origin), normal};
      OracleExchange part;
      if constexpr (std::is_same_v<Real, long double>) {
        part = over_outline(lambert, receiver);
      } else {
        part = AreaIntegral<Real>(lambert).over(receiver, tolerance);
      }
      total.integral += part.integral;
      total.error += part.error;
    }
  }
  return total;
}

}  // namespace

OracleExchange oracle_exchange(const Polygon& a, const Polygon& b) {
  return exchange<long double>(a, b);
}

OracleExchange fine_oracle_exchange(const Polygon& a, const Polygon& b, double tolerance) {
  return exchange<Fine>(a, b, tolerance);
}

}  // namespace exitance
