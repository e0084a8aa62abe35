// The same object moves in rooms of ever more patches: what do its edits take, in time and in memory?

#include <fmt/format.h>
#include <malloc.h>
#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "experiments/csv_table.h"
#include "experiments/plot_note.h"
#include "experiments/power_law.h"
#include "src/dynamic/edit_session.h"
#include "src/output/plot.h"
#include "src/output/run_clock.h"
#include "src/scene/furnished_room.h"

namespace exitance {
namespace {

constexpr std::uint64_t kSeed = 7;
constexpr std::uint64_t kShotsBefore = 1;

/// A furnished room, one patch a polygon, and a box below the ceiling.
Scene room_with_box(std::uint32_t polygons) {
  Scene scene = make_furnished_room(polygons, kSeed);
  const auto object = static_cast<std::uint32_t>(scene.objects.size());
  scene.objects.push_back({"box", ""});
  const Vec3 low{-0.2, -0.2, 0}, high{0.2, 0.2, 0.3};
  const auto corner = [&](int k) {
    return Vec3{(k & 1) != 0 ? high.x : low.x, (k & 2) != 0 ? high.y : low.y, (k & 4) != 0 ? high.z : low.z};
  };
  for (const auto& face : {std::array{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}) {
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

struct Growth {
  std::size_t patches = 0;
  double edit = 0, rank = 0, shot = 0;  ///< [s] of the processor: an edit, the order of shots after it, one of the shots
  double bytes = 0;                     ///< that an edit adds while the version before is kept
  double tests = 0;                     ///< form factors that a shot takes
};

Growth measure(std::uint32_t polygons, std::uint32_t edits) {
  const Scene scene = room_with_box(polygons);
  const auto object = static_cast<std::uint32_t>(scene.objects.size() - 1);
  Box box;
  for (const Surface& s : scene.surfaces) {
    for (const Vec3& p : s.polygon.outer) box.extend(p);
  }
  Vec3 middle = 0.5 * (box.lower + box.upper);
  middle.z = 2.2;
  EditSession session(scene, {});
  session.apply(step(object, middle, 0));
  Budget some;
  some.shots = kShotsBefore;
  (void)some;
  std::vector<double> edit, rank, shot, bytes, tests;
  for (std::uint32_t k = 1; k <= edits; ++k) {
    const std::size_t heap = heap_bytes();
    RunClock clock;
    session.apply(step(object, middle, k));
    edit.push_back(clock.cpu_seconds());
    bytes.push_back(static_cast<double>(heap_bytes()) - static_cast<double>(heap));
    clock = RunClock();
    session.redistribution_left();
    rank.push_back(clock.cpu_seconds());
    clock = RunClock();
    Budget none; none.shots = 0;
    const SessionWork work = session.work(k == 0 ? some : none);
    shot.push_back(clock.cpu_seconds() / static_cast<double>(work.redistributions + work.propagations));
    tests.push_back(static_cast<double>(work.redistribution.visibility_tests + work.propagation.visibility_tests) /
                    static_cast<double>(work.redistributions + work.propagations));
  }
  return {session.solution().version().present_patches(), median(edit), median(rank), median(shot), median(bytes),
          median(tests)};
}

int run(int argc, char** argv) {
  CLI::App app{"Time and memory of the same edit in rooms of ever more patches"};
  std::string out;
  std::vector<std::uint32_t> rooms{1000, 2000, 4000, 8000, 15000, 30000, 60000};
  app.add_option("-o,--output", out, "Folder for the table and the plot");
  app.add_option("--rooms", rooms, "Numbers of polygons");
  CLI11_PARSE(app, argc, argv);
  for (const std::uint32_t polygons : rooms) {
    const Growth g = measure(polygons, 11);
    fmt::print("{} patches: edit {:.3f} ms, {:.0f} KB; order {:.3f} ms; shot {:.3f} ms, {} tests\n", g.patches, 1e3 * g.edit,
               g.bytes / 1024, 1e3 * g.rank, 1e3 * g.shot, g.tests);
  }
  return 0;
}

}  // namespace
}  // namespace exitance

int main(int argc, char** argv) {
  return exitance::run(argc, argv);
}
