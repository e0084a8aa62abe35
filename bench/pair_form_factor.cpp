// The unobstructed exchange between two polygons: separated, touching, crossing, and between all pairs of an empty
// room.

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

#include "bench/checked_main.h"
#include "geometry/contour_form_factor.h"

namespace exitance {
namespace {

/// A rotation without a zero, so that no coordinate is exact.
Vec3 turned(const Vec3& p) {
  const double s = 1.0 / 7;
  return p.x * Vec3{2 * s, 3 * s, 6 * s} + p.y * Vec3{-6 * s, -2 * s, 3 * s} + p.z * Vec3{3 * s, -6 * s, 2 * s};
}

Radiator triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
  return Radiator(Polygon{{a, b, c}, {}});
}
Radiator plate(const Vec3& o, const Vec3& u, const Vec3& v) {
  return Radiator(Polygon{{o, o + u, o + u + v, o + v}, {}});
}

using Pairs = std::vector<std::pair<Radiator, Radiator>>;

/// Squares whose gap is 2 to 5 times their side.
Pairs separated() {
  std::mt19937_64 random(1);
  const auto real = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
  Pairs pairs;
  while (pairs.size() < 256) {
    const Vec3 o{real(-2, 2), real(-2, 2), real(2, 5)};
    pairs.emplace_back(plate({0, 0, 0}, {1, 0, 0}, {0, 1, 0}), plate(o, {0, 1, 0}, {1, 0, 0}));
  }
  return pairs;
}

/// Squares hinged at an edge.
Pairs touching() {
  Pairs pairs;
  for (int degrees = 10; degrees <= 170; degrees += 10) {
    const double angle = degrees * std::acos(-1.0) / 180;
    pairs.emplace_back(plate({0, 0, 0}, {1, 0, 0}, {0, 1, 0}),
                       plate({0, 0, 0}, {0, 1, 0}, {std::cos(angle), 0, std::sin(angle)}));
  }
  return pairs;
}

/// Triangles that pierce each other's planes.
Pairs crossing() {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> real(-1, 1);
  const auto point = [&] { return Vec3{real(random), real(random), real(random)}; };
  Pairs pairs;
  while (pairs.size() < 256) {
    auto a = triangle(point(), point(), point()), b = triangle(point(), point(), point());
    if (unobstructed_exchange(a, b).integral > 0) pairs.emplace_back(std::move(a), std::move(b));
  }
  return pairs;
}

/// The walls of a cube of side 3, facing in, cut into squares of side 1 / cuts.
std::vector<Radiator> room(int cuts, bool rotated) {
  std::vector<Radiator> patches;
  const double side = 1.0 / cuts;
  for (int axis = 0; axis < 3; ++axis) {
    for (const bool far : {false, true}) {
      for (int i = 0; i < 3 * cuts; ++i) {
        for (int j = 0; j < 3 * cuts; ++j) {
          const auto at = [&](int s, int t) {
            Vec3 p;
            p[axis] = far ? 3 : 0;
            p[(axis + 1) % 3] = s * side;
            p[(axis + 2) % 3] = t * side;
            return rotated ? turned(p) : p;
          };
          std::vector<Vec3> loop{at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)};
          if (far) std::swap(loop[1], loop[3]);
          patches.emplace_back(Polygon{std::move(loop), {}});
        }
      }
    }
  }
  return patches;
}

/// What is exchanged is bounded by the areas and does not depend on the order.
void require_reciprocity(const Pairs& pairs) {
  for (const auto& [a, b] : pairs) {
    const Exchange there = unobstructed_exchange(a, b), back = unobstructed_exchange(b, a);
    const double smaller = std::min(a.area(), b.area());
    if (std::fabs(there.integral - back.integral) > there.error + back.error || !(there.integral <= smaller) ||
        there.error > 1e-12 * smaller) {
      throw std::runtime_error(fmt::format("{:.17g} ± {:.1g} there, {:.17g} ± {:.1g} back", there.integral, there.error,
                                           back.integral, back.error));
    }
  }
}

/// Seconds that a pair takes, of so many an iteration.
benchmark::Counter per_pair(std::size_t pairs) {
  return {static_cast<double>(pairs), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert};
}

void pair_form_factor(benchmark::State& state, const Pairs& pairs) {
  require_reciprocity(pairs);
  for (auto _ : state) {
    for (const auto& [a, b] : pairs) benchmark::DoNotOptimize(unobstructed_exchange(a, b));
  }
  state.counters["per_pair"] = per_pair(pairs.size());
}
BENCHMARK_CAPTURE(pair_form_factor, separated, separated());
BENCHMARK_CAPTURE(pair_form_factor, touching, touching());
BENCHMARK_CAPTURE(pair_form_factor, crossing, crossing());

/// All pairs of 486 patches, whose rows must sum to 1 within 1e-12.
void room_pairs(benchmark::State& state) {
  const std::vector<Radiator> patches = room(3, state.range(0) != 0);
  std::vector<double> sum(patches.size());
  std::size_t pairs = 0;
  for (auto _ : state) {
    pairs = 0;
    std::fill(sum.begin(), sum.end(), 0);
    for (std::size_t i = 0; i < patches.size(); ++i) {
      for (std::size_t j = i + 1; j < patches.size(); ++j, ++pairs) {
        const double exchanged = unobstructed_exchange(patches[i], patches[j]).integral;
        sum[i] += exchanged / patches[i].area();
        sum[j] += exchanged / patches[j].area();
      }
    }
  }
  double worst = 0;
  for (const double s : sum) worst = std::max(worst, std::fabs(s - 1));
  if (worst > 1e-12) throw std::runtime_error(fmt::format("a row misses 1 by {:.2g}", worst));
  state.counters["closure"] = worst;
  state.counters["per_pair"] = per_pair(pairs);
}
BENCHMARK(room_pairs)->ArgName("rotated")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace exitance

int main(int argc, char** argv) {
  return exitance::run_benchmarks(argc, argv);
}
