#include "src/solve/gather.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "src/scene/input_error.h"
#include "src/solve/compensated.h"
#include "src/solve/direct.h"
#include "src/solve/error_bound.h"
#include "src/solve/krylov.h"

namespace exitance {
namespace {

double worst(std::span<const double> values) {
  return *std::max_element(values.begin(), values.end());
}

// One Gauss–Seidel sweep; the largest change of each band.
std::vector<double> sweep(const RadiositySystem& s, std::vector<double>& B) {
  std::vector<double> H(s.bands), change(s.bands);
  for (std::size_t p = 0; p < s.patches(); ++p) {
    row_product(s.F.row_columns(p), s.F.row(p), B.data(), s.bands, H.data());
    for (std::size_t b = 0; b < s.bands; ++b) {
      const std::size_t i = p * s.bands + b;
      const double updated = s.E[i] + s.rho[i] * H[b];
      change[b] = std::max(change[b], std::abs(updated - B[i]));
      B[i] = updated;
    }
  }
  return change;
}

// Whether Gauss–Seidel sweeps may stop to be verified. A sweep shrinks the error by the contraction q, so that after a
// change d the error is at most q d / (1 − q); below a few roundings of B it shrinks no more.
bool looks_solved(std::span<const double> change, std::span<const double> q, std::span<const double> max_B,
                  double tolerance) {
  for (std::size_t b = 0; b < change.size(); ++b) {
    const bool within = q[b] * change[b] <= tolerance / 4 * (1 - q[b]) * max_B[b];
    const bool at_rounding = change[b] <= 2 * std::numeric_limits<double>::epsilon() * max_B[b];
    if (!within && !at_rounding) return false;
  }
  return true;
}

bool only_rounding_is_left(const Residual& r, std::span<const double> bounds, double tolerance) {
  for (std::size_t b = 0; b < bounds.size(); ++b) {
    if (bounds[b] > tolerance && r.norm[b] > r.rounding[b]) return false;
  }
  return true;
}

double relative_residual(const Residual& r) {
  double result = 0;
  for (std::size_t b = 0; b < r.norm.size(); ++b) {
    if (r.norm[b] > 0) result = std::max(result, r.norm[b] / r.max_B[b]);
  }
  return result;
}

// Fraction done when the bound fell from first to now on its way to the tolerance.
class LogarithmicProgress {
 public:
  LogarithmicProgress(const Progress& progress, double tolerance) : progress_(progress), tolerance_(tolerance) {}

  void report(double bound) {
    if (!progress_) return;
    if (first_ == 0) first_ = bound;
    const bool on_the_way = bound > tolerance_ && first_ > tolerance_ && std::isfinite(first_);
    const double fraction = on_the_way ? std::log(first_ / bound) / std::log(first_ / tolerance_) : 1.0;
    shown_ = std::clamp(fraction, shown_, 1.0);
    progress_(shown_, "solve");
  }

 private:
  const Progress& progress_;
  double tolerance_;
  double first_ = 0, shown_ = 0;
};

}  // namespace

Solution gather(const RadiositySystem& s, const GatherOptions& options) {
  check(s);
  if (!(options.tolerance > 0)) throw std::invalid_argument("gather: the tolerance must be positive");
  if (!options.start.empty() && options.start.size() != s.E.size())
    throw std::invalid_argument("gather: the start must have a value for each patch and band");
  if (options.method == GatherMethod::direct && s.patches() > kDirectLimit) {
    throw LimitError("a direct solution takes at most " + std::to_string(kDirectLimit) + " patches, not " +
                     std::to_string(s.patches()) + "; use another method");
  }

  Solution solution;
  solution.B = options.start.empty() ? s.E : std::vector<double>(options.start.begin(), options.start.end());
  if (s.patches() == 0) {
    solution.converged = true;
    return solution;
  }
  const std::vector<double> q = contraction(s);
  if (options.method == GatherMethod::krylov) {
    solution.iterations = solve_krylov(s, q, options.tolerance, options.max_iterations, solution.B);
  } else if (options.method == GatherMethod::direct) {
    solve_direct(s, solution.B);
  }

  const auto stopped = [&] { return options.stop && options.stop(); };
  LogarithmicProgress progress(options.progress, options.tolerance);
  for (;;) {
    Residual r = residual(s, solution.B);
    const std::vector<double> bounds = error_bounds(r.norm, r.rounding, q, r.max_B);
    solution.error_bound = worst(bounds);
    solution.residual = relative_residual(r);
    solution.converged = solution.error_bound <= options.tolerance;
    progress.report(solution.error_bound);
    if (solution.converged || only_rounding_is_left(r, bounds, options.tolerance) ||
        solution.iterations >= options.max_iterations || stopped()) {
      solution.H = std::move(r.H);
      return solution;
    }
    if (options.method == GatherMethod::jacobi) {
      for (std::size_t i = 0; i < s.E.size(); ++i) solution.B[i] = s.E[i] + s.rho[i] * r.H[i];
      ++solution.iterations;
      continue;
    }
    bool solved = false;
    while (!solved && solution.iterations < options.max_iterations && !stopped()) {
      solved = looks_solved(sweep(s, solution.B), q, r.max_B, options.tolerance);
      ++solution.iterations;
    }
  }
}

}  // namespace exitance
