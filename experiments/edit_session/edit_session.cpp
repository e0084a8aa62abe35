// A cube is dragged across the table for 60 frames, with so many shots a frame: how wrong is what is shown, with the
// log of changes and without it?

#include "src/dynamic/edit_session.h"

#include <fmt/format.h>

#include <filesystem>
#include <string>
#include <vector>

#include "experiments/csv_table.h"
#include "experiments/experiment_options.h"
#include "experiments/plot_note.h"
#include "src/dynamic/converged_reference.h"
#include "src/output/plot.h"
#include "src/output/run_clock.h"
#include "src/scene/scene_file.h"
#include "tests/places.h"

namespace exitance {
namespace {

struct Drag {
  Scene scene;
  std::uint32_t cube = 0;
  MeshOptions mesh;
  std::uint32_t frames = 60;

  /// Of frame k ≥ 1: along the table and back, turning.
  Edit place(std::uint32_t k) const {
    const double way = static_cast<double>(k) / frames, along = 0.5 * std::sin(2 * 3.14159265358979 * way);
    Placement turn{rotation({0, 0, 1}, 90 * way), {}};
    const Vec3 middle{2.3, 1.7, 0.75};
    turn.translation = middle - turn(middle) + Vec3{along, 0, 0};
    return {k == 1 ? Operation::add : Operation::move, cube, turn, {}, {}};
  }
};

Drag drag(bool reduced) {
  Drag drag;
  drag.scene = read_dynamic_scene(source_file("data/cube.toml"), Emission::exitance).scene;
  while (drag.scene.objects[drag.cube].name != "cube") ++drag.cube;
  drag.mesh = {drag.scene.mesh.patch_size, drag.scene.mesh.elements_per_edge, drag.scene.mesh.small_patch};
  if (reduced) {
    drag.mesh = {1.0, 1};
    drag.frames = 8;
  }
  return drag;
}

enum class Way {
  log,
  log_shot,  ///< what the cube receives is shot to it by others, not gathered
  no_log,
  selected
};

const char* name_of(Way way) {
  switch (way) {
    case Way::log:
      return "log";
    case Way::log_shot:
      return "log and shots alone";
    case Way::no_log:
      return "no log";
    case Way::selected:
      break;
  }
  return "selected";
}

class Frames {
 public:
  Frames(const Drag& drag, const SessionOptions& options)
      : drag_(drag), options_(options), first_(drag.scene, options) {
    first_.work({});
    EditSession exact(first_, options);
    references_.push_back(converged_reference(exact.solution()));
    for (std::uint32_t k = 1; k <= drag.frames; ++k) {
      exact.apply(drag.place(k));
      references_.push_back(converged_reference(exact.solution()));
    }
  }

  void run(Way way, std::uint64_t budget_shots, CsvTable& table, CsvTable& summary, Plot& plot) {
    SessionOptions options = options_;
    options.log = way != Way::no_log;
    options.object_terms = way == Way::log_shot ? ObjectTerms::shot : ObjectTerms::gathered;
    EditSession session(first_, options);
    if (way == Way::selected) {
      Edit first = drag_.place(1);
      session.apply(first);
      session.apply({Operation::select, drag_.cube, {}, {}, {}});
    }
    PlotSeries series{fmt::format("{}, {} shots", name_of(way), budget_shots), {}, way == Way::no_log};
    Budget budget;
    budget.shots = budget_shots;
    double sum = 0, seconds = 0;
    const auto error_of = [&](std::uint32_t k) {
      const DynamicRadiosity& state = session.solution();
      return convergence_error(state.version(), state.bands(), references_[k], references_[k - 1], state.element_B());
    };
    for (std::uint32_t k = 1; k <= drag_.frames; ++k) {
      const RunClock clock;
      if (way != Way::selected || k > 1) session.apply(drag_.place(k));
      const SessionWork work = session.work(budget);
      seconds += clock.cpu_seconds();
      const ConvergenceError error = error_of(k);
      sum += error.all;
      table.rows.push_back({name_of(way), fmt::format("{}", budget_shots), fmt::format("{}", k), digits(error.all),
                            digits(error.worst_1_percent), fmt::format("{}", work.gatherings),
                            fmt::format("{}", work.redistributions), fmt::format("{}", work.propagations),
                            fmt::format("{}", session.solution().pending_changes())});
      series.points.emplace_back(k, error.all);
    }
    const std::size_t entries = session.solution().pending_changes();
    if (way == Way::selected) session.apply({Operation::deselect, drag_.cube, {}, {}, {}});
    const RunClock clock;
    const SessionWork rest = session.work({});
    const ConvergenceError left = error_of(drag_.frames);
    summary.rows.push_back({name_of(way), fmt::format("{}", budget_shots), digits(sum / drag_.frames),
                            fmt::format("{}", entries), fmt::format("{}", rest.shots()),
                            fmt::format("{:.3g}", left.all), fmt::format("{:.3g}", seconds / drag_.frames),
                            fmt::format("{:.3g}", clock.cpu_seconds())});
    fmt::print(stderr, "{}: mean error {:.3g}, {:.3g} when worked off\n", series.name, sum / drag_.frames, left.all);
    plot.series.push_back(std::move(series));
  }

 private:
  const Drag& drag_;
  SessionOptions options_;
  EditSession first_;
  std::vector<std::vector<double>> references_;
};

int run(int argc, char** argv) {
  CLI::App app{"Error over the frames of a dragged object, by budget, with and without the log"};
  ExperimentOptions wanted(app, "tables and the plot", "A small mesh and few frames",
                           "Compare errors with this table; exit code 1 where they differ");
  CLI11_PARSE(app, argc, argv);
  const Drag dragged = drag(wanted.reduced());
  SessionOptions options;
  options.mesh = dragged.mesh;
  options.tolerance = 1e-9;
  Frames frames(dragged, options);
  CsvTable table{{"way", "shots_a_frame", "frame", "error", "error_worst_1_percent", "gathered_patches",
                  "redistributions", "propagations", "log_entries"},
                 {}};
  CsvTable summary{{"way", "shots_a_frame", "mean_error", "log_entries_at_the_end", "shots_to_work_off",
                    "error_worked_off", "cpu_seconds_a_frame", "cpu_seconds_to_work_off"},
                   {}};
  Plot plot{"A cube is dragged across the table", "frame", "error (eq. 7) over all elements"};
  plot.note = plot_note();
  for (const std::uint64_t shots :
       wanted.reduced() ? std::vector<std::uint64_t>{5, 50} : std::vector<std::uint64_t>{10, 50, 250}) {
    for (const Way way : {Way::log, Way::log_shot, Way::no_log, Way::selected})
      frames.run(way, shots, table, summary, plot);
  }
  if (wanted.writes()) {
    const std::filesystem::path folder = wanted.folder();
    table.write(folder / "results.csv");
    summary.write(folder / "summary.csv");
    write_plot(folder / "plot.svg", plot);
  }
  return wanted.check(table, 3, 0.02, {});
}

}  // namespace
}  // namespace exitance

int main(int argc, char** argv) {
  return exitance::run(argc, argv);
}
