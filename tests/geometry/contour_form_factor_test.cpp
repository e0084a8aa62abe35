#include "geometry/contour_form_factor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <boost/math/constants/constants.hpp>
#include <boost/math/quadrature/tanh_sinh.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <numbers>

#include "src/stress/placement.h"
#include "tests/form_factor/closed_forms.h"
#include "tests/geometry/exchange_oracle.h"

namespace exitance {
namespace {

using Pair = std::pair<Polygon, Polygon>;
using Fine = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<50>, boost::multiprecision::et_off>;

Polygon plate(const Vec3& o, const Vec3& u, const Vec3& v) {
  return {{o, o + u, o + u + v, o + v}, {}};
}
Polygon triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
  return {{a, b, c}, {}};
}
Polygon flipped(Polygon p) {
  std::reverse(p.outer.begin(), p.outer.end());
  return p;
}
Polygon scaled(Polygon p, double factor) {
  for (Vec3& v : p.outer) v = factor * v;
  for (auto& hole : p.holes) {
    for (Vec3& v : hole) v = factor * v;
  }
  return p;
}

/// What the requirement says: 1e-12 of F in absolute and 1e-10 in relative terms.
double required(const Exchange& e, double smaller_area) {
  const ExchangeTolerance t;
  return std::max(t.negligible * smaller_area, std::min(t.absolute * smaller_area, t.relative * e.integral));
}

/// Both ways round, and checks what must hold for any pair.
Exchange exchange(const Polygon& a, const Polygon& b) {
  const Radiator of_a(a), of_b(b);
  const Exchange there = unobstructed_exchange(of_a, of_b), back = unobstructed_exchange(of_b, of_a);
  EXPECT_LE(std::fabs(there.integral - back.integral), there.error + back.error);
  const double smaller = std::min(of_a.area(), of_b.area());
  EXPECT_LE(there.error, required(there, smaller));
  EXPECT_GE(there.integral, 0);
  EXPECT_LE(there.integral, smaller + there.error);
  return there;
}

void expect_truth(const Exchange& e, double truth, double truth_error) {
  EXPECT_LE(std::fabs(e.integral - truth), e.error + truth_error) << "is " << e.integral << " ± " << e.error;
}

// --- Published closed forms -----------------------------------------------------------------------------------------

/// Plates of width a and b that share an edge of length 1 at an angle (Feingold 1966; Howell's catalogue, C-16): the
/// integral A_1 F_12.
long double hinged_plates(long double a, long double b, long double angle) {
  using std::atan, std::cos, std::log, std::pow, std::sin, std::sqrt;
  const long double pi = std::numbers::pi_v<long double>, s = sin(angle), c = cos(angle), s2 = sin(2 * angle),
                    c2 = cos(2 * angle), A = a * a, B = b * b, C = A + B - 2 * a * b * c;
  const auto root = [&](long double z) { return sqrt(1 + z * z * s * s); };
  boost::math::quadrature::tanh_sinh<long double> rule;
  const long double rest = rule.integrate(
      [&](long double z) { return root(z) * (atan(z * c / root(z)) + atan((a - z * c) / root(z))); }, 0.0L, b, 1e-19L);
  return 1 / pi *
         (-s2 / 4 *
              (a * b * s + (pi / 2 - angle) * (A + B) + B * atan((a - b * c) / (b * s)) +
               A * atan((b - a * c) / (a * s))) +
          s * s / 4 *
              ((2 / (s * s) - 1) * log((1 + A) * (1 + B) / (1 + C)) + B * log(B * (1 + C) / (C * (1 + B))) +
               A * (log(A / C) + c2 * log((1 + A) / (1 + C)))) +
          b * atan(1 / b) + a * atan(1 / a) - sqrt(C) * atan(1 / sqrt(C)) +
          s * s2 / 2 * a * root(a) * (atan(a * c / root(a)) + atan((b - a * c) / root(a))) + c * rest);
}

/// Sum over the corners of two rectangles, 16 terms of alternating sign.
template <class Term>
double alternating_sum(const std::array<double, 2>& x, const std::array<double, 2>& y, const std::array<double, 2>& eta,
                       const std::array<double, 2>& xi, const Term& term) {
  Fine sum = 0;
  for (std::size_t i = 0; i < 2; ++i) {
    for (std::size_t j = 0; j < 2; ++j) {
      for (std::size_t k = 0; k < 2; ++k) {
        for (std::size_t l = 0; l < 2; ++l) {
          const Fine value = term(Fine(x[i]), Fine(y[j]), Fine(eta[k]), Fine(xi[l]));
          sum += (i + j + k + l) % 2 == 0 ? value : Fine(-value);
        }
      }
    }
  }
  return static_cast<double>(sum / (2 * boost::math::constants::pi<Fine>()));
}

/// A_1 F_12 of [x] × [y] in the plane z = 0 and [η] × [ξ] in the plane x = 0, in y and z (Ehlert and Smith 1993).
double perpendicular_rectangles(const std::array<double, 2>& x, const std::array<double, 2>& y,
                                const std::array<double, 2>& eta, const std::array<double, 2>& xi) {
  return alternating_sum(x, y, eta, xi, [](const Fine& a, const Fine& b, const Fine& c, const Fine& d) -> Fine {
    const Fine r = sqrt(a * a + d * d), s = b - c, square = r * r + s * s;
    const Fine first = r > 0 ? Fine(s * r * atan(s / r)) : Fine(0);
    return first - (square > 0 ? Fine((r * r - s * s) / 4 * log(square)) : Fine(0));
  });
}

/// A_1 F_12 of [x] × [y] in the plane z = 0 and [ξ] × [η] at height z (Ehlert and Smith 1993).
double parallel_rectangles(const std::array<double, 2>& x, const std::array<double, 2>& y,
                           const std::array<double, 2>& eta, const std::array<double, 2>& xi, double z) {
  return alternating_sum(x, y, eta, xi, [&](const Fine& a, const Fine& b, const Fine& c, const Fine& d) -> Fine {
    const Fine p = a - d, q = b - c, h = z, u = sqrt(p * p + h * h), v = sqrt(q * q + h * h);
    return q * u * atan(q / u) + p * v * atan(p / v) - h * h / 2 * log(p * p + q * q + h * h);
  });
}

/// Rectangles anywhere: overlapping, beside each other, with gaps down to 1e-12, sides down to 1e-4, tiny and far. The
/// error figure must hold.
TEST(UnobstructedExchange, PerpendicularAndParallelRectanglesAcrossGaps) {
  Random random("gaps");
  const auto range = [&](double start) {
    const double side = random.whole(0, 3) == 0 ? std::pow(10, random.real(-4, 0)) : random.real(0.1, 2);
    return std::array{start, start + side};
  };
  const auto gap = [&] { return random.whole(0, 4) == 0 ? 0 : std::pow(10, random.real(-12, 1)); };
  for (int k = 0; k < 1000; ++k) {
    const auto x = range(gap()), y = range(random.real(-1, 1)), xi = range(gap());
    // Sides in line now and then, or meeting in a corner.
    const auto eta =
        range(random.whole(0, 2) == 0 ? y[static_cast<std::size_t>(random.whole(0, 1))] : random.real(-1, 1));
    const double z = std::max(1e-6, gap());
    const auto rectangle = [](const std::array<double, 2>& s, const std::array<double, 2>& t, const auto& place) {
      return Polygon{{place(s[0], t[0]), place(s[1], t[0]), place(s[1], t[1]), place(s[0], t[1])}, {}};
    };
    const Polygon floor = rectangle(x, y,
                                    [](double s, double t) {
                                      return Vec3{s, t, 0};
                                    }),
                  wall = rectangle(eta, xi,
                                   [](double s, double t) {
                                     return Vec3{0, s, t};
                                   }),
                  ceiling = flipped(rectangle(xi, eta, [&](double s, double t) {
                    return Vec3{s, t, z};
                  }));
    SCOPED_TRACE(k);
    const double beside = perpendicular_rectangles(x, y, eta, xi), above = parallel_rectangles(x, y, eta, xi, z);
    expect_truth(exchange(floor, wall), beside, 2e-16 * beside);
    expect_truth(exchange(floor, ceiling), above, 2e-16 * above);
  }
}

TEST(UnobstructedExchange, OppositeRectangles) {
  for (const Placement& place : placements("opposite")) {
    const double area = norm(cross(place.u, place.v)) * place.scale * place.scale;
    if (place.name.starts_with("tilted")) continue;  // shears
    for (const auto& [a, b, c] : {std::array{1.0, 1.0, 1.0}, {2.0, 1.0, 0.25}, {1.0, 3.0, 8.0}, {1.0, 1.0, 0x1p-10}}) {
      const Polygon floor = plate({0, 0, 0}, {a, 0, 0}, {0, b, 0}),
                    ceiling = flipped(plate({0, 0, c}, {a, 0, 0}, {0, b, 0}));
      const Exchange e = exchange(place(floor), place(ceiling));
      const double truth = a * b * opposite_rectangles(a, b, c) * area;
      // Rotated coordinates are rounded: to 1e-16 of their size, 1e6 far away.
      const double rounded = place.name.ends_with("far") ? 2e-9 : 5e-15;
      EXPECT_NEAR(e.integral / truth, 1, rounded / c + 1e-13) << place.name;
    }
  }
}

TEST(UnobstructedExchange, HingedPlatesAtAnyAngle) {
  for (const auto& [a, b] : {std::pair{1.0L, 1.0L}, {0.5L, 2.0L}}) {
    for (const double degrees : {1, 5, 30, 45, 60, 89, 91, 120, 150, 175, 179}) {
      const long double angle = degrees * std::numbers::pi_v<long double> / 180;
      const double x = static_cast<double>(a * std::cos(angle)), z = static_cast<double>(a * std::sin(angle));
      const Polygon floor = plate({0, 0, 0}, {static_cast<double>(b), 0, 0}, {0, 1, 0}),
                    flap = plate({0, 0, 0}, {0, 1, 0}, {x, 0, z});
      const Exchange e = exchange(floor, flap);
      const double truth = static_cast<double>(hinged_plates(a, b, angle));
      EXPECT_NEAR(e.integral, truth, 3e-16 + 1e-15 * truth + e.error) << degrees;
    }
  }
  EXPECT_NEAR(exchange(plate({0, 0, 0}, {1, 0, 0}, {0, 1, 0}), plate({0, 0, 0}, {0, 1, 0}, {0, 0, 1})).integral,
              kPerpendicularSquares, 1e-16);
}

/// Strips so long that their ends hardly count: crossed strings less uncrossed strings (Hottel 1954).
TEST(UnobstructedExchange, CrossedStringsOfLongStrips) {
  const double length = 1e4;
  const Exchange e = exchange(plate({0, 0, 0}, {1, 0, 0}, {0, length, 0}), plate({0, 0, 0}, {0, length, 0}, {0, 0, 1}));
  const double truth = 1 - std::sqrt(0.5);
  EXPECT_NEAR(e.integral / length, truth, 1 / length);
  EXPECT_LT(e.integral / length, truth);
}

// --- Against the oracle --------------------------------------------------------------------------------------------

Vec3 point(Random& random, double size = 1) {
  return {random.real(-size, size), random.real(-size, size), random.real(-size, size)};
}

/// Random pairs that touch in one way or another.
std::vector<std::pair<const char*, Pair (*)(Random&)>> families() {
  return {
      {"anywhere",
       [](Random& r) {
         return Pair{triangle(point(r), point(r), point(r)), triangle(point(r), point(r), point(r))};
       }},
      {"common edge",
       [](Random& r) {
         const Vec3 a = point(r), b = point(r);
         return Pair{triangle(a, b, point(r)), triangle(b, a, point(r))};
       }},
      {"common edge of quadrilaterals",
       [](Random& r) {
         const Vec3 a = point(r), u = point(r);
         return Pair{plate(a, u, point(r)), plate(a + u, -u, point(r))};
       }},
      {"common vertex",
       [](Random& r) {
         const Vec3 a = point(r);
         return Pair{triangle(a, point(r), point(r)), triangle(a, point(r), point(r))};
       }},
      {"T-junction, on a lattice",
       [](Random& r) {
         const Vec3 a{0, 0, 0}, b{4, 0, 0};
         const auto above = [&] { return Vec3{r.real(-1, 5), r.real(0.1, 3), r.real(0.1, 3)}; };
         return Pair{triangle(a, b, {r.real(-1, 5), r.real(1, 3), 0}), triangle({3, 0, 0}, {1, 0, 0}, above())};
       }},
      {"overlapping edges, on a lattice",
       [](Random& r) {
         const Vec3 p{r.real(-1, 5), r.real(1, 3), 0}, q{r.real(-1, 5), r.real(-1, 3), r.real(1, 3)};
         return Pair{triangle({0, 0, 0}, {4, 0, 0}, p), triangle({7, 0, 0}, {1, 0, 0}, q)};
       }},
      {"standing on the other",
       [](Random& r) {
         const Vec3 p{r.real(0.1, 0.9), r.real(0.1, 0.4), 0}, q{r.real(0.1, 0.9), r.real(0.5, 0.8), 0};
         return Pair{plate({0, 0, 0}, {1, 0, 0}, {0, 1, 0}),
                     triangle(p, q, {r.real(0, 1), r.real(0, 1), r.real(0.1, 1)})};
       }},
      {"tip on the other",
       [](Random& r) {
         const Vec3 p{r.real(0.1, 0.9), r.real(0.1, 0.9), 0};
         const auto above = [&] { return Vec3{r.real(0, 1), r.real(0, 1), r.real(0.1, 1)}; };
         return Pair{plate({0, 0, 0}, {1, 0, 0}, {0, 1, 0}), triangle(p, above(), above())};
       }},
      {"sliver",
       [](Random& r) {
         const Vec3 a = point(r), b = point(r), side = std::pow(10, r.real(-4, -1)) * point(r);
         return Pair{triangle(a, b, a + r.real(0, 1) * (b - a) + side), triangle(point(r), point(r), point(r))};
       }},
      {"sliver on an edge",
       [](Random& r) {
         const Vec3 a = point(r), b = point(r), side = std::pow(10, r.real(-4, -1)) * point(r);
         return Pair{triangle(a, b, a + r.real(0, 1) * (b - a) + side), triangle(b, a, point(r))};
       }},
      {"tiny near large",
       [](Random& r) {
         const double size = std::pow(10, r.real(-4, -1));
         return Pair{plate(point(r), size * point(r), size * point(r)), triangle(point(r), point(r), point(r))};
       }},
      {"far", [](Random& r) {
         const Vec3 o = point(r);
         return Pair{plate(point(r), point(r), point(r)), plate((r.real(3, 300) / norm(o)) * o, point(r), point(r))};
       }}};
}

/// The error figure must hold and be within what is required, in every case.
TEST(UnobstructedExchange, AgreesWithTheOracle) {
  for (const auto& [name, draw] : families()) {
    Random random(name);
    for (int made = 0; made < 4;) {
      const auto [a, b] = draw(random);
      const Exchange e = exchange(a, b);
      if (e.integral == 0) continue;
      ++made;
      OracleExchange truth = oracle_exchange(a, b);
      const OracleExchange other = oracle_exchange(b, a);
      if (other.error < truth.error) truth = other;
      const double smaller = std::min(Radiator(a).area(), Radiator(b).area());
      // Lambert's formula in long double is right to some 1e-18; slivers and what is far lose relative to that.
      const double rounding = 1e-18 * smaller + 1e-15 * e.integral;
      SCOPED_TRACE(std::string(name) + " " + std::to_string(made));
      expect_truth(e, static_cast<double>(truth.integral), static_cast<double>(truth.error) + rounding);
    }
  }
}

TEST(UnobstructedExchange, SmallValuesAgreeWithFiftyDigits) {
  for (const double size : {1e-3, 1e-6}) {
    const Polygon floor = plate({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    for (const Polygon& small : {flipped(plate({0.3, 0.4, 2}, {1, 0.5, 0}, {0, size, 0.25 * size})),
                                 flipped(plate({30, 40, 25}, {size, 0, 0}, {0, size, 0})),
                                 triangle({0.2, 1.1, 0.1}, {0.9, 1.2, 0.1 + 0.5 * size}, {0.6, 1.15, 0.1 + size})}) {
      const Exchange e = exchange(floor, small);
      const OracleExchange truth = fine_oracle_exchange(floor, small, 1e-14);
      ASSERT_LE(truth.error, 1e-13L * truth.integral);
      expect_truth(e, static_cast<double>(truth.integral), 2e-16 * e.integral + static_cast<double>(truth.error));
    }
  }
}

// --- Decisions -----------------------------------------------------------------------------------------------------

TEST(UnobstructedExchange, NothingWhereFrontsDoNotSeeEachOther) {
  const Polygon floor = plate({0, 0, 0}, {4, 0, 0}, {0, 4, 0});
  const std::vector<Polygon> others{
      plate({4, 0, 0}, {4, 0, 0}, {0, 4, 0}),            // beside, in one plane
      flipped(plate({4, 0, 0}, {4, 0, 0}, {0, 4, 0})),   // the same, turned over
      flipped(floor),                                    // the other side of a sheet
      floor,                                             // itself
      plate({1, 1, 0}, {1, 0, 0}, {0, 1, 0}),            // a rug
      plate({0, 0, 3}, {4, 0, 0}, {0, 4, 0}),            // above, facing away
      flipped(plate({0, 0, -3}, {4, 0, 0}, {0, 4, 0})),  // below
      plate({0, 0, 0}, {0, 0, 4}, {0, 4, 0}),            // a wall that shares the edge, seen from its back
      plate({0, 0, -4}, {0, 4, 0}, {0, 0, 4}),           // a wall that hangs from the edge
      triangle({1, 1, 3}, {2, 2, 3}, {3, 3, 3}),         // no area
  };
  for (const Placement& place : placements("nothing")) {
    // Rounding opens what touches.
    if (place.name.starts_with("rotated") || place.name == "tenth") continue;
    for (const Polygon& other : others) {
      const Exchange e = unobstructed_exchange(Radiator(place(floor)), Radiator(place(other)));
      EXPECT_EQ(e.integral, 0);
      EXPECT_EQ(e.error, 0);
    }
  }
}

TEST(UnobstructedExchange, NeighboursInARotatedWallExchangeNothing) {
  for (const Placement& place : placements("wall")) {
    const Polygon a = place(plate({0, 0, 0}, {1, 0, 0}, {0, 1, 0})), b = place(plate({1, 0, 0}, {1, 0, 0}, {0, 1, 0}));
    const Radiator of_a(a), of_b(b);
    const Exchange e = unobstructed_exchange(of_a, of_b);
    const double allowed = place.name.ends_with("far") ? 1e-9 : 1e-15;
    EXPECT_LE(e.integral + e.error, allowed * of_a.area()) << place.name;
  }
}

TEST(UnobstructedExchange, APowerOfTwoChangesNoDigit) {
  Random random("scale");
  for (int k = 0; k < 20; ++k) {
    const Vec3 a = point(random), b = point(random);
    const Polygon p = triangle(a, b, point(random)), q = triangle(b, a, point(random));
    const Exchange e = unobstructed_exchange(Radiator(p), Radiator(q));
    for (const int exponent : {-40, -1, 3, 40}) {
      const double f = std::ldexp(1.0, exponent);
      const Exchange s = unobstructed_exchange(Radiator(scaled(p, f)), Radiator(scaled(q, f)));
      EXPECT_EQ(s.integral, f * f * e.integral);
      EXPECT_EQ(s.error, f * f * e.error);
    }
  }
}

TEST(UnobstructedExchange, PiecesSumToTheWhole) {
  const Polygon ring{{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}}, {{{1, 1, 0}, {1, 3, 0}, {3, 3, 0}, {3, 1, 0}}}};
  const Polygon filling = plate({1, 1, 0}, {2, 0, 0}, {0, 2, 0}), whole = plate({0, 0, 0}, {4, 0, 0}, {0, 4, 0});
  const Polygon hook{{{0, 0, 0}, {0, 3, 0}, {0, 3, 4}, {0, 1, 4}, {0, 1, 1}, {0, 0, 1}}, {}},
      notch = plate({0, 0, 1}, {0, 1, 0}, {0, 0, 3}), wall = plate({0, 0, 0}, {0, 3, 0}, {0, 0, 4});
  for (const Placement& place : placements("pieces")) {
    if (place.name.ends_with("far")) continue;  // rounded to 1e-10 of their size
    const double area = place.scale * place.scale;
    for (const auto& [piece, rest, all, other] : {std::array{ring, filling, whole, wall}, {hook, notch, wall, whole}}) {
      const Exchange a = exchange(place(piece), place(other)), b = exchange(place(rest), place(other)),
                     c = exchange(place(all), place(other));
      const double rounded = place.name.starts_with("rotated") ? 1e-14 * area : 0;
      EXPECT_LE(std::fabs(a.integral + b.integral - c.integral), a.error + b.error + c.error + rounded) << place.name;
    }
  }
}

TEST(UnobstructedExchange, RowsOfConvexRoomsSumToOne) {
  for (const Placement& place : placements("rooms")) {
    if (place.name.ends_with("far")) continue;
    const auto corner = [&](int i) { return place({i & 1 ? 3.0 : 0, i & 2 ? 2.0 : 0, i & 4 ? 1.0 : 0}); };
    std::vector<Radiator> faces;
    for (const auto& f :
         {std::array{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}}) {
      faces.emplace_back(Polygon{{corner(f[0]), corner(f[1]), corner(f[2]), corner(f[3])}, {}});
    }
    for (const Radiator& a : faces) {
      double sum = 0;
      for (const Radiator& b : faces) sum += unobstructed_exchange(a, b).integral;
      EXPECT_NEAR(sum / a.area(), 1, 1e-12) << place.name;
    }
  }
}

}  // namespace
}  // namespace exitance
