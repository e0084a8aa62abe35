#include "src/stress/pair_question.h"

#include <cmath>

#include "src/form_factor/pair_form_factor.h"
#include "src/stress/pair_oracle.h"

namespace exitance {
namespace {

constexpr double kTolerance = 1e-4;
constexpr std::uint64_t kPoints = 5'000;  // what needs more keeps its error

Verdict judge(const Opinion& opinion, const PairOracleAnswer& truth, long double error, long double reverse_error) {
  const long double apart = std::fabs(opinion.F - truth.F), back = std::fabs(opinion.F_reverse - truth.F_reverse);
  const bool is_within = apart <= opinion.margin + error && back <= opinion.reverse_margin + reverse_error;
  return verdict_of(!is_within, apart <= error ? 0 : apart - error, truth.F);
}

/// As integrated in full, or as sampled where that gives no reason to ask further: a value that is off by more than
/// chance allows does, even where it is within what samples may miss.
Verdict judge(const Opinion& opinion, const Question& question, const PairOracleAnswer& sampled) {
  constexpr long double kChance = 6;  // standard errors of eight shifts: beyond them once in some thousand times
  const Verdict first =
      judge(opinion, sampled, kChance * sampled.standard_error, kChance * sampled.reverse_standard_error);
  if (!first.is_wrong) return first;
  const PairOracleAnswer truth = oracle_pair_form_factors(question, Care::full);
  return judge(opinion, truth, truth.error, truth.reverse_error);
}

}  // namespace

Opinion ask_pair(const Question& question, bool both_ways) {
  const AreaScene scene(question);
  const ExchangeScene exchange(scene.soup);
  PairOptions options;
  options.tolerance = kTolerance;
  options.points = kPoints;
  options.both_ways = both_ways;
  const PairFormFactor f = PairIntegrator(exchange).form_factor(0, 1, options);
  Opinion opinion;
  opinion.F = f.F;
  opinion.margin = f.F_error;
  opinion.F_reverse = f.F_reverse;
  opinion.reverse_margin = f.F_reverse_error;
  opinion.visibility = f.kind == PairClass::facing_away ? Visibility::away
                       : f.kind == PairClass::open      ? Visibility::open
                       : f.kind == PairClass::blocked   ? Visibility::blocked
                                                        : Visibility::partial;
  return opinion;
}

Truth pair_truth(const Question& question) {
  const PairOracleAnswer truth = oracle_pair_form_factors(question, Care::sampled);
  Question free = question;
  free.occluders.clear();
  const PairOracleAnswer open = oracle_pair_form_factors(free, Care::sampled);
  const Truth::Seen seen = truth.F <= truth.error                         ? Truth::Seen::none
                           : open.F - truth.F <= open.error + truth.error ? Truth::Seen::all
                                                                          : Truth::Seen::some;
  return {seen, static_cast<double>(truth.F),
          [question, truth](const Opinion& opinion) { return judge(opinion, question, truth); }};
}

}  // namespace exitance
