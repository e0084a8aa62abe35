#include "src/solve/gather.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

#include "src/scene/input_error.h"
#include "src/solve/error_bound.h"
#include "tests/solve/random_enclosure.h"

namespace exitance {
namespace {

constexpr GatherMethod kMethods[] = {GatherMethod::jacobi, GatherMethod::gauss_seidel, GatherMethod::krylov,
                                     GatherMethod::direct};

GatherOptions by(GatherMethod method, double tolerance = 1e-12) {
  GatherOptions options;
  options.method = method;
  options.tolerance = tolerance;
  return options;
}

class EveryMethod : public testing::TestWithParam<GatherMethod> {};
INSTANTIATE_TEST_SUITE_P(Gather, EveryMethod, testing::ValuesIn(kMethods));

TEST_P(EveryMethod, FurnaceHasItsClosedForm) {
  // Six equal patches that see each other equally, everything else the same everywhere: B = E / (1 − ρ).
  for (const double rho : {0.0, 0.5, 0.9, 0.99}) {
    const std::size_t n = 6;
    std::vector<double> F(n * n, 0.2);
    for (std::size_t i = 0; i < n; ++i) F[i * n + i] = 0;
    const RadiositySystem system{1, std::vector<double>(n, 1.0), std::vector<double>(n, rho),
                                 std::vector<double>(n, 3.0), dense_matrix(n, F)};
    const Solution solution = gather(system, by(GetParam()));
    EXPECT_TRUE(solution.converged);
    for (const double B : solution.B) EXPECT_NEAR(B * (1 - rho) / 3, 1, 1e-12);
    for (const double H : solution.H) EXPECT_NEAR(H * (1 - rho) / 3, 1, 1e-12);
  }
}

TEST_P(EveryMethod, TwoPlatesHaveTheirClosedForm) {
  // B1 = E1 + ρ1 F B2, B2 = E2 + ρ2 F B1.
  const double F = 0.75, E1 = 2, E2 = 0.5, rho1 = 0.3, rho2 = 0.8;
  const RadiositySystem system{1, {1, 1}, {rho1, rho2}, {E1, E2}, dense_matrix(2, {0, F, F, 0})};
  const Solution solution = gather(system, by(GetParam()));
  const double determinant = 1 - rho1 * rho2 * F * F;
  EXPECT_NEAR(solution.B[0], (E1 + rho1 * F * E2) / determinant, 1e-12);
  EXPECT_NEAR(solution.B[1], (E2 + rho2 * F * E1) / determinant, 1e-12);
}

TEST_P(EveryMethod, ErrorBoundHoldsAgainstFiftyDigits) {
  for (const double max_rho : {0.3, 0.9, 0.99}) {
    for (const double closed : {1.0, 0.6}) {
      const RadiositySystem system = random_enclosure(40, 3, max_rho, closed, 7);
      const std::vector<Precise> truth = true_solution(system);
      for (const double tolerance : {1e-3, 1e-8, 1e-12}) {
        const Solution solution = gather(system, by(GetParam(), tolerance));
        EXPECT_TRUE(solution.converged);
        EXPECT_LE(solution.error_bound, tolerance);
        EXPECT_LE(true_error(system, solution.B, truth), solution.error_bound);
      }
    }
  }
}

TEST_P(EveryMethod, UnreachableToleranceIsAdmittedWithABoundThatHolds) {
  const RadiositySystem system = random_enclosure(30, 2, 0.99, 1.0, 3);
  const Solution solution = gather(system, by(GetParam(), 1e-17));
  EXPECT_FALSE(solution.converged);
  EXPECT_LT(solution.error_bound, 1e-12);
  EXPECT_LE(true_error(system, solution.B, true_solution(system)), solution.error_bound);
}

TEST_P(EveryMethod, ReturnedResidualIsTheTrueOne) {
  const RadiositySystem system = random_enclosure(25, 1, 0.8, 1.0, 11);
  const Solution solution = gather(system, by(GetParam(), 1e-5));
  Precise worst = 0, largest = 0;
  for (std::size_t p = 0; p < system.patches(); ++p) {
    Precise H = 0;
    for (std::size_t k = 0; k < system.F.row(p).size(); ++k) {
      H += Precise(system.F.row(p)[k]) * Precise(solution.B[system.F.row_columns(p)[k]]);
    }
    EXPECT_NEAR(static_cast<double>(H / Precise(solution.H[p])), 1, 2e-16);
    worst = std::max<Precise>(worst, abs(system.E[p] + system.rho[p] * H - solution.B[p]));
    largest = std::max<Precise>(largest, Precise(solution.B[p]));
  }
  EXPECT_NEAR(solution.residual, static_cast<double>(worst / largest), 1e-15);
}

TEST_P(EveryMethod, NothingEmitsNothingShines) {
  RadiositySystem system = random_enclosure(10, 3, 0.9, 1.0, 5);
  system.E.assign(system.E.size(), 0.0);
  const Solution solution = gather(system, by(GetParam()));
  EXPECT_THAT(solution.B, testing::Each(0.0));
  EXPECT_THAT(solution.H, testing::Each(0.0));
  EXPECT_EQ(solution.error_bound, 0);
  EXPECT_EQ(solution.residual, 0);
  EXPECT_TRUE(solution.converged);
}

TEST_P(EveryMethod, OneDarkBandDoesNotDisturbTheOthers) {
  RadiositySystem system = random_enclosure(20, 3, 0.9, 1.0, 5);
  for (std::size_t p = 0; p < system.patches(); ++p) system.E[p * 3 + 1] = 0;
  const Solution solution = gather(system, by(GetParam()));
  EXPECT_TRUE(solution.converged);
  EXPECT_LE(true_error(system, solution.B, true_solution(system)), 1e-12);
  for (std::size_t p = 0; p < system.patches(); ++p) EXPECT_EQ(solution.B[p * 3 + 1], 0);
}

TEST_P(EveryMethod, BlackPatchesKeepTheirEmission) {
  RadiositySystem system = random_enclosure(10, 2, 0.9, 1.0, 9);
  system.rho.assign(system.rho.size(), 0.0);
  EXPECT_EQ(gather(system, by(GetParam())).B, system.E);
}

TEST_P(EveryMethod, PatchesThatSeeNothingKeepTheirEmission) {
  const RadiositySystem system{1, {1, 1, 1}, {0.5, 0.5, 0.9}, {1, 0, 7}, dense_matrix(3, {0, 1, 0, 1, 0, 0, 0, 0, 0})};
  const Solution solution = gather(system, by(GetParam()));
  EXPECT_EQ(solution.B[2], 7);
  EXPECT_EQ(solution.H[2], 0);
  EXPECT_NEAR(solution.B[0], 4.0 / 3, 1e-12);
}

TEST_P(EveryMethod, ThreadsDoNotChangeABit) {
  const RadiositySystem system = random_enclosure(300, 3, 0.9, 1.0, 2);
  const auto with_threads = [&](std::size_t threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    return gather(system, by(GetParam()));
  };
  const Solution one = with_threads(1);
  for (const std::size_t threads : {2u, 4u}) {
    const Solution many = with_threads(threads);
    EXPECT_EQ(one.B, many.B);
    EXPECT_EQ(one.H, many.H);
    EXPECT_EQ(one.error_bound, many.error_bound);
    EXPECT_EQ(one.iterations, many.iterations);
  }
}

TEST_P(EveryMethod, ProgressRisesToOne) {
  const RadiositySystem system = random_enclosure(30, 3, 0.95, 1.0, 2);
  GatherOptions options = by(GetParam());
  std::vector<double> fractions;
  options.progress = [&](double fraction, std::string_view) { fractions.push_back(fraction); };
  gather(system, options);
  ASSERT_FALSE(fractions.empty());
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
  EXPECT_GE(fractions.front(), 0);
  EXPECT_EQ(fractions.back(), 1);
}

TEST_P(EveryMethod, NoPatchesAreNoProblem) {
  const RadiositySystem system{3, {}, {}, {}, {}};
  EXPECT_TRUE(gather(system, by(GetParam())).converged);
}

TEST(Gather, IterationLimitIsKeptAndAdmitted) {
  const RadiositySystem system = random_enclosure(30, 1, 0.99, 1.0, 2);
  for (const GatherMethod method : {GatherMethod::jacobi, GatherMethod::gauss_seidel, GatherMethod::krylov}) {
    GatherOptions options = by(method);
    options.max_iterations = 2;
    const Solution solution = gather(system, options);
    EXPECT_EQ(solution.iterations, 2u);
    EXPECT_FALSE(solution.converged);
    EXPECT_GT(solution.error_bound, 1e-12);
    EXPECT_LE(true_error(system, solution.B, true_solution(system)), solution.error_bound);
  }
}

TEST(Gather, KrylovNeedsFewerStepsNearReflectanceOne) {
  const RadiositySystem system = random_enclosure(200, 1, 0.99, 1.0, 2);
  RadiositySystem bright = system;
  bright.rho.assign(bright.rho.size(), 0.99);
  EXPECT_LT(gather(bright, by(GatherMethod::krylov)).iterations,
            gather(bright, by(GatherMethod::jacobi)).iterations / 20);
}

TEST(Gather, BadSystemsAreRefusedByType) {
  const RadiositySystem good = random_enclosure(5, 2, 0.9, 1.0, 1);
  const auto refused = [&](auto&& spoil) {
    RadiositySystem bad = good;
    spoil(bad);
    EXPECT_THROW(gather(bad), InvalidSystem);
  };
  refused([](RadiositySystem& s) { s.rho[3] = 1; });
  refused([](RadiositySystem& s) { s.rho[3] = -0.1; });
  refused([](RadiositySystem& s) { s.rho[3] = std::nan(""); });
  refused([](RadiositySystem& s) { s.E[3] = std::nan(""); });
  refused([](RadiositySystem& s) { s.E.pop_back(); });
  refused([](RadiositySystem& s) { s.area[0] = 0; });
  refused([](RadiositySystem& s) { s.bands = 0; });
  refused([](RadiositySystem& s) { s.F.F[0] = std::nan(""); });
  refused([](RadiositySystem& s) { s.F.F[0] = -0.1; });
  refused([](RadiositySystem& s) { s.F.F[0] += 0.01; });  // a row that sums to 1.01
  refused([](RadiositySystem& s) { s.F.column[0] = 17; });
  refused([](RadiositySystem& s) { s.F.columns = 4; });
  EXPECT_THROW(gather(good, by(GatherMethod::jacobi, 0)), std::invalid_argument);
  const std::vector<double> too_short(good.E.size() - 1, 1.0);
  EXPECT_THROW(gather(good, {.start = too_short}), std::invalid_argument);
  EXPECT_THROW(gather(random_enclosure(kDirectLimit + 1, 1, 0.5, 1.0, 1), by(GatherMethod::direct)), LimitError);
}

TEST(Gather, BeginsWithTheStartItIsGiven) {
  const RadiositySystem system = random_enclosure(40, 3, 0.8, 1.0, 5);
  for (const GatherMethod method : {GatherMethod::jacobi, GatherMethod::gauss_seidel, GatherMethod::krylov}) {
    const Solution first = gather(system, {.method = method, .tolerance = 1e-8});
    const Solution on = gather(system, {.method = method, .tolerance = 1e-8, .start = first.B});
    EXPECT_EQ(on.iterations, 0u);
    const Solution finer = gather(system, {.method = method, .start = first.B});
    EXPECT_LT(finer.iterations, gather(system, {.method = method}).iterations);
    EXPECT_LE(true_error(system, finer.B, true_solution(system)), finer.error_bound);
  }
}

TEST(Gather, RowsAboveOneWithinTheirErrorsAreSolvedWithAWiderBound) {
  RadiositySystem system = random_enclosure(20, 1, 0.9, 1.0, 1);
  for (std::size_t k = 0; k < system.F.F.size(); ++k) {
    system.F.F_error[k] = 0.05 * system.F.F[k];
    system.F.F[k] *= 1.04;
  }
  const Solution solution = gather(system);
  EXPECT_TRUE(solution.converged);
  EXPECT_LE(true_error(system, solution.B, true_solution(system)), solution.error_bound);
  // 0.99 · 1.04 > 1: the solution is unbounded as far as anybody can prove.
  system.rho[3] = 0.99;
  EXPECT_THROW(gather(system), InvalidSystem);
}

}  // namespace
}  // namespace exitance
