// Whole matrices of form factors between patches: the room with a box on its floor, by one thread and by two, in turns.

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <chrono>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "bench/checked_main.h"
#include "src/form_factor/pair_rows.h"
#include "src/scene/reader.h"
#include "src/visibility/measured_room.h"
#include "tests/places.h"

namespace exitance {
namespace {

struct Matrix {
  FormFactorMatrix F;
  PairStatistics statistics;
  double seconds = 0;  ///< by the clock on the wall
};

Matrix matrix_by(const ExchangeScene& scene, const PairOptions& options, std::size_t threads) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  std::vector<std::uint32_t> rows(scene.size());
  std::iota(rows.begin(), rows.end(), 0u);
  Matrix matrix;
  const auto start = std::chrono::steady_clock::now();
  const PairRows pairs = pair_rows(scene, rows, options, matrix.statistics);
  matrix.F = matrix_of(std::span(&pairs, 1), static_cast<std::uint32_t>(scene.size()));
  matrix.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return matrix;
}

/// Every row of a closed room sums to 1 within the errors of its entries.
void require_closure(const FormFactorMatrix& F) {
  for (std::size_t i = 0; i < F.rows(); ++i) {
    const auto row = F.row(i), error = F.row_error(i);
    const double sum = std::accumulate(row.begin(), row.end(), 0.0);
    if (std::fabs(sum - 1) > std::accumulate(error.begin(), error.end(), 1e-14)) {
      throw std::runtime_error(fmt::format("row {} sums to 1{:+.2g}", i, sum - 1));
    }
  }
}

/// Arguments: patches an edge of 3 m, and the digits of the tolerance. Counters: seconds of one thread, in all and of
/// each class of pairs, and the speed-up of two.
void room_with_box(benchmark::State& state) {
  const Scene scene = read_scene(source_file("data/box_on_floor.toml"));
  const PolygonSoup soup = make_soup(scene);
  MeshOptions mesh_options;
  mesh_options.patch_size = 3.0001 / static_cast<double>(state.range(0));
  const PatchMesh mesh = make_patch_mesh(scene, soup, mesh_options);
  const ExchangeScene exchange(soup, mesh);
  PairOptions options;
  options.tolerance = std::pow(10.0, -static_cast<double>(state.range(1)));
  std::vector<double> one, two;
  Matrix last;
  for (auto _ : state) {
    Matrix by_one = matrix_by(exchange, options, 1);
    const Matrix by_two = matrix_by(exchange, options, 2);
    require_closure(by_one.F);
    if (by_one.F.F != by_two.F.F || by_one.F.F_error != by_two.F.F_error) {
      throw std::runtime_error("two threads give other bits than one");
    }
    one.push_back(by_one.seconds);
    two.push_back(by_two.seconds);
    state.SetIterationTime(by_one.seconds);
    last = std::move(by_one);
  }
  state.counters["patches"] = static_cast<double>(exchange.size());
  state.counters["seconds"] = median(one);
  state.counters["speed_up"] = median(one) / median(two);
  state.counters["open_s"] = last.statistics.seconds[static_cast<std::size_t>(PairClass::open)];
  state.counters["partial_s"] = last.statistics.seconds[static_cast<std::size_t>(PairClass::partial)];
  state.counters["points"] = static_cast<double>(last.statistics.points);
  state.counters["unreached"] = static_cast<double>(last.statistics.unreached);
}
BENCHMARK(room_with_box)
    ->ArgNames({"squares_an_edge", "digits"})
    ->Args({9, 3})
    ->Args({9, 6})
    ->Args({9, 9})
    ->Args({9, 12})
    ->UseManualTime()
    ->MinTime(1)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace exitance

int main(int argc, char** argv) {
  return exitance::run_benchmarks(argc, argv);
}
