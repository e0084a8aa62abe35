#include "src/form_factor/pair_sample.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <random>

#include "geometry/contour_form_factor.h"
#include "geometry/shaft.h"
#include "src/form_factor/obstructed_exchange.h"

namespace exitance {
namespace {

struct SampledPair {
  std::uint32_t i = 0, j = 0;
  Exchange found;  ///< by the run
};

/// The row's place among the parts.
struct RowPlace {
  std::uint32_t row = 0;
  std::size_t part = 0, place = 0;
};

/// All partial pairs are counted in the order of their patches, whatever parts they are in, and drawn by number.
std::vector<SampledPair> draw(const ExchangeScene& scene, std::span<const PairRows> rows, std::size_t count,
                              std::uint64_t seed) {
  std::vector<RowPlace> order;
  for (std::size_t part = 0; part < rows.size(); ++part) {
    for (std::size_t r = 0; r < rows[part].row.size(); ++r) order.push_back({rows[part].row[r], part, r});
  }
  std::ranges::sort(order, {}, &RowPlace::row);
  const auto for_each_partial = [&](const auto& visit) {
    for (const RowPlace& at : order) {
      const PairRows& part = rows[at.part];
      for (std::uint64_t k = part.row_first[at.place]; k < part.row_first[at.place + 1]; ++k) {
        if (class_of(part.mark[k]) == PairClass::partial && part.column[k] != at.row) visit(at.row, part, k);
      }
    }
  };
  std::uint64_t partial = 0;
  for_each_partial([&](std::uint32_t, const PairRows&, std::uint64_t) { ++partial; });

  std::vector<std::uint64_t> drawn;
  std::mt19937_64 random(seed);
  if (partial <= count) {
    for (std::uint64_t k = 0; k < partial; ++k) drawn.push_back(k);
  } else {
    // As many as wanted, almost: the same pair drawn twice is looked at once.
    for (std::size_t k = 0; k < count; ++k) drawn.push_back(random() % partial);
    std::ranges::sort(drawn);
    drawn.erase(std::unique(drawn.begin(), drawn.end()), drawn.end());
  }
  std::vector<SampledPair> pairs;
  std::uint64_t number = 0;
  auto next = drawn.begin();
  for_each_partial([&](std::uint32_t i, const PairRows& part, std::uint64_t k) {
    if (next == drawn.end() || *next != number++) return;
    ++next;
    const double A = scene.area(i);
    pairs.push_back({i, part.column[k], {part.F[k] * A, part.F_error[k] * A}});
  });
  return pairs;
}

void add(Exchange& sum, const Exchange& more) {
  sum.integral += more.integral;
  sum.error += more.error;
}

/// What one pair exchanges [m²], by three ways that share no integral.
struct Recomputed {
  Exchange over_i, over_j, unobstructed;
};

Recomputed recompute(const ExchangeScene& scene, Viewpoint& view, const SampledPair& pair, const PairOptions& options) {
  Recomputed result;
  const auto a = scene.pieces(pair.i), b = scene.pieces(pair.j);
  const double smaller = std::min(scene.area(pair.i), scene.area(pair.j));
  const double needed = std::max(options.tolerance * smaller, options.relative * pair.found.integral) /
                        static_cast<double>(a.size() * b.size());
  std::vector<std::uint32_t> items;
  for (const ExchangeScene::Piece& p : a) {
    for (const ExchangeScene::Piece& q : b) {
      Shaft shaft(scene.soup(), {p.source.facet, p.source.loop}, {q.source.facet, q.source.loop});
      if (!shaft.face_each_other()) continue;
      const Exchange open = unobstructed_exchange(p.radiator, q.radiator);
      add(result.unobstructed, open);
      const Shaft::Overlap overlap = shaft.find_occluders(items);
      if (overlap == Shaft::Overlap::blocking) continue;
      if (overlap == Shaft::Overlap::outside) {
        add(result.over_i, open);
        add(result.over_j, open);
        continue;
      }
      const auto over = [&](const ExchangeScene::Piece& receiver, const ExchangeScene::Piece& source) {
        ObstructedExchange exchange(scene.soup(), receiver.source, source.source, items);
        exchange.refine(view, needed, options.points, options.stop);
        return Exchange{exchange.integral(), exchange.error()};
      };
      add(result.over_i, over(p, q));
      add(result.over_j, over(q, p));
    }
  }
  return result;
}

bool by_share(const PairDefect& a, const PairDefect& b) {
  return a.share() < b.share();
}

}  // namespace

PairSample sample_pairs(const ExchangeScene& scene, std::span<const PairRows> rows, const PairOptions& options,
                        std::size_t count, std::uint64_t seed) {
  const std::vector<SampledPair> pairs = draw(scene, rows, count, seed);
  PairSample sample;
  sample.reciprocity.resize(pairs.size());
  sample.beyond_unobstructed.resize(pairs.size());
  const auto is_over = [&] { return options.stop && options.stop(); };
  tbb::enumerable_thread_specific<Viewpoint> views([&] { return Viewpoint(scene.soup()); });
  std::atomic<bool> stopped = false;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, pairs.size(), 1), [&](const auto& some) {
    for (std::size_t k = some.begin(); k < some.end() && !stopped; ++k) {
      if (is_over()) stopped = true;
      const SampledPair& pair = pairs[k];
      const double smaller = std::min(scene.area(pair.i), scene.area(pair.j));
      const Recomputed again = recompute(scene, views.local(), pair, options);
      const auto against = [&](const Exchange& other) {
        return PairDefect{pair.i, pair.j, std::fabs(other.integral - pair.found.integral) / smaller,
                          (other.error + pair.found.error) / smaller};
      };
      sample.reciprocity[k] = std::max(against(again.over_i), against(again.over_j), by_share);
      sample.beyond_unobstructed[k] = {pair.i, pair.j, (pair.found.integral - again.unobstructed.integral) / smaller,
                                       (pair.found.error + again.unobstructed.error) / smaller};
    }
  });
  if (stopped || is_over()) return {.reciprocity = {}, .beyond_unobstructed = {}, .complete = false};
  return sample;
}

}  // namespace exitance
