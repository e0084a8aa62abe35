#pragma once
// What the rules that a cell is measured with, one after the other, tell of the error of the last one.

#include "src/form_factor/area_cell.h"

namespace exitance {

/// An analytic integrand's Legendre coefficients fall as ρ^-k, and the Gauss rule of order n errs as its coefficients
/// of order 2n are large. So what two rules of orders m < n differ by is the error of the first, which reaches farther
/// than any coefficient that a rule finds itself, and the second errs less by the fall over 2 (n − m) orders more. How
/// fast coefficients fall is told by the difference as a share of the integral, and by that of this difference to the
/// one before, which is slower where the integrand has a pole close by. Coefficients that the rule itself finds tell
/// less of what comes far behind them, but see more of the integrand; so what counts is a fall between the two, not
/// faster than the differences' own, and not faster than 0.2 an order, because the first few may fall by chance. Two
/// rules may agree by chance, too: where the first was expected to err more than they differ by, that counts twice in
/// the geometric mean of both. Of a first rule too low to expect anything, and of one that equals the one before it,
/// the next one's coefficients tell: those of order 2m, which make the error a tenth of their size at least. The error
/// given is ten times what is expected. All of it is an extrapolation over 2 (n − m) orders: n should be no more than
/// 2m, of a first rule 3m.
class RuleDecay {
 public:
  RuleDecay() = default;
  /// A first rule; its error as it is expected to be from its own coefficients [as the integral], or 0: not known.
  RuleDecay(int order, double integral, double expected) : order_(order), integral_(integral), expected_(expected) {}

  /// The next one, of higher order. The integral is not negative. `own`: what its coefficients tell. `slowest`: a fall
  /// from one order to the next, 0 to 1, that is known beforehand.
  void next(int order, double integral, const Truncation& own, double slowest = 0);

  double error() const { return kSure * expected_; }  ///< of the last rule, after next(); 0 where both rules are equal
  double fall() const { return fall_; }               ///< at most 1: of coefficients, from one order to the next

 private:
  static constexpr double kSure = 10;

  int order_ = 0, step_ = 0;  ///< step_: from the order before
  double integral_ = 0, difference_ = 0, expected_ = 0, fall_ = 1;
};

}  // namespace exitance
