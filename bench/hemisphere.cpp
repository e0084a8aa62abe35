// A whole hemisphere, every polygon asked from one point, against rays from the same points in the same run.

#include <benchmark/benchmark.h>

#include <iostream>
#include <map>

#include "bench/measured_room.h"

namespace exitance {
namespace {

constexpr std::uint32_t kRays = 64;
constexpr std::size_t kPoints = 8;

struct Point {
  Receiver receiver;
  std::vector<RaySampledVisibility::Rays> rays;  ///< to some polygons of which something is seen
};

struct Question {
  Question(Scene scene, std::size_t count) : room(std::move(scene)), sampled(room.soup, {.rays = kRays}) {
    std::mt19937_64 random(3);
    Viewpoint view(room.soup);
    while (points.size() < count) {
      Point p{room.random_receiver(random, view), {}};
      const Hemisphere all = look_at_all(room, view);
      require_closure(all, p.receiver);
      if (all.visible == 0) continue;
      while (p.rays.size() < 256) {
        const auto facet = static_cast<std::uint32_t>(below(random, room.facets()));
        if (view.form_factor({facet, {}}, 1e-12).F > 0) {
          p.rays.push_back(sampled.shadow_rays(p.receiver, {facet, {}}, p.rays.size()));
        }
      }
      visible += all.visible;
      points.push_back(std::move(p));
    }
  }

  MeasuredRoom room;
  RaySampledVisibility sampled;
  std::vector<Point> points;
  std::size_t visible = 0;  ///< from all points
};

void measure(benchmark::State& state, const Question& q) {
  Viewpoint view(q.room.soup);
  Median exact, ray;
  std::vector<std::uint8_t> visible(kRays);
  for (auto _ : state) {
    double t_exact = 0, t_ray = 0;
    std::size_t rays = 0;
    for (const Point& p : q.points) {
      t_exact += seconds([&] {
        view.look_from(p.receiver);
        benchmark::DoNotOptimize(look_at_all(q.room, view));
      });
      t_ray += seconds([&] {
        for (const auto& r : p.rays) q.sampled.cast(r.from, r.to, visible);
      });
      rays += p.rays.size() * kRays;
    }
    exact.add(t_exact / static_cast<double>(q.visible));
    ray.add(t_ray / static_cast<double>(rays));
    state.SetIterationTime(t_exact);
  }
  state.counters["visible"] = static_cast<double>(q.visible) / static_cast<double>(q.points.size());
  state.counters["ns_per_visible"] = 1e9 * exact.value();
  state.counters["ray_ns"] = 1e9 * ray.value();
  state.counters["rays_per_visible_polygon"] = exact.value() / ray.value();
}

std::size_t points_for(std::int64_t polygons) {
  return polygons > 10000 ? 2 : kPoints;
}

void hemisphere_of_polygons(benchmark::State& state) {
  static std::map<std::int64_t, Question> questions;
  const auto n = state.range(0);
  auto place = questions.find(n);
  if (place == questions.end()) {
    place = questions.try_emplace(n, make_furnished_room(static_cast<std::uint32_t>(n), 1), points_for(n)).first;
  }
  measure(state, place->second);
}
BENCHMARK(hemisphere_of_polygons)
    ->Arg(500)
    ->Arg(5000)
    ->Arg(60000)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond)
    ->MinTime(2);

void hemisphere_of_triangles(benchmark::State& state) {
  static std::map<std::int64_t, Question> questions;
  const auto n = state.range(0);
  auto place = questions.find(n);
  if (place == questions.end()) {
    place =
        questions
            .try_emplace(n, cut_into_triangles(make_furnished_room(static_cast<std::uint32_t>(n), 1)), points_for(n))
            .first;
  }
  measure(state, place->second);
}
BENCHMARK(hemisphere_of_triangles)
    ->Arg(500)
    ->Arg(5000)
    ->Arg(60000)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond)
    ->MinTime(2);

}  // namespace
}  // namespace exitance

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  try {
    benchmark::RunSpecifiedBenchmarks();
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
}
