// The same object moves in rooms of ever more patches: what do its edits take, in time and in memory?

#include <fmt/format.h>
#include <malloc.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "experiments/csv_table.h"
#include "experiments/experiment_options.h"
#include "experiments/plot_note.h"
#include "experiments/power_law.h"
#include "src/dynamic/edit_session.h"
#include "src/output/plot.h"
#include "src/output/run_clock.h"
#include "src/scene/furnished_room.h"

namespace exitance {
namespace {

constexpr std::uint64_t kSeed = 7;
/// What has been shot when the object moves: by the strongest lamps.
constexpr std::uint64_t kShotsBefore = 4;
constexpr std::uint32_t kEdits = 11;

/// How rooms get more patches.
enum class Family {
  detail,  ///< one furnished room, cut and furnished ever finer: more of it lies in the object's shadow
  row  ///< the furnished room of the fewest patches, and copies of it beside it: the same lies in the object's shadow
};

const char* name_of(Family family) {
  return family == Family::detail ? "detail" : "row";
}

constexpr std::uint32_t kRoom = 1000;

/// A furnished room, and behind its walls others without light.
Scene row_of_rooms(std::uint32_t polygons) {
  Scene scene = make_furnished_room(kRoom, kSeed);
  Box box;
  for (const Surface& s : scene.surfaces) {
    for (const Vec3& p : s.polygon.outer) box.extend(p);
  }
  const std::vector<Surface> room = scene.surfaces;
  Material dark = scene.materials.front();
  dark.name = "dark";
  std::ranges::fill(dark.E, 0.0);
  scene.materials.push_back(dark);
  for (std::uint32_t k = 1; k * kRoom < polygons; ++k) {
    for (Surface s : room) {
      for (Vec3& p : s.polygon.outer) p.x += 1.25 * (box.upper.x - box.lower.x) * k;
      s.material = static_cast<std::uint32_t>(scene.materials.size() - 1);
      scene.surfaces.push_back(std::move(s));
    }
  }
  return scene;
}

/// One patch a polygon, and a box below the ceiling.
Scene room_with_box(Family family, std::uint32_t polygons) {
  Scene scene = family == Family::row ? row_of_rooms(polygons) : make_furnished_room(polygons, kSeed);
  const auto object = static_cast<std::uint32_t>(scene.objects.size());
  scene.objects.push_back({"box", ""});
  const Vec3 low{-0.2, -0.2, 0}, high{0.2, 0.2, 0.3};
  const auto corner = [&](int k) {
    return Vec3{(k & 1) != 0 ? high.x : low.x, (k & 2) != 0 ? high.y : low.y, (k & 4) != 0 ? high.z : low.z};
  };
  for (const auto& face :
       {std::array{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}) {
    Surface surface;
    for (const int k : face) surface.polygon.outer.push_back(corner(k));
    surface.object = object;
    scene.surfaces.push_back(surface);
  }
  return scene;
}

/// Of step k: along a line near the middle of the room, turning.
Edit step(std::uint32_t object, const Vec3& middle, std::uint32_t k) {
  Placement place{rotation({0, 0, 1}, 17.0 * k), {}};
  place.translation = middle + Vec3{0.05 * k, 0.02 * k, 0};
  return {Operation::move, object, place, {}, {}};
}

std::size_t heap_bytes() {
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

/// Medians over the edits; of bytes, the mean.
struct Growth {
  std::size_t patches = 0;
  double edit = 0, order = 0, shots = 0;  ///< [s] of the processor: an edit, the order of shots after it, all of them
  double bytes = 0;                       ///< of the heap that an edit takes, while all versions are kept
  double candidates = 0, tests = 0;       ///< elements that may be in a shadow, form factors that were computed
  std::uint32_t remade = 0;               ///< edits for which the polygons' topology and index were made anew
};

Growth measure(Family family, std::uint32_t polygons) {
  const Scene scene = room_with_box(family, polygons);
  const auto object = static_cast<std::uint32_t>(scene.objects.size() - 1);
  Box box;  // of the furthest left room, which begins with its floor
  for (const Vec3& p : scene.surfaces.front().polygon.outer) box.extend(p);
  Vec3 middle = 0.5 * (box.lower + box.upper);
  middle.z = 2.2;
  SessionOptions options;
  options.threshold = 0;
  EditSession session(scene, options);
  session.apply(step(object, middle, 0));
  Budget budget;
  budget.shots = kShotsBefore;
  session.work(budget);
  Growth growth;
  growth.patches = session.solution().version().present_patches();
  std::vector<double> edit, order, shots, candidates, tests;
  std::vector<std::shared_ptr<const SceneVersion>> kept;
  for (std::uint32_t k = 1; k <= kEdits; ++k) {
    kept.push_back(session.solution().shared_version());
    RunClock clock;
    session.apply(step(object, middle, k));
    edit.push_back(clock.cpu_seconds());
    growth.remade += session.solution().version().soup().shares_with(kept.back()->soup()) ? 0 : 1;
    clock = RunClock();
    session.redistribution_left();
    order.push_back(clock.cpu_seconds());
    budget.shots = session.log().front().patches;
    clock = RunClock();
    const SessionWork work = session.work(budget);
    shots.push_back(clock.cpu_seconds());
    candidates.push_back(static_cast<double>(work.redistribution.candidates));
    tests.push_back(static_cast<double>(work.redistribution.visibility_tests));
  }
  // Several edits in a row, of which all versions are kept.
  const std::size_t heap = heap_bytes();
  for (std::uint32_t k = 0; k < kEdits; ++k) {
    session.apply(step(object, middle, k));
    kept.push_back(session.solution().shared_version());
  }
  growth.bytes = (static_cast<double>(heap_bytes()) - static_cast<double>(heap)) / kEdits;
  growth.edit = median(edit);
  growth.order = median(order);
  growth.shots = median(shots);
  growth.candidates = median(candidates);
  growth.tests = median(tests);
  return growth;
}

int run(int argc, char** argv) {
  CLI::App app{"Time and memory of the same edit in rooms of ever more patches"};
  ExperimentOptions wanted(app, "the table and the plot", "Small rooms only",
                           "Compare counts with this table; exit code 1 where they differ");
  CLI11_PARSE(app, argc, argv);
  CsvTable table{
      {"rooms", "patches", "remade", "candidates", "tests", "edit_ms", "edit_kilobytes", "order_ms", "shots_ms"}, {}};
  Plot plot{"The same object moves in rooms of ever more patches", "patches", "processor time [ms], memory [MB]"};
  const std::vector<std::uint32_t> sizes =
      wanted.reduced() ? std::vector<std::uint32_t>{1000, 2000}
                       : std::vector<std::uint32_t>{1000, 2000, 4000, 8000, 15000, 30000, 60000};
  for (const Family family : {Family::detail, Family::row}) {
    PlotSeries edits{fmt::format("{}: an edit [ms]", name_of(family)), {}};
    PlotSeries shots{fmt::format("{}: its order and its {} shots [ms]", name_of(family), kShotsBefore), {}};
    PlotSeries memory{fmt::format("{}: memory of an edit [MB]", name_of(family)), {}, true};
    for (const std::uint32_t polygons : sizes) {
      const Growth g = measure(family, polygons);
      table.rows.push_back({name_of(family), fmt::format("{}", g.patches), fmt::format("{}", g.remade),
                            digits(g.candidates), digits(g.tests), fmt::format("{:.3g}", 1e3 * g.edit),
                            fmt::format("{:.3g}", g.bytes / 1024), fmt::format("{:.3g}", 1e3 * g.order),
                            fmt::format("{:.3g}", 1e3 * g.shots)});
      fmt::print(stderr, "{}\n", fmt::join(table.rows.back(), ", "));
      const auto patches = static_cast<double>(g.patches);
      edits.points.emplace_back(patches, 1e3 * g.edit);
      shots.points.emplace_back(patches, 1e3 * (g.order + g.shots));
      memory.points.emplace_back(patches, g.bytes / 1e6);
    }
    for (const PlotSeries& series : {edits, shots, memory}) {
      fmt::print(stderr, "{}: grows by the {:.2f}th power of the patches\n", series.name, slope(series.points));
      plot.series.push_back(series);
    }
  }
  if (wanted.writes()) {
    table.write(wanted.folder() / "results.csv");
    plot.note = plot_note();
    write_plot(wanted.folder() / "plot.svg", plot);
  }
  return wanted.check(table, 2, 0.001, {"edit_ms", "edit_kilobytes", "order_ms", "shots_ms"});
}

}  // namespace
}  // namespace exitance

int main(int argc, char** argv) {
  return exitance::run(argc, argv);
}
