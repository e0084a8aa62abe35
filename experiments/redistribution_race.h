#pragma once
// Ways to follow the addition of an object, against each other: progressive refinement and redistribution.

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "experiments/csv_table.h"
#include "experiments/experiment_options.h"
#include "experiments/finer_radiosity.h"
#include "experiments/goal.h"
#include "experiments/plot_note.h"
#include "src/dynamic/converged_reference.h"
#include "src/dynamic/picture.h"
#include "src/output/plot.h"
#include "src/output/run_clock.h"
#include "src/scene/scene_file.h"

namespace exitance {

struct Race {
  std::string title = {};
  DynamicScene scene = {};  ///< whose first event is the change
  MeshOptions mesh = {};
  double tolerance = 1e-6;                   ///< of the solutions before and after, of max B
  std::vector<std::uint64_t> pictured = {};  ///< shots after which pictures are made
  double until = 1e-3;                       ///< a contender ends when its error on the 1 % is below
  double most_seconds = 1e9;                 ///< of the processor, likewise
  std::uint64_t column_memory = DynamicRadiosity::kColumnMemory;  ///< for form factors that are kept [bytes]
  std::vector<std::string> methods = {};  ///< the contenders wanted; empty: all, and how patches are ranked
};

/// Of the power of the sources: below it strategy one may propagate, what was gathered first of all.
inline constexpr double kThreshold = 1e-4;

class RaceTrack {
 public:
  RaceTrack(Race race, std::filesystem::path out) : race_(std::move(race)), out_(std::move(out)) {
    options_.mesh = race_.mesh;
    options_.tolerance = race_.tolerance;
    options_.threshold = 0;
    options_.column_memory = race_.column_memory;
    options_.object_terms = ObjectTerms::shot;
  }

  void run() {
    EditSession before(race_.scene.scene, options_);
    RunClock clock;
    before.work({});
    was_ = before.solution().element_B();
    fmt::print(stderr, "{}: {} patches, {} elements; before in {:.3g} s\n", race_.title,
               before.solution().version().present_patches(), before.solution().version().present_elements(),
               clock.cpu_seconds());
    EditSession after(before, options_);
    after.apply(change());
    if (race_.methods.empty()) measure_importance(after.solution());
    clock = RunClock();
    const SessionWork all = after.work({});
    reference_ = after.solution().element_B();
    fmt::print(stderr, "worked off after in {:.3g} s; {} redistributions, {} propagations\n", clock.cpu_seconds(),
               all.redistributions, all.propagations);
    find_most_changed(before.solution().version(), after);
    draw(before.solution(), was_, "converged_before");
    draw(after.solution(), reference_, "converged_after");

    const auto race = [&](const std::string& name, const SessionOptions& options) {
      if (!race_.methods.empty() && std::ranges::find(race_.methods, name) == race_.methods.end()) return;
      follow(name, options.method == UpdateMethod::scratch ? EditSession(race_.scene.scene, options)
                                                           : EditSession(before, options));
    };
    SessionOptions options = options_;
    options.method = UpdateMethod::scratch;
    race("scratch", options);
    options.method = UpdateMethod::redistribute;
    options.threshold = kThreshold;
    race("strategy 1 estimated to 1e-4", options);
    options.object_terms = ObjectTerms::gathered;
    race("strategy 1 gathered", options);
    options.strategy = Strategy::interleave;
    race("strategy 2 gathered", options);
    options = options_;
    for (const auto& [strategy, first] :
         {std::pair{Strategy::redistribute_first, "strategy 1"}, std::pair{Strategy::interleave, "strategy 2"}}) {
      for (const auto& [kind, second] : {std::pair{ImportanceOptions::Kind::estimated, "estimated"},
                                         std::pair{ImportanceOptions::Kind::exact, "exact"}}) {
        options.strategy = strategy;
        options.importance.kind = kind;
        race(fmt::format("{} {}", first, second), options);
      }
    }
    options = options_;
    options.method = UpdateMethod::restart;
    options.strategy = Strategy::interleave;
    options.importance.kind = ImportanceOptions::Kind::exact;
    race("restart", options);
    for (auto& row : summary.rows) row.push_back(times_faster(row[2]));
    summary.header.push_back("times_faster_than_scratch");
    write();
  }

  void write() const {
    if (out_.empty()) return;
    results.write(out_ / "results.csv");
    summary.write(out_ / "summary.csv");
    if (!importance.rows.empty()) importance.write(out_ / "importance.csv");
    if (!weakness.rows.empty()) weakness.write(out_ / "weakness.csv");
    for (const auto& [plot, name] : {std::pair{over_time, "plot_time.svg"}, std::pair{over_shots, "plot_shots.svg"}}) {
      Plot titled = plot;
      titled.title = fmt::format("{}: after the object has come", race_.title);
      titled.note = plot_note();
      write_plot(out_ / name, titled);
    }
  }

  CsvTable results{
      {"method", "shots", "redistributions", "error", "error_worst_1_percent", "error_worst_1_percent_of_room",
       "error_to_finer_worst_1_percent", "redistribution_tests", "idle_tests", "idle_patch_tests", "cpu_seconds"},
      {}};
  CsvTable summary{{"method", "shots_to_5_percent", "cpu_seconds_to_5_percent"}, {}};
  CsvTable importance{{"estimate", "shots", "share_of_ideal"}, {}};
  CsvTable weakness{{"patches_that", "patches", "share_of_energy", "median_factor", "factor_of_worst_tenth"}, {}};
  Plot over_time{"", "seconds of the processor", "error on the 1 % most changed (eq. 7)"};
  Plot over_shots{"", "shots", "error on the 1 % most changed (eq. 7)"};

 private:
  const Edit& change() const { return race_.scene.events.front().edit; }

  void draw(const DynamicRadiosity& state, const std::vector<double>& B, const std::string& name) const {
    if (out_.empty() || !race_.scene.scene.camera) return;
    write_png(out_ / (name + ".png"), picture(state, B, *race_.scene.scene.camera, {480, 480}));
  }

  /// The elements over which errors are taken beside eq. 7's own, and what they have on a finer mesh.
  void find_most_changed(const SceneVersion& before, const EditSession& after) {
    const SceneVersion& version = after.solution().version();
    std::vector<std::uint32_t> all, stood;
    for (std::uint32_t e = 0; e < version.elements(); ++e) {
      if (!version.has_element(e)) continue;
      all.push_back(e);
      if (before.has_element(e)) stood.push_back(e);
    }
    const std::uint32_t bands = after.solution().bands();
    changed_ = most_changed(all, bands, reference_, was_);
    changed_of_room_ = most_changed(stood, bands, reference_, was_);
    MeshOptions finer = race_.mesh;
    finer.patch_size /= 2;
    finer.small_patch /= 4;
    RunClock clock;
    finer_ = finer_radiosity(after.solution(), after.scene(), finer, changed_);
    fmt::print(stderr, "the 1 % on a finer mesh in {:.3g} s; the solution is {:.3g} from that\n", clock.cpu_seconds(),
               error_over(version, changed_, finer_, reference_));
  }

  double error_over(const SceneVersion& version, std::span<const std::uint32_t> elements,
                    const std::vector<double>& reference, const std::vector<double>& B) const {
    const auto area = [&](std::uint32_t e) { return version.mesh().elements[e].area; };
    const auto bands = static_cast<std::uint32_t>(reference.size() / version.elements());
    return convergence_error(elements, area, bands, reference, was_, B).all;
  }

  void follow(const std::string& name, EditSession session) {
    PlotSeries by_time{name, {}}, by_shots{name, {}};
    ChangeWork work;
    double seconds = 0;
    std::uint64_t shots = 0, redistributions = 0;
    GoalReached there;
    const auto record = [&] {
      const auto B = session.solution().element_B();
      const DynamicRadiosity& state = session.solution();
      const ConvergenceError error = convergence_error(state.version(), state.bands(), reference_, was_, B);
      results.rows.push_back({name, fmt::format("{}", shots), fmt::format("{}", redistributions), digits(error.all),
                              digits(error.worst_1_percent),
                              digits(error_over(state.version(), changed_of_room_, reference_, B)),
                              digits(error_over(state.version(), changed_, finer_, B)),
                              fmt::format("{}", work.visibility_tests), fmt::format("{}", work.idle_tests),
                              fmt::format("{}", work.idle_patch_tests), fmt::format("{:.3g}", seconds)});
      by_time.points.emplace_back(seconds, error.worst_1_percent);
      by_shots.points.emplace_back(static_cast<double>(shots), error.worst_1_percent);
      there.record(error.worst_1_percent, shots, seconds);
      if (std::ranges::find(race_.pictured, shots) != race_.pictured.end() &&
          (name == "scratch" || name == "strategy 1 estimated"))
        draw(state, B, fmt::format("{}_{}", name == "scratch" ? "scratch" : "redistribution", shots));
      return error.worst_1_percent;
    };
    RunClock clock;
    session.apply(change());
    seconds = clock.cpu_seconds();
    double error = record();
    for (bool finished = false; !finished && error > race_.until && seconds < race_.most_seconds;) {
      std::uint64_t next = std::max(shots + 1, static_cast<std::uint64_t>(1.25 * static_cast<double>(shots)));
      for (const std::uint64_t at : race_.pictured) {
        if (at > shots) next = std::min(next, at);
      }
      Budget budget;
      budget.shots = next - shots;
      clock = RunClock();
      budget.interrupted = [&] { return seconds + clock.cpu_seconds() > race_.most_seconds; };
      const SessionWork done = session.work(budget);
      seconds += clock.cpu_seconds();
      shots += done.shots();
      redistributions += done.redistributions;
      work += done.redistribution;
      finished = done.finished || done.interrupted;
      error = record();
    }
    fmt::print(stderr, "{}: {} shots, {:.3g} s, error on the 1 % {:.3g}\n", name, shots, seconds, error);
    summary.rows.push_back({name, there.shots(), there.seconds()});
    over_time.series.push_back(by_time);
    over_shots.series.push_back(by_shots);
    write();
  }

  std::string times_faster(const std::string& seconds) const {
    for (const auto& row : summary.rows) {
      if (row[0] != "scratch" || row[2] == "none" || seconds == "none") continue;
      return fmt::format("{:.3g}", std::stod(row[2]) / std::stod(seconds));
    }
    return "none";
  }

  /// How much of what the best order of redistribution shots moves is moved by the estimate's, and where it errs.
  void measure_importance(const DynamicRadiosity& changed) {
    const auto patches = static_cast<std::uint32_t>(changed.version().patches());
    DynamicRadiosity shot = changed;
    std::vector<double> power(patches);
    std::vector<std::uint32_t> senders;
    for (std::uint32_t p = 0; p < patches; ++p) {
      if (changed.pending_changes() == 0 || !changed.has_to_redistribute(0, p)) continue;
      senders.push_back(p);
    }
    for (const std::uint32_t p : senders)
      power[p] = shot.redistribute(0, p, VersionDifference::Search::shadow_volumes).power;
    const auto sums_in_order_of = [&](const std::vector<double>& rank) {
      std::vector<std::uint32_t> order = senders;
      std::ranges::stable_sort(order, std::greater<>(), [&](std::uint32_t p) { return rank[p]; });
      std::vector<double> sums{0};
      for (const std::uint32_t p : order) sums.push_back(sums.back() + power[p]);
      return sums;
    };
    const std::vector<double> ideal = sums_in_order_of(power);
    const auto energies = [&](const ImportanceOptions& options) {
      DynamicRadiosity state = changed;
      state.set_importance(options);
      std::vector<double> energy(patches);
      for (const std::uint32_t p : senders) energy[p] = state.redistribution_energy(0, p);
      return energy;
    };
    const auto add = [&](const std::string& name, const std::vector<double>& rank) {
      const std::vector<double> sums = sums_in_order_of(rank);
      for (const std::size_t k : {1, 2, 5, 10, 20, 50, 100, 200, 500, 1000}) {
        if (k < sums.size()) importance.rows.push_back({name, fmt::format("{}", k), digits(sums[k] / ideal[k])});
      }
    };
    using Kind = ImportanceOptions::Kind;
    const std::vector<double> exact = energies({Kind::exact, 1}), estimate = energies({Kind::estimated, 1});
    add("exact", exact);
    add("1 point", estimate);
    add("8 points", energies({Kind::estimated, 8}));
    add("27 points", energies({Kind::estimated, 27}));
    add("none (all energy shot)", energies({Kind::total, 1}));

    Box box;
    const SceneVersion& version = changed.version();
    const ObjectSlot& slot = version.slot(change().object);
    for (std::uint32_t f = slot.facet_first; f < slot.facet_last; ++f) {
      for (const Corner& c : version.soup().corners(version.soup().facets()[f])) box.extend(c.at);
    }
    const Vec3 middle = 0.5 * (box.lower + box.upper);
    const double size = norm(box.upper - box.lower);
    double all = 0;
    for (const std::uint32_t p : senders) all += exact[p];
    const auto add_class = [&](const std::string& name, const auto& belongs) {
      std::vector<double> factors;
      double energy = 0;
      for (const std::uint32_t p : senders) {
        if (exact[p] < 1e-9 * all || !belongs(p)) continue;
        energy += exact[p];
        factors.push_back(std::exp(std::fabs(std::log(estimate[p] / exact[p]))));
      }
      if (factors.empty()) return;
      std::ranges::sort(factors);
      weakness.rows.push_back({name, fmt::format("{}", factors.size()), digits(energy / all),
                               digits(factors[factors.size() / 2]), digits(factors[factors.size() * 9 / 10])});
    };
    const auto away = [&](std::uint32_t p) {
      return norm(version.mesh().elements[version.mesh().patches[p].element_first].sample - middle);
    };
    // Half of what is seen of the whole object: the point hardly sees the patch, or the object hardly does.
    const auto is_half_hidden = [&](std::uint32_t p) {
      return estimate[p] < 0.5 * exact[p] || estimate[p] > 2 * exact[p];
    };
    add_class("all", [](std::uint32_t) { return true; });
    add_class("are nearer than one size of the object", [&](std::uint32_t p) { return away(p) < size; });
    add_class("are farther than two sizes", [&](std::uint32_t p) { return away(p) > 2 * size; });
    add_class("are farther than two sizes and estimated within a factor of two",
              [&](std::uint32_t p) { return away(p) > 2 * size && !is_half_hidden(p); });
    add_class("stand straight above or below", [&](std::uint32_t p) {
      const Vec3 d = version.mesh().elements[version.mesh().patches[p].element_first].sample - middle;
      return std::fabs(d.z) > 0.8 * norm(d);
    });
    add_class("stand level with it", [&](std::uint32_t p) {
      const Vec3 d = version.mesh().elements[version.mesh().patches[p].element_first].sample - middle;
      return std::fabs(d.z) < 0.3 * norm(d);
    });
  }

  Race race_;
  std::filesystem::path out_;
  SessionOptions options_;
  std::vector<double> was_, reference_, finer_;
  std::vector<std::uint32_t> changed_, changed_of_room_;
};

/// The program of such an experiment. race(reduced): what is asked.
template <class MakeRace>
int run_race(int argc, char** argv, const char* what, const MakeRace& race) {
  CLI::App app{what};
  ExperimentOptions wanted(app, "tables, plots and pictures", "A small mesh",
                           "Compare errors with this table; exit code 1 where they differ");
  std::vector<std::string> methods;
  app.add_option("--methods", methods, "Contenders, separated by commas; without it all, and how well they are ranked")
      ->delimiter(',');
  CLI11_PARSE(app, argc, argv);
  Race asked = race(wanted.reduced());
  asked.methods = methods;
  RaceTrack track(std::move(asked), wanted.writes() ? wanted.folder() : std::filesystem::path());
  track.run();
  return wanted.check(track.results, 2, 0.02,
                      {"cpu_seconds", "redistribution_tests", "idle_tests", "idle_patch_tests"});
}

}  // namespace exitance
