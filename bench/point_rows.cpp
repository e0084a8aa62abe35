// Rows of form factors by one thread and by two, in turns.

#include "src/form_factor/point_rows.h"

#include <tbb/global_control.h>

#include <chrono>

#include "bench/checked_main.h"
#include "src/visibility/measured_room.h"

namespace exitance {
namespace {

constexpr std::size_t kRows = 128;

/// Rows from the middle of the room, and how long they take by the clock on the wall [s].
PointRows timed_rows(const MeasuredRoom& room, std::size_t threads, double& wall_seconds) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  const std::size_t first = room.mesh.elements.size() / 2;
  const auto start = std::chrono::steady_clock::now();
  PointRows rows = point_rows(ExactVisibility(room.mesh, room.soup), first, first + kRows);
  wall_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return rows;
}

void require_same(const PointRows& one, const PointRows& two) {
  if (one.F.column != two.F.column || one.F.F != two.F.F || one.F.F_error != two.F.F_error) {
    throw std::runtime_error("two threads give other bits than one");
  }
  if (!(one.statistics.closure_max_defect < 1e-12)) {
    throw std::runtime_error(fmt::format("a row misses 1 by {:.2g}", one.statistics.closure_max_defect));
  }
}

/// Counters: speed_up of two threads; row_ms of one. Both are by the clock on the wall and mean something on an idle
/// machine of two cores or more.
void point_rows_by_two_threads(benchmark::State& state) {
  const MeasuredRoom room(furnished_room(state.range(0)));
  std::vector<double> one, two;
  for (auto _ : state) {
    double one_seconds = 0, two_seconds = 0;
    const PointRows by_one = timed_rows(room, 1, one_seconds);
    require_same(by_one, timed_rows(room, 2, two_seconds));
    one.push_back(one_seconds);
    two.push_back(two_seconds);
    state.SetIterationTime(two_seconds);
  }
  state.counters["row_ms"] = 1e3 * median(one) / kRows;
  state.counters["speed_up"] = median(one) / median(two);
}
BENCHMARK(point_rows_by_two_threads)
    ->ArgName("polygons")
    ->Arg(5000)
    ->UseManualTime()
    ->MinTime(2)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace exitance

int main(int argc, char** argv) {
  return exitance::run_benchmarks(argc, argv);
}
