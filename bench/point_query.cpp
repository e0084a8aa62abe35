// One exact answer to "what does this point see of that polygon?" behind occluders, against rays for the same pairs.
// The three are timed in turns, block by block, so that whatever disturbs the machine disturbs all of them.

#include <map>

#include "bench/checked_main.h"
#include "src/visibility/measured_room.h"

namespace exitance {
namespace {

constexpr std::size_t kPairs = 256;

struct Pair {
  Receiver receiver;
  Source source;
};

/// Pairs of sample points and facets, drawn at random, of which rays see 1 to 99 % from the front.
struct Questions {
  explicit Questions(std::int64_t polygons) : room(furnished_room(polygons)), rays(room.soup, {.rays = kRays}) {
    std::mt19937_64 random(2);
    Viewpoint view(room.soup);
    const ShadowRays many(room.soup, {.rays = 1024, .replicates = 16});
    const ShadowRays farther(room.soup, {.rays = 1024, .replicates = 16, .offset = 2 * RayOptions{}.offset});
    while (pairs.size() < kPairs) {
      const Element& element = random_element(room, random);
      const Pair pair{receiver_at(element), {static_cast<std::uint32_t>(below(random, room.facets())), {}}};
      view.look_from(pair.receiver);
      const PointFormFactor exact = view.form_factor(pair.source, kPointTolerance);
      if (exact.side != Side::front || exact.visibility == Visibility::away) continue;
      const std::uint64_t seed = pairs.size();
      const SampledFormFactor sampled = many.form_factor(pair.receiver, pair.source, seed);
      require_agreement(pair, exact, sampled, farther.form_factor(pair.receiver, pair.source, seed));
      const double share = sampled.F / sampled.F_unoccluded;
      if (!(0.01 < share && share < 0.99)) continue;
      pairs.push_back(pair);
      shadow_rays.push_back(rays.shadow_rays(pair.receiver, pair.source, seed));
    }
    for (std::size_t k = 0; k < 2; ++k) require_closure(look_around(room, view, pairs[k].receiver), pairs[k].receiver);
  }

  /// Rays know F to six standard errors, to ten rays' share, to the bias of their offset, which is at most proportional
  /// to it, so that twice the offset changes F by as much as the bias (three times that is allowed: it may level off),
  /// and to the rounding of Lambert's formula in double precision.
  static void require_agreement(const Pair& pair, const PointFormFactor& exact, const SampledFormFactor& sampled,
                                const SampledFormFactor& farther) {
    const double allowed = 6 * (sampled.standard_error + farther.standard_error) +
                           3 * std::fabs(sampled.F - farther.F) + 10.0 / (16 * 1024) * sampled.F_unoccluded + 1e-14;
    if (std::fabs(exact.F - sampled.F) <= allowed + exact.error) return;
    const Vec3 x = pair.receiver.point;
    throw std::runtime_error(fmt::format(
        "from point ({:.17g}, {:.17g}, {:.17g}) on facet {} to facet {}: F = {:.6g} exactly, {:.6g} ± {:.1g} by rays",
        x.x, x.y, x.z, pair.receiver.facet, pair.source.facet, exact.F, sampled.F, allowed));
  }

  MeasuredRoom room;
  ShadowRays rays;
  std::vector<Pair> pairs;
  std::vector<ShadowRays::Rays> shadow_rays;  ///< of each pair
};

const Questions& questions(std::int64_t polygons) {
  static std::map<std::int64_t, Questions> made;
  return made.try_emplace(polygons, polygons).first->second;
}

/// Counters: exact_ns a query; ray_ns a packet ray, nothing but its casting, the points it goes to being known;
/// sobol_ns a ray of the whole estimate by 64 Sobol rays; and what a query costs in both kinds of rays.
void point_query(benchmark::State& state) {
  const Questions& q = questions(state.range(0));
  Viewpoint view(q.room.soup);
  std::vector<double> exact, ray, sobol;
  std::array<std::uint8_t, kRays> visible;
  for (auto _ : state) {
    const double exact_seconds = seconds([&] {
      for (const Pair& p : q.pairs) {
        view.look_from(p.receiver);
        benchmark::DoNotOptimize(view.form_factor(p.source, kPointTolerance));
      }
    });
    ray.push_back(seconds([&] {
      for (const auto& r : q.shadow_rays) q.rays.cast(r.from, r.to, visible);
    }));
    sobol.push_back(seconds([&] {
      for (std::size_t k = 0; k < q.pairs.size(); ++k) {
        benchmark::DoNotOptimize(q.rays.form_factor(q.pairs[k].receiver, q.pairs[k].source, k));
      }
    }));
    exact.push_back(exact_seconds);
    state.SetIterationTime(exact_seconds);
  }
  const double exact_ns = 1e9 * median(exact) / kPairs, ray_ns = 1e9 * median(ray) / (kPairs * kRays),
               sobol_ns = 1e9 * median(sobol) / (kPairs * kRays);
  state.counters["exact_ns"] = exact_ns;
  state.counters["ray_ns"] = ray_ns;
  state.counters["sobol_ns"] = sobol_ns;
  state.counters["rays_per_query"] = exact_ns / ray_ns;
  state.counters["sobol_per_query"] = exact_ns / sobol_ns;
}
BENCHMARK(point_query)->Apply(in_rooms_of_each_size);

}  // namespace
}  // namespace exitance

int main(int argc, char** argv) {
  return exitance::run_benchmarks(argc, argv);
}
