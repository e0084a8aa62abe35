#include "src/solve/error_bound.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "src/solve/gather.h"
#include "tests/solve/random_enclosure.h"

namespace exitance {
namespace {

TEST(ErrorBounds, HoldForAnyVectorWhatever) {
  RandomNumbers random(1);
  for (int trial = 0; trial < 20; ++trial) {
    const RadiositySystem system = random_enclosure(15, 2, 0.99, trial % 2 == 0 ? 1.0 : 0.5, 100 + trial);
    const std::vector<Precise> truth = true_solution(system);
    std::vector<double> B(system.E.size());
    for (std::size_t i = 0; i < B.size(); ++i) B[i] = static_cast<double>(truth[i]) * (1 + random.below(1e-13));
    const Residual r = residual(system, B);
    const std::vector<double> bounds = error_bounds(r.norm, r.rounding, contraction(system), r.max_B);
    EXPECT_LE(true_error(system, B, truth), *std::max_element(bounds.begin(), bounds.end()));
  }
}

TEST(ErrorBounds, CountTheRoundingOfAResidualThatVanishes) {
  // Solutions to the last bit: the computed residual is often exactly 0, the true error hardly ever.
  RandomNumbers random(2);
  int vanished = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const double F = random.below(1);
    const RadiositySystem system{1,
                                 {1, 1},
                                 {random.below(0.9), random.below(0.9)},
                                 {random.below(5), random.below(5)},
                                 dense_matrix(2, {0, F, F, 0})};
    GatherOptions options;
    options.tolerance = 1e-18;
    const Solution solution = gather(system, options);
    const double error = true_error(system, solution.B, true_solution(system));
    if (solution.residual == 0 && error > 0) ++vanished;
    EXPECT_LE(error, solution.error_bound);
    EXPECT_LT(solution.error_bound, 1e-13);
  }
  EXPECT_GT(vanished, 50);
}

TEST(ErrorBounds, AreAttainedByAConstantResidual) {
  // Rows that sum to 1 and one reflectance: a constant residual r leaves the constant error r / (1 − ρ).
  const RadiositySystem system{1, {1, 1}, {0.75, 0.75}, {1, 1}, dense_matrix(2, {0, 1, 1, 0})};
  const Residual r = residual(system, std::vector<double>{3.0, 3.0});
  EXPECT_EQ(r.norm[0], 0.25);
  EXPECT_NEAR(error_bounds(r.norm, r.rounding, contraction(system), r.max_B)[0], 1.0 / 3, 1e-13);
}

TEST(ErrorBounds, ZeroOverZeroIsZero) {
  const std::vector<double> zero{0}, one{1}, half{0.5};
  EXPECT_EQ(error_bounds(zero, zero, half, zero)[0], 0);
  EXPECT_EQ(error_bounds(one, zero, half, zero)[0], std::numeric_limits<double>::infinity());
}

TEST(FormFactorError, HoldsAgainstFiftyDigits) {
  for (int trial = 0; trial < 20; ++trial) {
    const RadiositySystem truth = random_enclosure(15, 3, 0.95, 0.99, 50 + trial);
    RadiositySystem seen = truth;
    RandomNumbers random(trial);
    for (std::size_t k = 0; k < seen.F.F.size(); ++k) {
      seen.F.F_error[k] = 1e-5 * random.below(1);
      seen.F.F[k] += (2 * random.below(1) - 1) * seen.F.F_error[k];
    }
    const Solution solution = gather(seen);
    const double bound = form_factor_error(seen, solution.B);
    const double error = true_error(truth, solution.B, true_solution(truth));
    EXPECT_LE(error, solution.error_bound + bound);
    EXPECT_GT(error, solution.error_bound);
  }
}

TEST(FormFactorError, IsAttainedWhenAllErrorsPointTheSameWay) {
  // Two patches that see a share F of each other: B = E / (1 − ρ F); dB/dF · δ = ρ B δ / (1 − ρ F), and the bound has
  // 1 − ρ for 1 − ρ F.
  RadiositySystem system{1, {1, 1}, {0.5, 0.5}, {1, 1}, dense_matrix(2, {0, 1, 1, 0})};
  system.F.F_error = {1e-6, 1e-6};
  EXPECT_NEAR(form_factor_error(system, std::vector<double>{2.0, 2.0}), 1e-6, 1e-18);
}

TEST(EnergyBalance, ClosesWithReciprocalFormFactorsOpenOrClosed) {
  for (const double closed : {1.0, 0.7}) {
    const RadiositySystem system = random_enclosure(60, 3, 0.9, closed, 17);
    const Solution solution = gather(system);
    const EnergyBalance balance =
        energy_balance(system.area, row_sums(system.F), system.rho, system.E, solution.B, solution.H, system.bands);
    ASSERT_EQ(balance.defect.size(), 3u);
    EXPECT_LT(balance.worst_defect, 1e-11);
    EXPECT_EQ(balance.worst_defect, *std::max_element(balance.defect.begin(), balance.defect.end()));
    for (std::size_t b = 0; b < 3; ++b) {
      EXPECT_GT(balance.emitted[b], 0);
      const double escaped = balance.escaped[b] / balance.emitted[b];
      EXPECT_TRUE(closed == 1 ? std::abs(escaped) < 1e-12 : escaped > 0.3) << escaped;
    }
  }
}

TEST(EnergyBalance, SeesFormFactorsThatAreNotReciprocal) {
  RadiositySystem system = random_enclosure(20, 1, 0.9, 0.7, 17);
  system.F.F[3] *= 1.1;
  const Solution solution = gather(system);
  EXPECT_GT(
      energy_balance(system.area, row_sums(system.F), system.rho, system.E, solution.B, solution.H, 1).worst_defect,
      1e-6);
}

TEST(EnergyBalance, OfNothingIsZero) {
  const std::vector<double> one{1.0}, zero{0.0};
  const EnergyBalance balance = energy_balance(one, zero, zero, zero, zero, zero, 1);
  EXPECT_EQ(balance.worst_defect, 0);
}

}  // namespace
}  // namespace exitance
