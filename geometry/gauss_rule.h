#pragma once
// Gauss–Legendre rules in any precision.

#include <boost/math/special_functions/legendre.hpp>
#include <limits>
#include <type_traits>
#include <vector>

namespace exitance {

/// Nodes and weights on [−1, 1].
template <class Real>
struct GaussRule {
  std::vector<Real> node, weight;
};

/// Orders come in steps, and end where more panels are cheaper.
template <class Real>
inline constexpr int kOrderStep = std::numeric_limits<Real>::digits > 64 ? 8 : 1;
template <class Real>
inline constexpr int kHighestOrder = std::numeric_limits<Real>::digits > 64 ? 48 : 20;

template <class Real>
GaussRule<Real> make_gauss_rule(int order) {
  // Weights lose a few digits to their formula.
  using Finer = std::conditional_t<std::is_same_v<Real, double>, long double, Real>;
  GaussRule<Real> rule;
  for (const Finer& x : boost::math::legendre_p_zeros<Finer>(order)) {
    const Finer slope = boost::math::legendre_p_prime(order, x);
    const Finer weight = 2 / ((1 - x * x) * slope * slope);
    rule.node.push_back(static_cast<Real>(x));
    rule.weight.push_back(static_cast<Real>(weight));
    if (x == 0) continue;
    rule.node.push_back(static_cast<Real>(-x));
    rule.weight.push_back(static_cast<Real>(weight));
  }
  return rule;
}

/// The rule of at least this many points, 1 to kHighestOrder. Made once; any thread may ask.
template <class Real>
const GaussRule<Real>& gauss_rule(int order) {
  static const std::vector<GaussRule<Real>> rules = [] {
    std::vector<GaussRule<Real>> made;
    for (int n = kOrderStep<Real>; n <= kHighestOrder<Real>; n += kOrderStep<Real>) {
      made.push_back(make_gauss_rule<Real>(n));
    }
    return made;
  }();
  return rules[static_cast<std::size_t>((order + kOrderStep<Real> - 1) / kOrderStep<Real> - 1)];
}

}  // namespace exitance
