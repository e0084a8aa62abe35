#include "src/solve/shoot.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>
#include <sstream>
#include <string>
#include <utility>

#include "src/output/archive.h"
#include "src/output/save_pace.h"
#include "src/solve/error_bound.h"
#include "src/solve/sums_archive.h"

namespace exitance {
namespace {

constexpr double kUnitRoundoff = std::numeric_limits<double>::epsilon() / 2;

// What has been shot and received so far.
class Shooting {
 public:
  explicit Shooting(const Discretisation& d)
      : d_(d),
        area_(patch_areas(d)),
        importance_(luminance_weights(d.bands)),
        largest_rho_(d.bands),
        F_(d.elements()),
        F_error_(d.elements()),
        row_sum_(d.elements()),
        element_row_sum_(d.elements()),
        is_seen_(d.patches()),
        element_H_(d.elements() * d.bands),
        H_(d.patches() * d.bands),
        H_error_(d.patches() * d.bands),
        shot_(d.patches() * d.bands),
        B_(d.E),
        unshot_(d.E) {
    for (std::size_t i = 0; i < d.rho.size(); ++i) {
      largest_rho_[i % d.bands] = std::max(largest_rho_[i % d.bands], d.rho[i]);
    }
    for (double& q : largest_rho_) {
      q *= 1 + row_sum_rounding(d.patches());
      if (!(q < 1)) throw InvalidSystem("a reflectance is so near 1 that nothing bounds the solution");
    }
    measure();
  }

  /// What is no consequence of something else.
  void write(ArchiveWriter& file) const {
    file.write("shots", std::span(&shots_, 1));
    file.write("is_seen", std::span(is_seen_));
    write_sums(file, "row_sum", row_sum_);
    file.write("element_row_sum", std::span(element_row_sum_));
    write_sums(file, "element_H", element_H_);
    write_sums(file, "H", H_);
    file.write("H_error", std::span(H_error_));
    write_sums(file, "shot", shot_);
  }
  /// Goes on from there. Throws DamagedFile.
  void read(const ArchiveReader& file) {
    std::vector<std::uint64_t> shots{0};
    take(file, file.uint64s("shots"), shots);
    shots_ = shots[0];
    take(file, file.uint8s("is_seen"), is_seen_);
    take(file, sums_in(file, "row_sum"), row_sum_);
    take(file, file.doubles("element_row_sum"), element_row_sum_);
    take(file, sums_in(file, "element_H"), element_H_);
    take(file, sums_in(file, "H"), H_);
    take(file, file.doubles("H_error"), H_error_);
    take(file, sums_in(file, "shot"), shot_);
    for (std::size_t i = 0; i < B_.size(); ++i) emit(i);
    measure();
  }

  std::uint64_t shots() const { return shots_; }
  const std::vector<double>& bounds() const { return bounds_; }
  double unshot_energy() const { return energy_; }
  bool only_rounding_is_left(double tolerance) const {
    for (std::size_t b = 0; b < d_.bands; ++b) {
      if (bounds_[b] > tolerance && norm_[b] > rounding_[b]) return false;
    }
    return true;
  }

  bool is_seen(std::size_t patch) const { return is_seen_[patch] != 0; }
  /// Fetches a column and adds it to the sums of rows. False when it was stopped.
  bool look_at(std::size_t patch, const ShootColumn& column) {
    std::fill(F_.begin(), F_.end(), 0.0);
    std::fill(F_error_.begin(), F_error_.end(), 0.0);
    if (!column(patch, F_, F_error_)) return false;
    if (!is_seen(patch)) add_to_row_sums();
    is_seen_[patch] = 1;
    return true;
  }

  /// False when the column was stopped: then nothing is shot.
  bool shoot_strongest(const ShootColumn& column) {
    const std::size_t from = strongest_;
    if (!look_at(from, column)) return false;
    ++shots_;
    const std::uint32_t bands = d_.bands;
    const std::vector<double> amount(unshot_.begin() + static_cast<std::ptrdiff_t>(from * bands),
                                     unshot_.begin() + static_cast<std::ptrdiff_t>((from + 1) * bands));
    for (std::size_t b = 0; b < bands; ++b) shot_[from * bands + b].add(amount[b]);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, d_.patches(), 64), [&](const auto& some) {
      for (std::size_t p = some.begin(); p < some.end(); ++p) receive(p, amount);
    });
    measure();
    return true;
  }

  ShootSolution solution(double tolerance) const {
    ShootSolution result;
    result.patches.B = B_;
    for (const CompensatedSum& H : H_) result.patches.H.push_back(H.value());
    for (const CompensatedSum& H : element_H_) result.element_H.push_back(H.value());
    result.element_B = element_exitance(d_, result.element_H);
    result.unshot = unshot_;
    result.element_row_sum = element_row_sum_;
    result.all_columns_known = std::ranges::find(is_seen_, 0) == is_seen_.end();
    result.patches.iterations = shots_;
    result.patches.error_bound = *std::max_element(bounds_.begin(), bounds_.end());
    result.patches.converged = result.patches.error_bound <= tolerance;
    for (std::size_t b = 0; b < d_.bands; ++b) {
      if (max_B_[b] == 0) continue;
      result.patches.residual = std::max(result.patches.residual, norm_[b] / max_B_[b]);
      double reflected_error = 0;
      for (std::size_t i = b; i < d_.rho.size(); i += d_.bands) {
        reflected_error = std::max(reflected_error, d_.rho[i] * H_error_[i]);
      }
      const double error = reflected_error / (1 - largest_rho_[b]) / max_B_[b];
      result.form_factor_error = std::max(result.form_factor_error, error);
    }
    return result;
  }

 private:
  // A patch and its elements take their share of the amount (each band) that is shot.
  void receive(std::size_t p, std::span<const double> amount) {
    const std::uint32_t bands = d_.bands;
    CompensatedSum area_F;
    double area_error = 0;
    for (std::size_t e = d_.element_first[p]; e < d_.element_first[p + 1]; ++e) {
      if (F_[e] == 0 && F_error_[e] == 0) continue;
      area_F.add_product(d_.element_area[e], F_[e]);
      area_error += d_.element_area[e] * F_error_[e];
      for (std::size_t b = 0; b < bands; ++b) element_H_[e * bands + b].add_product(F_[e], amount[b]);
    }
    const double F = area_F.value() / area_[p];
    const double error = area_error / area_[p];
    for (std::size_t b = 0; b < bands; ++b) {
      const std::size_t i = p * bands + b;
      H_[i].add_product(F, amount[b]);
      H_error_[i] += error * std::abs(amount[b]);
      emit(i);
    }
  }

  // What is left to shoot of what was received.
  void emit(std::size_t i) {
    B_[i] = d_.E[i] + d_.rho[i] * H_[i].value();
    unshot_[i] = (B_[i] - shot_[i].high()) - shot_[i].low();
  }

  // Bounds, and who shoots next.
  void measure() {
    const std::uint32_t bands = d_.bands;
    norm_.assign(bands, 0.0);
    max_B_.assign(bands, 0.0);
    rounding_.assign(bands, 0.0);
    energy_ = 0;
    double most = -1;
    for (std::size_t p = 0; p < d_.patches(); ++p) {
      double energy = 0;
      for (std::size_t b = 0; b < bands; ++b) {
        const std::size_t i = p * bands + b;
        norm_[b] = std::max(norm_[b], std::abs(unshot_[i]));
        max_B_[b] = std::max(max_B_[b], std::abs(B_[i]));
        // Mean form factor, its product with what is shot, the sum, ρ H, + E, − shot: each rounds once or twice.
        rounding_[b] = std::max(rounding_[b], 12 * kUnitRoundoff * (std::abs(B_[i]) + std::abs(d_.E[i])));
        energy += importance_[b] * area_[p] * std::abs(unshot_[i]);
      }
      energy_ += energy;
      if (energy > most) {
        most = energy;
        strongest_ = p;
      }
    }
    bounds_ = error_bounds(norm_, rounding_, largest_rho_, max_B_);
  }

  void add_to_row_sums() {
    for (std::size_t e = 0; e < d_.elements(); ++e) {
      element_row_sum_[e] += F_[e];
      row_sum_[e].add(F_[e] - F_error_[e]);
      if (!(row_sum_[e].value() <= 1 + row_sum_rounding(d_.patches()))) {
        std::ostringstream what;
        what << "form factors of element " << e << " sum to 1 + " << row_sum_[e].value() - 1
             << ", more than their errors explain";
        throw InvalidSystem(what.str());
      }
    }
  }

  const Discretisation& d_;
  std::vector<double> area_, importance_, largest_rho_;
  std::vector<double> F_, F_error_;                       // the column in use
  std::vector<CompensatedSum> row_sum_;                   // at least, of each element, over the columns seen
  std::vector<double> element_row_sum_;                   // of each element, over the columns seen
  std::vector<std::uint8_t> is_seen_;                     // columns
  std::vector<CompensatedSum> element_H_;                 // each element and band
  std::vector<CompensatedSum> H_;                         // each patch and band
  std::vector<double> H_error_;                           // of H_, by the errors of the form factors
  std::vector<CompensatedSum> shot_;                      // by each patch and band so far
  std::vector<double> B_, unshot_;                        // each patch and band
  std::vector<double> norm_, max_B_, rounding_, bounds_;  // each band
  double energy_ = 0;
  std::size_t strongest_ = 0;
  std::uint64_t shots_ = 0;
};

/// As it was kept last; the beginning where nothing was, or there is no checkpoint.
Shooting taken_up(const Discretisation& d, Checkpoint* checkpoint) {
  std::optional<Shooting> kept;
  const auto read = [&](const ArchiveReader& file) { kept.emplace(d).read(file); };
  return checkpoint != nullptr && checkpoint->read_last(read) ? *std::move(kept) : Shooting(d);
}

}  // namespace

ShootColumn column_of(const FormFactorMatrix& transposed) {
  return [&transposed](std::size_t patch, std::span<double> F, std::span<double> F_error) {
    const auto elements = transposed.row_columns(patch);
    for (std::size_t k = 0; k < elements.size(); ++k) {
      F[elements[k]] = transposed.row(patch)[k];
      F_error[elements[k]] = transposed.row_error(patch)[k];
    }
    return true;
  };
}

ShootSolution shoot(const Discretisation& d, const ShootColumn& column, const ShootOptions& options) {
  check(d);
  if (!(options.tolerance > 0)) throw std::invalid_argument("shoot: the tolerance must be positive");
  if (d.patches() == 0) {
    ShootSolution nothing;
    nothing.patches.converged = nothing.all_columns_known = true;
    return nothing;
  }
  const double first_energy = Shooting(d).unshot_energy();
  Shooting state = taken_up(d, options.checkpoint);
  const auto solved = [&] {
    return *std::max_element(state.bounds().begin(), state.bounds().end()) <= options.tolerance;
  };
  double shown = 0;
  SavePace pace(options.save_seconds);
  const auto keep = [&] {
    if (options.checkpoint != nullptr) options.checkpoint->replace([&](ArchiveWriter& file) { state.write(file); });
  };
  const auto asked_to_stop = [&] { return options.stop && options.stop(); };
  const auto stopped = [&] { return state.shots() >= options.max_shots || asked_to_stop(); };
  while (!stopped() && !solved() && !state.only_rounding_is_left(options.tolerance)) {
    if (!state.shoot_strongest(column)) break;
    pace.in_time(keep);
    if (options.progress) {
      const double left = std::max(state.unshot_energy() / first_energy, options.tolerance);
      shown = std::clamp(std::log(left) / std::log(options.tolerance), shown, 1.0);
      options.progress(shown, "solve");
    }
  }
  const bool ended_early = !solved() && stopped();
  for (std::size_t p = 0; options.all_columns && !ended_early && p < d.patches(); ++p) {
    if (state.is_seen(p)) continue;
    if (!state.look_at(p, column)) break;
    pace.in_time(keep);
  }
  if (asked_to_stop()) keep();
  return state.solution(options.tolerance);
}

std::vector<double> ambient_estimate(const Discretisation& d, std::span<const double> unshot) {
  const std::vector<double> area = patch_areas(d);
  std::vector<double> ambient(d.bands);
  for (std::size_t b = 0; b < d.bands; ++b) {
    double all = 0, unshot_power = 0, reflecting = 0;
    for (std::size_t p = 0; p < d.patches(); ++p) {
      all += area[p];
      unshot_power += area[p] * unshot[p * d.bands + b];
      reflecting += area[p] * d.rho[p * d.bands + b];
    }
    if (all > 0) ambient[b] = unshot_power / (all - reflecting);
  }
  return ambient;
}

}  // namespace exitance
