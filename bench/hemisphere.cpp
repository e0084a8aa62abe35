// A whole hemisphere: every polygon of a room asked from one point, against rays from the same points, in turns.

#include <map>

#include "bench/checked_main.h"
#include "src/visibility/measured_room.h"

namespace exitance {
namespace {

struct View {
  Receiver receiver;
  std::vector<ShadowRays::Rays> shadow_rays;  ///< to some of the facets that are seen, drawn at random
};

struct Hemispheres {
  Hemispheres(Scene scene, std::size_t count) : room(std::move(scene)), rays(room.soup, {.rays = kRays}) {
    constexpr std::size_t kSources = 256;
    std::mt19937_64 random(3);
    Viewpoint view(room.soup);
    while (views.size() < count) {
      View v{receiver_at(random_element(room, random)), {}};
      const Hemisphere all = look_around(room, view, v.receiver);
      require_closure(all, v.receiver);
      visible += all.visible;
      while (v.shadow_rays.size() < kSources) {
        const Source source{static_cast<std::uint32_t>(below(random, room.facets())), {}};
        if (view.form_factor(source, kPointTolerance).F > 0) {
          v.shadow_rays.push_back(rays.shadow_rays(v.receiver, source, v.shadow_rays.size()));
        }
      }
      views.push_back(std::move(v));
    }
  }

  MeasuredRoom room;
  ShadowRays rays;
  std::vector<View> views;
  std::size_t visible = 0;  ///< facets, from all points together
};

/// Counters: `visible` polygons from one point; exact_ns for each of them; ray_ns a packet ray, nothing but its
/// casting; and what a visible polygon costs in such rays.
void measure(benchmark::State& state, const Hemispheres& h) {
  Viewpoint view(h.room.soup);
  std::vector<double> exact, ray;
  std::array<std::uint8_t, kRays> visible;
  for (auto _ : state) {
    double exact_seconds = 0, ray_seconds = 0;
    std::size_t casts = 0;
    for (const View& v : h.views) {
      exact_seconds += seconds([&] { benchmark::DoNotOptimize(look_around(h.room, view, v.receiver)); });
      ray_seconds += seconds([&] {
        for (const auto& r : v.shadow_rays) h.rays.cast(r.from, r.to, visible);
      });
      casts += v.shadow_rays.size();
    }
    exact.push_back(exact_seconds / static_cast<double>(h.visible));
    ray.push_back(ray_seconds / static_cast<double>(casts * kRays));
    state.SetIterationTime(exact_seconds);
  }
  state.counters["visible"] = static_cast<double>(h.visible) / static_cast<double>(h.views.size());
  state.counters["exact_ns"] = 1e9 * median(exact);
  state.counters["ray_ns"] = 1e9 * median(ray);
  state.counters["rays_per_visible_polygon"] = median(exact) / median(ray);
}

std::size_t view_count(std::int64_t polygons) {
  return polygons > 10000 ? 4 : 8;
}

void hemisphere(benchmark::State& state) {
  static std::map<std::int64_t, Hemispheres> made;
  const std::int64_t n = state.range(0);
  if (!made.contains(n)) made.try_emplace(n, furnished_room(n), view_count(n));
  measure(state, made.at(n));
}
BENCHMARK(hemisphere)->Apply(in_rooms_of_each_size);

/// The same rooms with every face cut into triangles, which are then the polygons.
void hemisphere_of_triangles(benchmark::State& state) {
  static std::map<std::int64_t, Hemispheres> made;
  const std::int64_t n = state.range(0);
  if (!made.contains(n)) made.try_emplace(n, cut_into_triangles(furnished_room(n)), view_count(n));
  measure(state, made.at(n));
}
BENCHMARK(hemisphere_of_triangles)->Apply(in_rooms_of_each_size);

}  // namespace
}  // namespace exitance

int main(int argc, char** argv) {
  return exitance::run_benchmarks(argc, argv);
}
