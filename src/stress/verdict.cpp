#include "src/stress/verdict.h"

#include <cmath>

namespace exitance {

Verdict verdict_of(bool is_wrong, long double error, long double true_F) {
  constexpr long double kLeast = 1e-15L;
  if (std::isnan(error)) error = INFINITY;
  return {is_wrong, static_cast<double>(error), true_F >= kLeast ? static_cast<double>(error / true_F) : 0};
}

Verdict judge(const Opinion& opinion, const OracleAnswer& truth) {
  const long double error = std::fabs(opinion.F - truth.F);
  Verdict verdict = verdict_of(!(error <= static_cast<long double>(opinion.margin)), error, truth.F);
  switch (opinion.visibility) {
    case Visibility::away:
      verdict.is_wrong = verdict.is_wrong || truth.F_open != 0;
      break;
    case Visibility::open:
      verdict.is_wrong = verdict.is_wrong || !truth.is_all_seen;
      break;
    case Visibility::blocked:
      verdict.is_wrong = verdict.is_wrong || truth.visible_area != 0;
      break;
    case Visibility::partial:
      break;
  }
  return verdict;
}

Verdict judge(const Opinion& opinion, const std::vector<Classes>& allowed) {
  Verdict verdict{opinion.classes.size() != allowed.size()};
  for (std::size_t k = 0; k < allowed.size() && !verdict.is_wrong; ++k) {
    verdict.is_wrong = (bits(opinion.classes[k]) & allowed[k]) == 0;
  }
  return verdict;
}

}  // namespace exitance
