#include "src/reference/reference_solution.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <fstream>
#include <numeric>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "src/form_factor/pair_run.h"
#include "src/output/checkpoint.h"
#include "src/reference/comparison.h"
#include "src/reference/patch_polynomials.h"
#include "src/reference/refined_mesh.h"
#include "src/reference/sampled_residual.h"
#include "src/scene/input_error.h"
#include "src/scene/scene_hash.h"
#include "src/solve/error_bound.h"
#include "src/solve/gather.h"

namespace exitance {
namespace {

constexpr std::uint32_t kElementsPerEdge = 4;
/// Of the error's square, what the patches have that are divided at a time.
constexpr double kShareDivided = 0.7;
/// What gathering misses counts by so much: it is gathered from a B that is itself off. Chosen on the scenes of
/// experiments/reference_convergence: box on floor, closed Cornell box, furnished room.
constexpr double kMissed = 1.5;
/// Of the error wanted, what the solver may leave and what the polynomials' corrections may still change.
constexpr double kSolverShare = 1e-4;
constexpr int kMostCorrections = 50;

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Rows between elements that a new mesh has kept, under their new numbers.
PairRows kept_rows(const PairRows& rows, std::span<const std::uint32_t> new_number) {
  PairRows kept;
  for (std::size_t r = 0; r < rows.row.size(); ++r) {
    const std::uint32_t i = new_number[rows.row[r]];
    if (i == kNone) continue;
    kept.row.push_back(i);
    for (std::uint64_t k = rows.row_first[r]; k < rows.row_first[r + 1]; ++k) {
      const std::uint32_t j = new_number[rows.column[k]];
      if (j == kNone) continue;
      kept.column.push_back(j);
      kept.F.push_back(rows.F[k]);
      kept.F_error.push_back(rows.F_error[k]);
      kept.F_reverse.push_back(rows.F_reverse[k]);
      kept.F_reverse_error.push_back(rows.F_reverse_error[k]);
      kept.mark.push_back(rows.mark[k]);
    }
    kept.row_first.push_back(kept.column.size());
  }
  return kept;
}

/// Errors are estimates that hold nearly always. Where a row sums to more than they allow, they did not: they are
/// enlarged until they do. Returns the largest excess, as a share of its row's errors.
double explain_row_sums(FormFactorMatrix& F) {
  double largest = 0;
  for (std::size_t i = 0; i < F.rows(); ++i) {
    const auto row = F.row(i), errors = F.row_error(i);
    const double excess = std::accumulate(row.begin(), row.end(), 0.0) - 1 - row_sum_rounding(row.size());
    const double allowed = std::accumulate(errors.begin(), errors.end(), 0.0);
    if (excess <= allowed) continue;
    const double enlarged = 1.01 * excess / allowed;
    largest = std::max(largest, excess / allowed - 1);
    for (std::uint64_t k = F.row_first[i]; k < F.row_first[i + 1]; ++k) F.F_error[k] *= enlarged;
  }
  return largest;
}

RadiositySystem system_of(const Scene& scene, const PatchMesh& mesh) {
  RadiositySystem system;
  system.bands = scene.bands;
  for (const Element& element : mesh.elements) {
    const Material& material = scene.materials[scene.surfaces[mesh.patches[element.patch].surface].material];
    system.area.push_back(element.area);
    system.rho.insert(system.rho.end(), material.rho.begin(), material.rho.end());
    system.E.insert(system.E.end(), material.E.begin(), material.E.end());
  }
  return system;
}

/// In a checkpoint: its run has reached its error. Written before the solution is saved, so that whoever finds that
/// solution knows whose the rest of a checkpoint is whose removal was cut short.
std::filesystem::path mark_of_end(const std::filesystem::path& checkpoint) {
  return checkpoint / "finished";
}

class ReferenceSolver {
 public:
  ReferenceSolver(const Scene& scene, const PolygonSoup& soup, const ReferenceOptions& options)
      : scene_(scene),
        options_(options),
        pairs_(pair_options_for(options.error)),
        refined_(scene, soup,
                 {.patch_size = options.patch_size,
                  .elements_per_edge = kElementsPerEdge,
                  .memory_limit = options.memory_limit}),
        soup_(soup),
        residual_(soup) {
    if (refined_.mesh().patches.empty())
      throw InputError(scene.name, 0, "no surface has an area; there is nothing to solve");
    pairs_.stop = options_.stop;
    new_elements_ = static_cast<std::uint32_t>(refined_.mesh().elements.size());
    SolutionRecord& record = result_.record;
    record.source = scene.name;
    record.scene = scene.name;
    record.scene_hash = scene_hash(scene);
    record.unit = scene.unit;
    record.bands = scene.bands;
  }

  ReferenceSolution solve(const std::function<void(const ReferenceSolution&)>& saved) && {
    const std::filesystem::path& checkpoint = options_.checkpoint;
    std::error_code ignored;
    if (!checkpoint.empty()) std::filesystem::remove(mark_of_end(checkpoint), ignored);
    for (;;) {
      if (!add_form_factors()) return std::move(result_);
      if (!solve_level()) return std::move(result_);
      const bool reached = result_.record.error.total <= options_.error;
      if (reached && !checkpoint.empty()) std::ofstream(mark_of_end(checkpoint)).flush();
      if (saved) saved(result_);
      if (reached) {
        checkpoints_.clear();  // and their locks
        if (!checkpoint.empty()) clear_finished_checkpoint(checkpoint);
        return std::move(result_);
      }
      refine();
    }
  }

 private:
  bool add_form_factors() {
    const auto start = Clock::now();
    const PatchMesh& mesh = refined_.mesh();
    const ExchangeScene exchange(soup_, mesh, ExchangeScene::Unit::element);
    result_.bytes_needed = pair_rows_bytes(exchange.size(), expected_pair_density(exchange));
    if (result_.bytes_needed > options_.memory_limit) return ended(ReferenceEnd::memory, "");
    if (!options_.checkpoint.empty()) {
      checkpoints_.emplace_back(options_.checkpoint / fmt::format("level-{:02}", result_.levels.size()), run_key());
    }
    PairRun run = run_pairs(exchange,
                            {.pairs = pairs_,
                             .rows = new_elements_,
                             .block_seconds = options_.block_seconds,
                             .progress = [&](double fraction, std::string_view) { report(fraction); }},
                            checkpoints_.empty() ? nullptr : &checkpoints_.back());
    if (!run.complete) {
      return ended(ReferenceEnd::stopped, fmt::format("stopped after {} of {} rows of the first level{}", run.finished,
                                                      new_elements_, kept()));
    }
    level_ = {};
    level_.patches = static_cast<std::uint32_t>(mesh.patches.size());
    level_.elements = static_cast<std::uint32_t>(mesh.elements.size());
    level_.new_elements = new_elements_;
    level_.resumed_rows = run.resumed;
    for (const PairRows& rows : run.rows) append(rows_, rows);
    for (const std::uint8_t mark : rows_.mark) level_.partial_pairs += class_of(mark) == PairClass::partial;
    level_.seconds_form_factors = seconds_since(start);
    return true;
  }

  /// False: what there is is the result; without anything, the limit is an error.
  bool ended(ReferenceEnd why, const std::string& what) {
    result_.end = why;
    if (!result_.levels.empty()) return false;
    if (why == ReferenceEnd::stopped) throw LimitError(what);
    throw LimitError(fmt::format(
        "the form factors of {} elements would take about {:.3g} GiB of memory and {:.3g} GiB may be used; larger "
        "patches need less",
        refined_.mesh().elements.size(), static_cast<double>(result_.bytes_needed) * 0x1p-30,
        static_cast<double>(options_.memory_limit) * 0x1p-30));
  }

  std::string kept() const { return checkpoints_.empty() ? "" : "; they are kept, and the same command goes on"; }

  void report(double fraction) const {
    if (!options_.progress) return;
    options_.progress(fraction,
                      fmt::format("level {}, {} elements", result_.levels.size(), refined_.mesh().elements.size()));
  }

  std::string run_key() const {
    return fmt::format("{}scene {}\npatch_size {}\ntolerance {}\nrelative {}\npoints {}\nlevel {}\n", options_.key,
                       result_.record.scene_hash, options_.patch_size, pairs_.tolerance, pairs_.relative, pairs_.points,
                       result_.levels.size());
  }

  /// False where it was stopped, as add_form_factors().
  bool solve_level() {
    const auto start = Clock::now();
    const PatchMesh& mesh = refined_.mesh();
    RadiositySystem system = system_of(scene_, mesh);
    system.F = matrix_of(std::span(&rows_, 1), static_cast<std::uint32_t>(mesh.elements.size()));
    level_.largest_excess = explain_row_sums(system.F);

    const std::uint32_t degree = PatchPolynomials::degree_of_grid(kElementsPerEdge);
    std::vector<double> B = solved(system, degree, start_), lower = solved(system, degree - 1, B);
    if (!measure_missed({mesh, system, degree, B, shooting_}))
      return ended(ReferenceEnd::stopped,
                   "stopped after all rows of the first level, while its error was estimated" + kept());

    SolutionRecord& record = result_.record;
    record.mesh = mesh;
    record.degree = degree;
    record.H = irradiance(system.F, shooting_, system.bands);
    const double of_solver = solver_error_, of_form_factors = integration_error(system, B);
    record.B = std::move(B);

    const std::vector<double> Y = luminance(record.B, record.bands, mesh.elements.size());
    const std::vector<double> Y_lower = luminance(lower, record.bands, mesh.elements.size());
    measure_mesh_error(Y, Y_lower);
    record.error.integration = of_form_factors;
    record.error.solver = of_solver;
    record.error.total = record.error.mesh + of_form_factors + of_solver;
    level_.error = record.error;
    level_.seconds_solve = seconds_since(start);
    result_.levels.push_back(level_);
    result_.end = ReferenceEnd::reached;
    return true;
  }

  /// Means of B over elements that shoot as polynomials of that degree do. Their corrections are put into E, so that
  /// what is solved has form factors as they are, with their proven bound. start: B to begin with; may be empty.
  std::vector<double> solved(RadiositySystem& system, std::uint32_t degree, std::span<const double> start) {
    const PatchPolynomials polynomials(refined_.mesh(), degree);
    const std::vector<double> E = system.E;
    const double tolerance = std::max(kSolverShare * options_.error, 1e-13);
    Solution solution = gather(system, {.tolerance = tolerance, .start = start});
    double changed = 0;
    for (int k = 0; k < kMostCorrections; ++k) {
      std::vector<double> shot = polynomials.shooting_values(solution.B, system.bands);
      if (degree == PatchPolynomials::degree_of_grid(kElementsPerEdge)) shooting_ = shot;
      for (std::size_t i = 0; i < shot.size(); ++i) shot[i] -= solution.B[i];
      const std::vector<double> H = irradiance(system.F, shot, system.bands);
      for (std::size_t i = 0; i < E.size(); ++i) system.E[i] = E[i] + system.rho[i] * H[i];
      Solution next = gather(system, {.tolerance = tolerance, .start = solution.B});
      double largest = 0;
      changed = 0;
      for (std::size_t i = 0; i < E.size(); ++i) {
        changed = std::max(changed, std::fabs(next.B[i] - solution.B[i]));
        largest = std::max(largest, std::fabs(next.B[i]));
      }
      if (largest > 0) changed /= largest;
      solution = std::move(next);
      if (changed <= tolerance) break;
    }
    system.E = E;
    if (degree == PatchPolynomials::degree_of_grid(kElementsPerEdge)) solver_error_ = solution.error_bound + changed;
    return std::move(solution.B);
  }

  /// What the errors of the form factors can change, in the norm of equation 7: e_i ≤ ρ_i (Σ_j F_error_ij |B_j| +
  /// Σ_j F_ij e_j).
  double integration_error(RadiositySystem& system, std::span<const double> B) const {
    FormFactorMatrix errors = system.F;
    errors.F = errors.F_error;
    std::vector<double> shot(shooting_);
    for (double& value : shot) value = std::fabs(value);
    const std::vector<double> emitted = irradiance(errors, shot, system.bands);
    const std::vector<double> E = system.E;
    for (std::size_t i = 0; i < E.size(); ++i) system.E[i] = system.rho[i] * emitted[i];
    const std::vector<double> bound = gather(system, {.tolerance = 1e-3}).B;
    system.E = E;
    const std::size_t n = system.patches();
    return relative_norm(luminance(bound, system.bands, n), luminance(B, system.bands, n));
  }

  double relative_norm(std::span<const double> values, std::span<const double> reference) const {
    const PatchMesh& mesh = refined_.mesh();
    double of_values = 0, of_reference = 0;
    for (std::size_t e = 0; e < values.size(); ++e) {
      of_values += mesh.elements[e].area * values[e] * values[e];
      of_reference += mesh.elements[e].area * reference[e] * reference[e];
    }
    return of_values > 0 ? std::sqrt(of_values / of_reference) : 0;
  }

  void measure_mesh_error(std::span<const double> Y, std::span<const double> Y_lower) {
    const PatchMesh& mesh = refined_.mesh();
    const std::uint32_t degree = result_.record.degree;
    share_ = squared_distances(mesh, Y, degree, Y_lower, degree - 1);
    for (std::size_t p = 0; p < share_.size(); ++p) share_[p] += kMissed * kMissed * missed_[p];
    double reference = 0;
    std::vector<double> apart;
    for (std::uint32_t e = 0; e < Y.size(); ++e) {
      reference += mesh.elements[e].area * Y[e] * Y[e];
      apart.push_back(Y[e] - Y_lower[e]);
    }
    const double all = std::accumulate(share_.begin(), share_.end(), 0.0);
    result_.record.error.mesh = all > 0 ? std::sqrt(all / reference) : 0;
    level_.means_error = relative_norm(apart, Y);
    mesh_before_ = mesh;
  }

  /// Over each new patch; the others keep theirs, as little of it is changed by what they receive. False where stopped.
  bool measure_missed(const MeshSolution& solution) {
    std::vector<double> missed;
    std::vector<std::uint32_t> patches;
    for (std::uint32_t p = 0; p < solution.mesh.patches.size(); ++p) {
      const bool kept = !origins_.empty() && origins_[p].kept;
      missed.push_back(kept ? missed_[origins_[p].patch] : 0);
      if (!kept) patches.push_back(p);
    }
    const auto squares = residual_.squares(solution, patches, options_.stop);
    if (!squares) return false;
    for (std::size_t k = 0; k < patches.size(); ++k) missed[patches[k]] = (*squares)[k];
    missed_ = std::move(missed);
    return true;
  }

  void refine() {
    std::vector<std::uint32_t> order(share_.size());
    std::iota(order.begin(), order.end(), 0u);
    std::ranges::stable_sort(order, std::greater(), [&](std::uint32_t p) { return share_[p]; });
    const double all = std::accumulate(share_.begin(), share_.end(), 0.0);
    double divided = 0;
    std::vector<std::uint32_t> patches;
    for (const std::uint32_t p : order) {
      patches.push_back(p);
      divided += share_[p];
      if (divided >= kShareDivided * all) break;
    }
    std::ranges::sort(patches);
    origins_ = refined_.split(patches);
    const PatchMesh& mesh = refined_.mesh();
    std::vector<std::uint32_t> new_number(mesh_before_.elements.size(), kNone);
    new_elements_ = 0;
    for (std::uint32_t p = 0; p < origins_.size(); ++p) {
      const Patch& patch = mesh.patches[p];
      if (!origins_[p].kept) {
        new_elements_ += patch.element_count;
        continue;
      }
      for (std::uint32_t e = 0; e < patch.element_count; ++e)
        new_number[mesh_before_.patches[origins_[p].patch].element_first + e] = patch.element_first + e;
    }
    rows_ = kept_rows(rows_, new_number);
    start_from(new_number);
  }

  /// The next level begins with the B of this one: of elements that are kept, and of new ones their old patch's mean.
  void start_from(std::span<const std::uint32_t> new_number) {
    const PatchMesh& mesh = refined_.mesh();
    const std::uint32_t bands = result_.record.bands;
    const std::vector<double>& B = result_.record.B;
    start_.assign(mesh.elements.size() * bands, 0);
    for (std::uint32_t e = 0; e < new_number.size(); ++e) {
      if (new_number[e] != kNone)
        std::copy_n(&B[e * std::size_t{bands}], bands, &start_[new_number[e] * std::size_t{bands}]);
    }
    for (std::uint32_t p = 0; p < origins_.size(); ++p) {
      if (origins_[p].kept) continue;
      const Patch &patch = mesh.patches[p], &before = mesh_before_.patches[origins_[p].patch];
      for (std::uint32_t b = 0; b < bands; ++b) {
        double mean = 0;
        for (std::uint32_t e = before.element_first; e < before.element_first + before.element_count; ++e)
          mean += mesh_before_.elements[e].area / before.area * B[e * std::size_t{bands} + b];
        for (std::uint32_t e = patch.element_first; e < patch.element_first + patch.element_count; ++e)
          start_[e * std::size_t{bands} + b] = mean;
      }
    }
  }

  using Origin = RefinedMesh::Origin;

  const Scene& scene_;
  const ReferenceOptions& options_;
  PairOptions pairs_;
  RefinedMesh refined_;
  const PolygonSoup& soup_;
  SampledResidual residual_;
  std::deque<Checkpoint> checkpoints_;  // of all levels, which stay locked
  std::uint32_t new_elements_ = 0;      // those come first
  PairRows rows_;
  ReferenceLevel level_;
  std::vector<double> start_;     // B to begin the next level with, by element and band; empty on the first
  std::vector<double> shooting_;  // of the solution, by element and band
  std::vector<double> share_;     // of the mesh's squared error, by patch
  std::vector<double> missed_;    // by patch: what gathering at points misses, squared
  PatchMesh mesh_before_;         // that of the solution there is
  std::vector<Origin> origins_;   // of the patches, in that mesh; empty on the first level
  double solver_error_ = 0;
  ReferenceSolution result_;
};

}  // namespace

PairOptions pair_options_for(double error) {
  // Most entries miss their tolerance by far: those of a row add up to about the absolute one, or to the relative one.
  const double decade = std::pow(10, std::floor(std::log10(error) + 1e-9));
  return {.tolerance = std::max(1e-2 * decade, 1e-13), .relative = 0.05 * decade};
}

void clear_finished_checkpoint(const std::filesystem::path& checkpoint) {
  const std::filesystem::path mark = mark_of_end(checkpoint);
  std::error_code failed, ignored;
  if (std::filesystem::exists(mark, ignored)) {
    std::vector<std::filesystem::path> levels;
    for (std::filesystem::directory_iterator entry(checkpoint, failed), end; !failed && entry != end;
         entry.increment(failed)) {
      if (std::error_code no_folder; entry->is_directory(no_folder)) levels.push_back(entry->path());
    }
    if (failed) return;  // the mark stays, so that a later run removes them
    for (const std::filesystem::path& level : levels) Checkpoint(level, "").remove();
    std::filesystem::remove(mark, ignored);
  }
  std::filesystem::remove(checkpoint, ignored);  // unless it holds anything else
}

ReferenceSolution solve_reference(const Scene& scene, const PolygonSoup& soup, const ReferenceOptions& options,
                                  const std::function<void(const ReferenceSolution&)>& saved) {
  if (!(options.error > 0)) throw std::invalid_argument("solve_reference: the error must be positive");
  return ReferenceSolver(scene, soup, options).solve(saved);
}

}  // namespace exitance
