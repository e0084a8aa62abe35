#include "src/solve/scene_solution.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

#include "src/form_factor/area_closure.h"
#include "src/form_factor/area_rows.h"
#include "src/form_factor/point_run.h"
#include "src/form_factor/sampled_area_rows.h"
#include "src/output/run_clock.h"
#include "src/scene/input_error.h"
#include "src/scene/scene_check.h"
#include "src/solve/error_bound.h"
#include "src/solve/shoot.h"
#include "src/visibility/exact_visibility.h"
#include "src/visibility/ray_sampled_visibility.h"

namespace exitance {
namespace {

// Means over the elements of each patch, weighted by area.
std::vector<double> patch_means(const Discretisation& d, std::span<const double> of_element) {
  std::vector<double> means(d.patches());
  for (std::size_t p = 0; p < means.size(); ++p) {
    double area = 0;
    for (std::size_t e = d.element_first[p]; e < d.element_first[p + 1]; ++e) {
      means[p] += d.element_area[e] * of_element[e];
      area += d.element_area[e];
    }
    means[p] /= area;
  }
  return means;
}

class SceneSolver {
 public:
  SceneSolver(const Scene& scene, const SolveOptions& options) : options_(options), result_(make_soup(scene)) {
    MeshOptions mesh = options.mesh;
    mesh.memory_limit = std::min(mesh.memory_limit, options.memory_limit);
    result_.mesh = make_patch_mesh(scene, result_.soup, mesh);
    if (result_.mesh.patches.empty())
      throw InputError(scene.name, 0, "no surface has an area; there is nothing to solve");
    result_.discretisation = discretise(scene, result_.mesh);
    check(result_.discretisation);
    result_.closed = is_closed(scene);
    result_.receivers = options.receivers;
    result_.rays = options.rays;
    if (options.rays) {
      visibility_ = std::make_unique<RaySampledVisibility>(result_.mesh, result_.soup, *options.rays);
    } else {
      visibility_ = std::make_unique<ExactVisibility>(result_.mesh, result_.soup);
    }
  }
  SceneSolver(const SceneSolver&) = delete;  // visibility_ refers to mesh and soup
  SceneSolver& operator=(const SceneSolver&) = delete;

  SceneSolution solve() && {
    if (options_.method == Method::gather) {
      refuse_too_large_a_matrix();
      gather_all();
    } else if (options_.receivers == Receivers::area) {
      refuse_too_large_a_matrix();
      shoot_with_matrix();
    } else if (!options_.max_shots && !options_.stop_is_a_limit && matrix_bytes_needed() <= options_.memory_limit) {
      shoot_with_matrix();
    } else {
      shoot_without_matrix();
    }
    measure_energy_balance();
    result_.may_go_on = result_.stopped && stopped();
    if (!stopped() && options_.receivers == Receivers::points) measure_reciprocity();
    return std::move(result_);
  }

 private:
  // What is held at the same time: rows of elements while they grow, then those and the patches' or their transpose.
  std::uint64_t matrix_bytes_needed() const {
    if (options_.receivers == Receivers::area) return pair_rows_bytes(result_.mesh.elements.size(), 1);
    const std::uint64_t elements = result_.mesh.elements.size(), patches = result_.mesh.patches.size();
    const auto needed = [&](double density) {
      const double rows = static_cast<double>(matrix_bytes(elements, patches, density));
      const double beside =
          options_.method == Method::gather ? static_cast<double>(matrix_bytes(patches, patches, density)) : rows;
      return static_cast<std::uint64_t>(std::min(2 * rows + beside, 0x1p63));
    };
    // Looking at some rows takes time that small scenes need not spend; rays keep what they ask for, seen or not.
    if (needed(1) <= options_.memory_limit || options_.rays) return needed(1);
    return needed(expected_row_length(*visibility_) / static_cast<double>(patches));
  }

  void refuse_too_large_a_matrix() const {
    const std::uint64_t needed = matrix_bytes_needed();
    if (needed <= options_.memory_limit) return;
    throw LimitError(
        fmt::format("the form factors of {} elements to {} patches would take about {:.3g} GiB of memory and {:.3g} "
                    "GiB may be used; "
                    "shooting at sample points (--method shoot --receivers points) needs no matrix",
                    result_.mesh.elements.size(), result_.mesh.patches.size(), static_cast<double>(needed) * 0x1p-30,
                    static_cast<double>(options_.memory_limit) * 0x1p-30));
  }

  /// Of the work that is named, though nothing may be kept of it: what is there of other work is forgotten. Null where
  /// none is asked for.
  Checkpoint* begin_checkpoint(const char* work) {
    if (options_.checkpoint.empty()) return nullptr;
    result_.checkpoint = std::make_shared<Checkpoint>(
        options_.checkpoint, fmt::format("{}work {}\n", options_.key, work), Checkpoint::OtherRun::forgotten);
    if (result_.checkpoint->has_forgotten() && options_.warn) options_.warn(result_.checkpoint->what_was_forgotten());
    return result_.checkpoint.get();
  }

  [[noreturn]] void refuse_unfinished_rows() const {
    throw LimitError(fmt::format("stopped before the form factors were complete; {}",
                                 result_.checkpoint == nullptr || result_.checkpoint->parts().empty()
                                     ? "nothing was saved"
                                     : fmt::format("finished rows are kept in {}, from where the same command goes on",
                                                   options_.checkpoint.string())));
  }

  bool stopped() const { return options_.stop && options_.stop(); }

  FormFactorMatrix area_rows_of_elements() {
    if (options_.rays) {
      begin_checkpoint("rows of areas by rays");
      const auto report = [&](double fraction, std::string_view label) {
        if (options_.progress) options_.progress(fraction, label);
        if (fraction < 1 && stopped()) refuse_unfinished_rows();
      };
      SampledAreaRows rows =
          sampled_area_rows(result_.mesh, result_.soup, ExchangeScene::Unit::element, *options_.rays, report);
      result_.statistics = rows.statistics;
      return std::move(rows.F);
    }
    PairRunOptions how;
    how.pairs.tolerance = options_.form_factor_tolerance;
    how.pairs.stop = options_.stop;
    how.block_seconds = options_.save_every;
    how.progress = options_.progress;
    AreaRows rows = area_rows(result_.mesh, result_.soup, how, options_.seed, begin_checkpoint("rows of areas"));
    const auto pairs = [&](PairClass kind) { return rows.pairs[static_cast<std::size_t>(kind)]; };
    result_.statistics.pairs = {pairs(PairClass::facing_away), pairs(PairClass::open), pairs(PairClass::blocked),
                                pairs(PairClass::partial)};
    if (rows.F.rows() > 0) {
      const AreaClosure closure = area_closure(result_.mesh, result_.soup, rows.F, result_.closed);
      result_.statistics.covered_points = closure.not_judged;
      result_.statistics.closure_max_defect = closure.max_defect;
      result_.closure_error = closure.largest_row_error;
    }
    result_.reciprocity_max_defect = rows.reciprocity_max_defect;
    result_.resumed_rows = rows.resumed;
    return std::move(rows.F);
  }

  FormFactorMatrix rows() {
    FormFactorMatrix F;
    if (options_.receivers == Receivers::area) {
      F = area_rows_of_elements();
      if (F.rows() == 0) refuse_unfinished_rows();
    } else {
      PointRun run = run_points(
          *visibility_, {.block_seconds = options_.save_every, .stop = options_.stop, .progress = options_.progress},
          begin_checkpoint("rows of points"));
      if (!run.complete) refuse_unfinished_rows();
      result_.statistics = run.rows.statistics;
      result_.resumed_rows = run.resumed;
      F = std::move(run.rows.F);
    }
    result_.measured_points = result_.mesh.elements.size();
    result_.element_row_sum = row_sums(F);
    result_.seconds_form_factors = stopwatch_.lap();
    return F;
  }

  void gather_all() {
    const Discretisation& d = result_.discretisation;
    const FormFactorMatrix element_rows = rows();
    const RadiositySystem system = make_system(d, element_rows);
    result_.patches = gather(system, {.method = options_.gather_method,
                                      .tolerance = options_.tolerance,
                                      .progress = options_.progress,
                                      .stop = options_.stop});
    result_.element_H = irradiance(element_rows, result_.patches.B, d.bands);
    result_.element_B = element_exitance(d, result_.element_H);
    result_.form_factor_error = form_factor_error(system, result_.patches.B);
    result_.stopped = !result_.patches.converged && stopped();
    all_columns_known_ = true;
    result_.seconds_solve = stopwatch_.lap();
  }

  void shoot_with_matrix() {
    const FormFactorMatrix columns = transpose(rows());
    shoot_all(column_of(columns), {});
    all_columns_known_ = true;
    result_.seconds_solve = stopwatch_.lap();
  }

  void shoot_without_matrix() {
    // What never shoots, because it is black, is needed for the energy that escapes.
    ShootSolution solution = shoot_all(
        [&](std::size_t patch, std::span<double> F, std::span<double> F_error) {
          return point_column(*visibility_, patch, F, F_error, options_.stop);
        },
        {.all_columns = true, .checkpoint = begin_checkpoint("shots"), .save_seconds = options_.save_every});
    result_.element_row_sum = std::move(solution.element_row_sum);
    all_columns_known_ = !result_.stopped && solution.all_columns_known;
    result_.stopped = !all_columns_known_;
    if (!stopped()) measure_sample();
    result_.seconds_solve = stopwatch_.lap();
  }

  /// Returns what it found of the rows; the solution itself is in the result.
  ShootSolution shoot_all(const ShootColumn& column, ShootOptions how) {
    how.tolerance = options_.tolerance;
    how.progress = options_.progress;
    how.stop = options_.stop;
    if (options_.max_shots) how.max_shots = *options_.max_shots;
    ShootSolution solution = shoot(result_.discretisation, column, how);
    result_.stopped = !solution.patches.converged && (solution.patches.iterations >= how.max_shots || stopped());
    if (result_.stopped) result_.ambient = ambient_estimate(result_.discretisation, solution.unshot);
    result_.patches = std::move(solution.patches);
    result_.element_H = std::move(solution.element_H);
    result_.element_B = std::move(solution.element_B);
    result_.form_factor_error = solution.form_factor_error;
    return solution;
  }

  // Whole rows of some elements, for what columns cannot tell.
  void measure_sample() {
    constexpr std::size_t kSample = 256;
    const std::size_t n = result_.mesh.elements.size(), count = std::min(n, kSample);
    std::vector<std::size_t> sample;
    for (std::size_t k = 0; k < count; ++k) sample.push_back(n * (2 * k + 1) / (2 * count));
    result_.statistics += point_row_statistics(*visibility_, sample);
    result_.measured_points = count;
  }

  void measure_energy_balance() {
    if (!all_columns_known_) return;
    const Discretisation& d = result_.discretisation;
    result_.energy_balance_defect = energy_balance(patch_areas(d), patch_means(d, result_.element_row_sum), d.rho, d.E,
                                                   result_.patches.B, result_.patches.H, d.bands)
                                        .worst_defect;
  }

  void measure_reciprocity() {
    constexpr int kPairs = 64, kDraws = 1024;
    std::mt19937_64 random(options_.seed);
    const std::size_t n = result_.mesh.patches.size();
    int pairs = 0;
    for (int draw = 0; draw < kDraws && pairs < kPairs; ++draw) {
      const std::size_t i = random() % n, j = random() % n;
      if (i == j) continue;
      const double A_i = result_.mesh.patches[i].area, A_j = result_.mesh.patches[j].area;
      const double F_ij = patch_form_factor(*visibility_, i, j).F;
      const double F_ji = patch_form_factor(*visibility_, j, i).F;
      if (F_ij == 0 && F_ji == 0) continue;
      ++pairs;
      const double defect = std::fabs(A_i * F_ij - A_j * F_ji) / std::min(A_i, A_j);
      result_.reciprocity_max_defect = std::max(result_.reciprocity_max_defect.value_or(0), defect);
    }
  }

  const SolveOptions& options_;
  RunClock stopwatch_;
  SceneSolution result_;
  std::unique_ptr<MeshVisibility> visibility_;
  bool all_columns_known_ = false;
};

}  // namespace

Discretisation discretise(const Scene& scene, const PatchMesh& mesh) {
  Discretisation d;
  d.bands = scene.bands;
  for (const Patch& patch : mesh.patches) {
    d.element_first.push_back(patch.element_first + patch.element_count);
    const Material& material = scene.materials[scene.surfaces[patch.surface].material];
    d.rho.insert(d.rho.end(), material.rho.begin(), material.rho.end());
    d.E.insert(d.E.end(), material.E.begin(), material.E.end());
  }
  for (const Element& element : mesh.elements) d.element_area.push_back(element.area);
  return d;
}

SceneSolution solve_scene(const Scene& scene, const SolveOptions& options) {
  return SceneSolver(scene, options).solve();
}

}  // namespace exitance
