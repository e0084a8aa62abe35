#include "src/solve/shoot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <string>

#include "src/solve/error_bound.h"
#include "src/solve/gather.h"
#include "tests/output/damage.h"
#include "tests/solve/random_enclosure.h"

namespace exitance {
namespace {

// A system whose patches have several elements with different rows; the truth is that of the averaged rows.
struct Cut {
  Discretisation discretisation;
  FormFactorMatrix element_rows;
};

Cut cut(const RadiositySystem& system, std::uint64_t seed) {
  RandomNumbers random(seed);
  Cut result;
  Discretisation& d = result.discretisation;
  d.bands = system.bands;
  d.rho = system.rho;
  d.E = system.E;
  const std::size_t n = system.patches();
  std::vector<double> rows;
  for (std::size_t p = 0; p < n; ++p) {
    const auto count = static_cast<std::uint32_t>(1 + random.below(4));
    for (std::uint32_t e = 0; e < count; ++e) {
      d.element_area.push_back(0.1 + random.below(1));
      std::vector<double> row(n);
      double sum = 0;
      for (std::size_t k = 0; k < system.F.row(p).size(); ++k) {
        const double value = system.F.row(p)[k] * random.below(1);
        row[system.F.row_columns(p)[k]] = value;
        sum += value;
      }
      for (double& value : row) value *= 0.98 / sum;
      rows.insert(rows.end(), row.begin(), row.end());
    }
    d.element_first.push_back(d.element_first.back() + count);
  }
  result.element_rows = dense_matrix(n, rows);
  return result;
}

TEST(Shoot, ReachesTheTruthWithinItsBound) {
  for (const double max_rho : {0.3, 0.9, 0.99}) {
    for (const std::uint32_t bands : {1u, 3u}) {
      const RadiositySystem system = random_enclosure(25, bands, max_rho, 1.0, 7);
      const std::vector<Precise> truth = true_solution(system);
      const FormFactorMatrix columns = transpose(system.F);
      for (const double tolerance : {1e-3, 1e-8, 1e-12}) {
        ShootOptions options;
        options.tolerance = tolerance;
        const ShootSolution solution = shoot(one_element_each(system), column_of(columns), options);
        EXPECT_TRUE(solution.patches.converged);
        EXPECT_LE(solution.patches.error_bound, tolerance);
        EXPECT_LE(true_error(system, solution.patches.B, truth), solution.patches.error_bound);
      }
    }
  }
}

TEST(Shoot, AgreesWithGatherOnPatchesCutIntoElements) {
  const Cut scene = cut(random_enclosure(40, 3, 0.8, 1.0, 21), 5);
  const Discretisation& d = scene.discretisation;
  const FormFactorMatrix columns = transpose(scene.element_rows);
  const RadiositySystem system = make_system(d, scene.element_rows);
  const Solution gathered = gather(system);
  const ShootSolution shot = shoot(d, column_of(columns));
  ASSERT_TRUE(gathered.converged && shot.patches.converged);
  const std::vector<double> element_H = irradiance(scene.element_rows, gathered.B, d.bands);
  const std::vector<double> element_B = element_exitance(d, element_H);
  const double max_B = *std::max_element(gathered.B.begin(), gathered.B.end());
  const double both = (gathered.error_bound + shot.patches.error_bound) * max_B;
  for (std::size_t i = 0; i < gathered.B.size(); ++i) EXPECT_NEAR(gathered.B[i], shot.patches.B[i], both);
  for (std::size_t i = 0; i < gathered.H.size(); ++i) EXPECT_NEAR(gathered.H[i], shot.patches.H[i], both);
  ASSERT_EQ(shot.element_B.size(), element_B.size());
  for (std::size_t i = 0; i < element_B.size(); ++i) {
    EXPECT_NEAR(element_H[i], shot.element_H[i], both);
    EXPECT_NEAR(element_B[i], shot.element_B[i], both);
  }
  // A patch's B is the area mean of its elements'.
  for (std::size_t p = 0; p < d.patches(); ++p) {
    double power = 0, area = 0;
    for (std::size_t e = d.element_first[p]; e < d.element_first[p + 1]; ++e) {
      power += d.element_area[e] * shot.element_B[e * 3];
      area += d.element_area[e];
    }
    EXPECT_NEAR(shot.patches.B[p * 3], power / area, 1e-14 * max_B);
  }
}

TEST(Shoot, StrongestByLuminanceShootsFirst) {
  // Areas 1, 2, 1; luminances 10 · 0.2126, 4 · 0.7152 / 2, 100 · 0.0722: blue leads, then green by its area, then red.
  Discretisation d;
  d.element_first = {0, 1, 2, 3};
  d.element_area = {1, 2, 1};
  d.rho.assign(9, 0.0);
  d.E = {10, 0, 0, 0, 2, 0, 0, 0, 100};
  std::vector<std::size_t> order;
  shoot(d, [&](std::size_t patch, std::span<double>, std::span<double>) {
    order.push_back(patch);
    return true;
  });
  EXPECT_THAT(order, testing::ElementsAre(2, 1, 0));
}

TEST(Shoot, ShotLimitLeavesABoundThatHoldsAndTheExactResidual) {
  const RadiositySystem system = random_enclosure(25, 1, 0.9, 1.0, 4);
  const FormFactorMatrix columns = transpose(system.F);
  ShootOptions options;
  options.max_shots = 40;
  const ShootSolution solution = shoot(one_element_each(system), column_of(columns), options);
  EXPECT_EQ(solution.patches.iterations, 40u);
  EXPECT_FALSE(solution.patches.converged);
  EXPECT_LE(true_error(system, solution.patches.B, true_solution(system)), solution.patches.error_bound);
  // What was shot, B − unshot, misses the system by exactly what is unshot.
  std::vector<double> shot(solution.patches.B);
  for (std::size_t i = 0; i < shot.size(); ++i) shot[i] -= solution.unshot[i];
  const Residual r = residual(system, shot);
  for (std::size_t i = 0; i < shot.size(); ++i) EXPECT_NEAR(r.r[i], solution.unshot[i], 1e-12);
}

TEST(Shoot, UnreachableToleranceIsAdmittedWithABoundThatHolds) {
  RandomNumbers random(2);
  int vanished = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    const double F = random.below(1);
    const RadiositySystem system{1,
                                 {1, 1},
                                 {random.below(0.9), random.below(0.9)},
                                 {random.below(5), random.below(5)},
                                 dense_matrix(2, {0, F, F, 0})};
    const FormFactorMatrix columns = transpose(system.F);
    ShootOptions options;
    options.tolerance = 1e-18;
    const ShootSolution solution = shoot(one_element_each(system), column_of(columns), options);
    const double error = true_error(system, solution.patches.B, true_solution(system));
    EXPECT_FALSE(solution.patches.converged);
    EXPECT_LE(error, solution.patches.error_bound);
    EXPECT_LT(solution.patches.error_bound, 1e-13);
    if (error * (1 - *std::max_element(system.rho.begin(), system.rho.end())) > solution.patches.residual) ++vanished;
  }
  EXPECT_GT(vanished, 3);  // the unshot alone would have been no bound
}

TEST(Shoot, AColumnThatIsStoppedIsNotShot) {
  const RadiositySystem system = random_enclosure(10, 3, 0.9, 1.0, 5);
  const FormFactorMatrix columns = transpose(system.F);
  const Discretisation d = one_element_each(system);
  const ShootSolution three = shoot(d, column_of(columns), {.max_shots = 3});
  int asked = 0;
  const ShootSolution stopped = shoot(d, [&](std::size_t patch, std::span<double> F, std::span<double> F_error) {
    if (++asked <= 3) return column_of(columns)(patch, F, F_error);
    std::ranges::fill(F, 1.0);
    return false;
  });
  EXPECT_EQ(asked, 4);
  EXPECT_EQ(stopped.patches.iterations, 3u);
  EXPECT_FALSE(stopped.patches.converged);
  EXPECT_EQ(stopped.patches.B, three.patches.B);
  EXPECT_EQ(stopped.element_H, three.element_H);
  EXPECT_EQ(stopped.unshot, three.unshot);
}

void expect_same(const ShootSolution& a, const ShootSolution& b) {
  EXPECT_EQ(a.patches.B, b.patches.B);
  EXPECT_EQ(a.patches.H, b.patches.H);
  EXPECT_EQ(a.patches.iterations, b.patches.iterations);
  EXPECT_EQ(a.patches.error_bound, b.patches.error_bound);
  EXPECT_EQ(a.element_H, b.element_H);
  EXPECT_EQ(a.element_B, b.element_B);
  EXPECT_EQ(a.element_row_sum, b.element_row_sum);
  EXPECT_EQ(a.unshot, b.unshot);
  EXPECT_EQ(a.form_factor_error, b.form_factor_error);
}

TEST(Shoot, GoesOnFromWhatWasKeptWithTheSameBits) {
  Cut scene = cut(random_enclosure(25, 3, 0.8, 1.0, 21), 5);
  for (std::size_t b = 0; b < 3; ++b) scene.discretisation.rho[3 * 7 + b] = scene.discretisation.E[3 * 7 + b] = 0;
  std::ranges::fill(scene.element_rows.F_error, 1e-17);
  const Discretisation& d = scene.discretisation;
  const FormFactorMatrix columns = transpose(scene.element_rows);
  const ShootSolution whole = shoot(d, column_of(columns), {.all_columns = true});
  EXPECT_TRUE(whole.all_columns_known);
  const std::vector<double> sums = row_sums(scene.element_rows);
  for (std::size_t e = 0; e < sums.size(); ++e) EXPECT_NEAR(whole.element_row_sum[e], sums[e], 1e-14);

  const ScratchFolder folder;
  // Stopped between two shots: the state is kept then. Killed within one: what was kept some time ago is.
  for (const double save_seconds : {0.0, 1e9}) {
    std::uint64_t asked = 0;
    for (const std::uint64_t columns_before : {1, 5, 40}) {
      Checkpoint checkpoint(folder / "state", "key");
      std::uint64_t left = columns_before;
      const auto counted = [&](std::size_t patch, std::span<double> F, std::span<double> F_error) {
        ++asked;
        if (save_seconds == 0 && left == 0) throw std::domain_error("killed");
        --left;
        return column_of(columns)(patch, F, F_error);
      };
      const ShootOptions options{.stop = [&] { return save_seconds > 0 && left == 0; },
                                 .all_columns = true,
                                 .checkpoint = &checkpoint,
                                 .save_seconds = save_seconds};
      if (save_seconds == 0) {
        EXPECT_THROW(shoot(d, counted, options), std::domain_error);
        --asked;
      } else {
        EXPECT_FALSE(shoot(d, counted, options).patches.converged);
      }
    }
    Checkpoint checkpoint(folder / "state", "key");
    const auto counted = [&](std::size_t patch, std::span<double> F, std::span<double> F_error) {
      ++asked;
      return column_of(columns)(patch, F, F_error);
    };
    expect_same(shoot(d, counted, {.all_columns = true, .checkpoint = &checkpoint}), whole);
    EXPECT_EQ(asked, whole.patches.iterations + 1) << "no column twice for a shot, and that of the black patch";
    checkpoint.remove();
  }
}

TEST(Shoot, AStateThatIsOfNoUseIsForgotten) {
  const RadiositySystem system = random_enclosure(40, 1, 0.5, 1.0, 1), other = random_enclosure(11, 1, 0.5, 1.0, 1);
  const FormFactorMatrix columns = transpose(system.F), other_columns = transpose(other.F);
  const ShootSolution whole = shoot(one_element_each(system), column_of(columns));
  const ScratchFolder folder;
  std::filesystem::path part;
  {
    Checkpoint checkpoint(folder / "state", "key");
    shoot(one_element_each(other), column_of(other_columns), {.checkpoint = &checkpoint, .save_seconds = 0});
    expect_same(shoot(one_element_each(system), column_of(columns), {.checkpoint = &checkpoint, .save_seconds = 0}),
                whole);
    part = checkpoint.parts().at(0);
  }
  const std::string bytes = contents(part);
  std::size_t forgotten = 0, flips = 0;
  for (std::size_t at = 0; at < bytes.size(); at += 97) {
    create_directories(part.parent_path());
    put(part, flipped(bytes, at));
    Checkpoint checkpoint(folder / "state", "key", Checkpoint::OtherRun::forgotten);
    expect_same(shoot(one_element_each(system), column_of(columns), {.checkpoint = &checkpoint}), whole);
    forgotten += checkpoint.parts().empty();
    ++flips;
  }
  EXPECT_GT(forgotten, flips / 2);
}

TEST(Shoot, NothingEmitsNothingIsShot) {
  RadiositySystem system = random_enclosure(10, 3, 0.9, 1.0, 5);
  system.E.assign(system.E.size(), 0.0);
  const ShootSolution solution = shoot(one_element_each(system), [](auto, auto, auto) {
    ADD_FAILURE() << "there is nothing to shoot";
    return false;
  });
  EXPECT_THAT(solution.patches.B, testing::Each(0.0));
  EXPECT_THAT(solution.element_B, testing::Each(0.0));
  EXPECT_TRUE(solution.patches.converged);
  EXPECT_EQ(solution.patches.iterations, 0u);
  EXPECT_EQ(solution.patches.error_bound, 0);
}

TEST(Shoot, BlackPatchesReceiveOnce) {
  RadiositySystem system = random_enclosure(11, 1, 0.9, 1.0, 5);
  system.rho.assign(system.rho.size(), 0.0);
  const FormFactorMatrix columns = transpose(system.F);
  const ShootSolution solution = shoot(one_element_each(system), column_of(columns));
  EXPECT_EQ(solution.patches.B, system.E);
  EXPECT_EQ(solution.patches.iterations, 3u);  // patches 0, 5 and 10 emit
  const std::vector<double> H = irradiance(system.F, system.E, 1);
  for (std::size_t i = 0; i < H.size(); ++i) EXPECT_NEAR(solution.patches.H[i], H[i], 1e-13);
}

TEST(Shoot, FormFactorErrorsWidenTheBoundEnough) {
  const RadiositySystem truth = random_enclosure(20, 3, 0.9, 0.9, 13);
  RadiositySystem seen = truth;
  RandomNumbers random(99);
  for (std::size_t k = 0; k < seen.F.F.size(); ++k) {
    seen.F.F_error[k] = 1e-3 * seen.F.F[k];
    seen.F.F[k] += (2 * random.below(1) - 1) * seen.F.F_error[k];
  }
  const FormFactorMatrix columns = transpose(seen.F);
  const ShootSolution solution = shoot(one_element_each(seen), column_of(columns));
  const double error = true_error(truth, solution.patches.B, true_solution(truth));
  EXPECT_GT(error, solution.patches.error_bound);
  EXPECT_LE(error, solution.patches.error_bound + solution.form_factor_error);
  // The same figure as from the matrix.
  EXPECT_NEAR(solution.form_factor_error, form_factor_error(seen, solution.patches.B), 1e-9);
}

TEST(Shoot, ThreadsDoNotChangeABit) {
  const Cut scene = cut(random_enclosure(200, 3, 0.7, 1.0, 2), 6);
  const FormFactorMatrix columns = transpose(scene.element_rows);
  const auto with_threads = [&](std::size_t threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    return shoot(scene.discretisation, column_of(columns));
  };
  const ShootSolution one = with_threads(1), four = with_threads(4);
  EXPECT_EQ(one.patches.B, four.patches.B);
  EXPECT_EQ(one.element_H, four.element_H);
  EXPECT_EQ(one.unshot, four.unshot);
  EXPECT_EQ(one.patches.iterations, four.patches.iterations);
}

TEST(Shoot, ColumnsThatSumAboveOneAreRefused) {
  RadiositySystem system = random_enclosure(8, 1, 0.9, 1.0, 5);
  system.E.assign(system.E.size(), 1.0);
  for (double& F : system.F.F) F *= 1.01;
  const FormFactorMatrix columns = transpose(system.F);
  EXPECT_THROW(shoot(one_element_each(system), column_of(columns)), InvalidSystem);
}

TEST(Shoot, BadDiscretisationsAreRefusedByType) {
  const Discretisation good = one_element_each(random_enclosure(4, 1, 0.9, 1.0, 5));
  const auto refused = [&](auto&& spoil) {
    Discretisation bad = good;
    spoil(bad);
    EXPECT_THROW(shoot(bad, [](auto, auto, auto) { return true; }), InvalidSystem);
  };
  refused([](Discretisation& d) { d.element_first[1] = 2; });  // patch 1 has no element
  refused([](Discretisation& d) { d.element_area.pop_back(); });
  refused([](Discretisation& d) { d.element_area[2] = 0; });
  refused([](Discretisation& d) { d.rho[0] = 1; });
  refused([](Discretisation& d) { d.E.pop_back(); });
}

TEST(Shoot, ProgressRisesToOne) {
  const RadiositySystem system = random_enclosure(20, 3, 0.9, 1.0, 2);
  const FormFactorMatrix columns = transpose(system.F);
  std::vector<double> fractions;
  ShootOptions options;
  options.progress = [&](double fraction, std::string_view) { fractions.push_back(fraction); };
  shoot(one_element_each(system), column_of(columns), options);
  ASSERT_FALSE(fractions.empty());
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
  EXPECT_EQ(fractions.back(), 1);
}

TEST(AmbientEstimate, IsTheFurnaceOfTheUnshot) {
  // Everything the same everywhere: the estimate of E unshot is E / (1 − ρ), and B = E + ρ · ambient is the answer.
  Discretisation d;
  d.bands = 2;
  d.element_first = {0, 1, 3};
  d.element_area = {1, 2, 3};
  d.rho = {0.5, 0.8, 0.5, 0.8};
  d.E = {3, 1, 3, 1};
  EXPECT_THAT(ambient_estimate(d, d.E), testing::ElementsAre(testing::DoubleEq(6), testing::DoubleNear(5, 1e-14)));
}

}  // namespace
}  // namespace exitance
