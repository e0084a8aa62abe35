// What does an edit cost in rooms of different sizes, when the same box moves in each?

#include <fmt/format.h>
#include <malloc.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "experiments/csv_table.h"
#include "experiments/plot_note.h"
#include "src/dynamic/edit_session.h"
#include "src/output/plot.h"
#include "src/reference/run_clock.h"
#include "src/scene/furnished_room.h"

namespace exitance {
namespace {

constexpr std::uint64_t kShots = 20;
constexpr int kEdits = 3;

/// A room, and a box of 30 cm under its ceiling, the last object.
Scene room_with_box(std::uint32_t polygons) {
  Scene scene = make_furnished_room(polygons, 1);
  const auto object = static_cast<std::uint32_t>(scene.objects.size());
  scene.objects.push_back({"box", ""});
  const Vec3 a{0.8, 0.8, 2.2}, b{1.1, 1.1, 2.5};
  const std::vector<Loop> faces = {{{a.x, a.y, a.z}, {a.x, b.y, a.z}, {b.x, b.y, a.z}, {b.x, a.y, a.z}},
                                   {{a.x, a.y, b.z}, {b.x, a.y, b.z}, {b.x, b.y, b.z}, {a.x, b.y, b.z}},
                                   {{a.x, a.y, a.z}, {b.x, a.y, a.z}, {b.x, a.y, b.z}, {a.x, a.y, b.z}},
                                   {{a.x, b.y, a.z}, {a.x, b.y, b.z}, {b.x, b.y, b.z}, {b.x, b.y, a.z}},
                                   {{a.x, a.y, a.z}, {a.x, a.y, b.z}, {a.x, b.y, b.z}, {a.x, b.y, a.z}},
                                   {{b.x, a.y, a.z}, {b.x, b.y, a.z}, {b.x, b.y, b.z}, {b.x, a.y, b.z}}};
  for (const Loop& face : faces) {
    Surface surface;
    surface.polygon.outer = face;
    surface.object = object;
    scene.surfaces.push_back(surface);
  }
  return scene;
}

double heap_bytes() {
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks) + static_cast<double>(info.hblkhd);
}

int run(int argc, char** argv) {
  CLI::App app{"Time and memory of an edit against the size of the scene"};
  std::string out, expected;
  bool reduced = false;
  app.add_option("-o,--output", out, "Folder for the table and the plot");
  app.add_flag("--reduced", reduced, "The smallest room only");
  app.add_option("--check", expected, "Compare what was found with this table; exit code 1 where it differs");
  CLI11_PARSE(app, argc, argv);
  CsvTable table{{"patches", "elements_changed", "edit_cpu_seconds", "edit_bytes", "redistribution_cpu_seconds",
                  "propagation_cpu_seconds"},
                 {}};
  Plot plot{"The same box moves in rooms of different sizes", "patches", "seconds of the processor"};
  plot.series = {{"edit", {}}, {"redistribution shot", {}}, {"propagation shot, first", {}}};
  plot.note = plot_note();
  for (const std::uint32_t polygons : reduced ? std::vector<std::uint32_t>{1000}
                                              : std::vector<std::uint32_t>{1000, 4000, 15000, 60000}) {
    SessionOptions options;
    options.threshold = 0;
    EditSession session(room_with_box(polygons), options);
    const auto box = static_cast<std::uint32_t>(session.scene().scene().objects.size() - 1);
    Budget some;
    some.shots = kShots;
    RunClock clock;
    session.work(some);
    const double propagation = clock.cpu_seconds() / static_cast<double>(kShots);
    double edit = 0, bytes = 0, redistribution = 0;
    std::uint64_t redistributions = 0, changed = 0;
    for (int k = 1; k <= kEdits; ++k) {
      const double before = heap_bytes();
      clock = RunClock();
      Placement placement;
      placement.translation = {0.05 * k, 0, 0};
      session.apply({Operation::move, box, placement, {}, {}});
      edit += clock.cpu_seconds();
      bytes += heap_bytes() - before;
      clock = RunClock();
      const SessionWork work = session.work(some);
      redistribution += clock.cpu_seconds();
      redistributions += work.redistributions;
      changed += work.redistribution.visibility_tests - work.redistribution.idle_tests;
    }
    const double patches = static_cast<double>(session.solution().version().present_patches());
    const double per_edit = edit / kEdits, per_shot = redistribution / static_cast<double>(redistributions);
    table.rows.push_back({fmt::format("{}", patches), fmt::format("{}", changed), fmt::format("{:.3g}", per_edit),
                          fmt::format("{:.3g}", bytes / kEdits), fmt::format("{:.3g}", per_shot),
                          fmt::format("{:.3g}", propagation)});
    plot.series[0].points.emplace_back(patches, per_edit);
    plot.series[1].points.emplace_back(patches, per_shot);
    plot.series[2].points.emplace_back(patches, propagation);
    fmt::print(stderr, "{}\n", fmt::join(table.rows.back(), "  "));
  }
  if (!out.empty()) {
    std::filesystem::create_directories(out);
    table.write(std::filesystem::path(out) / "results.csv");
    write_plot(std::filesystem::path(out) / "plot.svg", plot);
  }
  if (expected.empty()) return 0;
  return verdict(differences(table, CsvTable::read(expected), 1, 0.02,
                             {"edit_cpu_seconds", "edit_bytes", "redistribution_cpu_seconds",
                              "propagation_cpu_seconds"}));
}

}  // namespace
}  // namespace exitance

int main(int argc, char** argv) {
  return exitance::run(argc, argv);
}
