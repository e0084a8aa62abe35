#include "src/form_factor/rule_decay.h"

#include <algorithm>
#include <cmath>

namespace exitance {
namespace {

constexpr double kFastest = 0.2;
/// Of a fall as slow as that nothing is taken to go on as it did; of one faster by 0.3, all.
constexpr double kSlow = 0.75;
/// How much the fall of a rule's own coefficients counts beside that of differences.
constexpr double kOfRule = 0.7;
/// A rule of order m errs by at least that share of its coefficients of order 2m, unless by chance.
constexpr double kOfCoefficients = 0.1;

}  // namespace

void RuleDecay::next(int order, double integral, const Truncation& own, double slowest) {
  // Nothing is expected of a first rule that is too low, nor of one that equals the one before it.
  if (expected_ == 0) expected_ = kOfCoefficients * own.last * std::pow(own.fall, std::max(0, 2 * order_ + 1 - order));
  const double difference = std::fabs(integral - integral_);
  double of_differences = integral > 0 ? std::pow(difference / integral, 0.5 / order_) : 1;
  if (difference_ > 0) of_differences = std::max(of_differences, std::pow(difference / difference_, 0.5 / step_));
  of_differences = std::clamp(of_differences, std::max(kFastest, slowest), 1.0);
  fall_ = std::max(of_differences, std::pow(own.fall, kOfRule) * std::pow(of_differences, 1 - kOfRule));
  const int step = order - order_;
  // A slow fall, as beside a corner, gets slower still.
  const double trust = std::clamp((kSlow - fall_) / 0.3, 0.0, 1.0);
  expected_ = std::max(difference, std::cbrt(difference * expected_ * expected_)) * std::pow(fall_, 2 * step * trust);
  order_ = order;
  step_ = step;
  integral_ = integral;
  difference_ = difference;
}

}  // namespace exitance
