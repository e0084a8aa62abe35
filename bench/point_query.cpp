// One exact, partially occluded query from a point to a polygon, against rays for the same pairs in the same run.

#include <benchmark/benchmark.h>

#include <iostream>
#include <map>

#include "bench/measured_room.h"

namespace exitance {
namespace {

constexpr std::uint32_t kRays = 64;
constexpr std::size_t kPairs = 256;

struct Pair {
  Receiver receiver;
  std::uint32_t facet = 0;
  double F = 0;
};

/// Pairs of sample points and facets that something stands between: front seen, neither open nor blocked.
std::vector<Pair> partially_occluded_pairs(const MeasuredRoom& room) {
  std::mt19937_64 random(2);
  Viewpoint view(room.soup);
  std::vector<Pair> pairs;
  while (pairs.size() < kPairs) {
    const Receiver receiver = room.random_receiver(random, view);
    for (int k = 0; k < 50; ++k) {
      const auto facet = static_cast<std::uint32_t>(below(random, room.facets()));
      const PointFormFactor f = view.form_factor({facet, {}}, 1e-12);
      if (f.side == Side::front && f.visibility == Visibility::partial && f.F > 0) {
        pairs.push_back({receiver, facet, f.F});
        break;
      }
    }
  }
  return pairs;
}

struct Question {
  explicit Question(std::uint32_t polygons)
      : room(polygons), pairs(partially_occluded_pairs(room)), sampled(room.soup, {.rays = kRays}) {
    verify();
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      rays.push_back(sampled.shadow_rays(pairs[k].receiver, {pairs[k].facet, {}}, k));
    }
  }

  /// Rays must agree within their statistics, and hemispheres must be whole.
  void verify() const {
    const RaySampledVisibility many(room.soup, {.rays = 1024, .replicates = 16});
    std::size_t far = 0;
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      const SampledFormFactor f = many.form_factor(pairs[k].receiver, {pairs[k].facet, {}}, k);
      const double sigma = std::fabs(f.F - pairs[k].F) / f.standard_error;
      if (sigma > 6 && std::fabs(f.F - pairs[k].F) > 1e-3 * f.F) {
        ++far;
        {
          const auto& r = pairs[k].receiver;
          std::cerr << fmt::format(
              "receiver ({:.17g},{:.17g},{:.17g}) n ({:.3g},{:.3g},{:.3g}) {} source {}:", r.point.x, r.point.y,
              r.point.z, r.normal.x, r.normal.y, r.normal.z,
              room.scene.objects[room.scene.surfaces[room.soup.facets()[r.facet].polygon].object].name,
              room.scene.objects[room.scene.surfaces[room.soup.facets()[pairs[k].facet].polygon].object].name);
          for (const Corner& c : room.soup.corners(room.soup.facets()[pairs[k].facet])) {
            const Vec3 v = room.soup.vertices()[c.vertex];
            std::cerr << fmt::format(" ({:.6g},{:.6g},{:.6g})", v.x, v.y, v.z);
          }
          std::cerr << '\n';
        }
        std::cerr << fmt::format("pair {}: exact {:.6g} rays {:.6g} ± {:.2g} ({:.1f} sigma)\n", k, pairs[k].F, f.F,
                                 f.standard_error, sigma);
      }
    }
    std::cerr << far << " far\n";
    Viewpoint view(room.soup);
    for (std::size_t k = 0; k < 2; ++k) {
      view.look_from(pairs[k].receiver);
      require_closure(look_at_all(room, view), pairs[k].receiver);
    }
  }

  MeasuredRoom room;
  std::vector<Pair> pairs;
  RaySampledVisibility sampled;
  std::vector<RaySampledVisibility::Rays> rays;
};

const Question& question(std::uint32_t polygons) {
  static std::map<std::uint32_t, Question> questions;
  return questions.try_emplace(polygons, polygons).first->second;
}

void point_query(benchmark::State& state) {
  const Question& q = question(static_cast<std::uint32_t>(state.range(0)));
  Viewpoint view(q.room.soup);
  Median exact, sampled, cast;
  std::vector<std::uint8_t> visible(kRays);
  for (auto _ : state) {
    const double t_exact = seconds([&] {
      for (const Pair& p : q.pairs) {
        view.look_from(p.receiver);
        benchmark::DoNotOptimize(view.form_factor({p.facet, {}}, 1e-12));
      }
    });
    const double t_sampled = seconds([&] {
      for (std::size_t k = 0; k < q.pairs.size(); ++k) {
        benchmark::DoNotOptimize(q.sampled.form_factor(q.pairs[k].receiver, {q.pairs[k].facet, {}}, k));
      }
    });
    const double t_cast = seconds([&] {
      for (const auto& r : q.rays) q.sampled.cast(r.from, r.to, visible);
    });
    exact.add(t_exact / kPairs);
    sampled.add(t_sampled / kPairs);
    cast.add(t_cast / (kPairs * kRays));
    state.SetIterationTime(t_exact);
  }
  state.counters["exact_ns"] = 1e9 * exact.value();
  state.counters["sobol64_ns"] = 1e9 * sampled.value();
  state.counters["ray_ns"] = 1e9 * cast.value();
  state.counters["rays_per_query"] = exact.value() / cast.value();
  state.counters["sobol_rays_per_query"] = kRays * exact.value() / sampled.value();
}
BENCHMARK(point_query)->Arg(500)->Arg(5000)->Arg(60000)->UseManualTime()->Unit(benchmark::kMillisecond)->MinTime(2);

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
