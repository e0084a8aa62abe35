#include "src/form_factor/pair_rows.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <numeric>

namespace exitance {
namespace {

constexpr std::uint8_t kReached = 0x80;

/// Pairs of one row that a thread works on: rows take too differently long to be given out whole.
struct Stretch {
  std::size_t row = 0;  ///< its place among the rows asked for
  std::uint32_t first = 0, last = 0;
  std::vector<std::uint32_t> column = {};
  std::vector<PairFormFactor> pair = {};
  PairStatistics statistics = {};
  bool finished = false;
};

std::vector<Stretch> stretches_of(std::span<const std::uint32_t> rows, std::uint32_t patches) {
  constexpr std::uint32_t kPairs = 32;
  std::vector<Stretch> stretches;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (std::uint32_t j = rows[r]; j < patches; j += std::min(kPairs, patches - j)) {
      stretches.push_back({.row = r, .first = j, .last = j + std::min(kPairs, patches - j)});
    }
  }
  return stretches;
}

/// Whether a corner of one lies in front of the other's plane, but for rounding.
bool reaches_before(const RadiatorFacet& one, const RadiatorFacet& other) {
  return std::ranges::any_of(one.loop, [&](const Vec3& v) { return dot(other.normal, v - other.loop[0]) > 0; });
}

bool seem_to_face(std::span<const ExchangeScene::Piece> a, std::span<const ExchangeScene::Piece> b) {
  for (const ExchangeScene::Piece& p : a) {
    for (const ExchangeScene::Piece& q : b) {
      const RadiatorFacet &of_p = p.radiator.facets()[0], &of_q = q.radiator.facets()[0];
      if (reaches_before(of_p, of_q) && reaches_before(of_q, of_p)) return true;
    }
  }
  return false;
}

}  // namespace

std::uint8_t mark_of(const PairFormFactor& pair) {
  return static_cast<std::uint8_t>(static_cast<std::uint8_t>(pair.kind) | (pair.reached ? kReached : 0));
}
PairClass class_of(std::uint8_t mark) {
  return static_cast<PairClass>(mark & 3);
}
bool reached_of(std::uint8_t mark) {
  return (mark & kReached) != 0;
}

PairStatistics& PairStatistics::operator+=(const PairStatistics& other) {
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    pairs[k] += other.pairs[k];
    seconds[k] += other.seconds[k];
  }
  points += other.points;
  unreached += other.unreached;
  return *this;
}

PairRows pair_rows(const ExchangeScene& scene, std::span<const std::uint32_t> rows, const PairOptions& options,
                   PairStatistics& statistics) {
  using Clock = std::chrono::steady_clock;
  const auto is_over = [&] { return options.stop && options.stop(); };
  std::vector<Stretch> stretches = stretches_of(rows, static_cast<std::uint32_t>(scene.size()));
  tbb::enumerable_thread_specific<PairIntegrator> integrators([&] { return PairIntegrator(scene); });
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, stretches.size(), 1), [&](const auto& some) {
    PairIntegrator& integrator = integrators.local();
    for (std::size_t s = some.begin(); s < some.end(); ++s) {
      Stretch& stretch = stretches[s];
      if (is_over()) return;
      auto before = Clock::now();
      for (std::uint32_t j = stretch.first; j < stretch.last; ++j) {
        const PairFormFactor pair = integrator.form_factor(rows[stretch.row], j, options);
        if (is_over()) return;
        const auto now = Clock::now();
        const auto kind = static_cast<std::size_t>(pair.kind);
        ++stretch.statistics.pairs[kind];
        stretch.statistics.seconds[kind] += std::chrono::duration<double>(now - before).count();
        stretch.statistics.points += pair.points;
        stretch.statistics.unreached += !pair.reached;
        before = now;
        if (pair.kind == PairClass::facing_away) continue;
        stretch.column.push_back(j);
        stretch.pair.push_back(pair);
      }
      stretch.finished = true;
    }
  });
  PairRows result;
  auto stretch = stretches.begin();
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const auto end = std::find_if(stretch, stretches.end(), [&](const Stretch& s) { return s.row != r; });
    if (!std::all_of(stretch, end, [](const Stretch& s) { return s.finished; })) {
      stretch = end;
      continue;
    }
    result.row.push_back(rows[r]);
    for (; stretch != end; ++stretch) {
      for (std::size_t k = 0; k < stretch->pair.size(); ++k) {
        const PairFormFactor& pair = stretch->pair[k];
        result.column.push_back(stretch->column[k]);
        result.F.push_back(pair.F);
        result.F_error.push_back(pair.F_error);
        result.F_reverse.push_back(pair.F_reverse);
        result.F_reverse_error.push_back(pair.F_reverse_error);
        result.mark.push_back(mark_of(pair));
      }
      statistics += stretch->statistics;
    }
    result.row_first.push_back(result.column.size());
  }
  return result;
}

void append(PairRows& rows, const PairRows& more) {
  const std::uint64_t before = rows.column.size();
  const auto join = [](auto& all, const auto& some) { all.insert(all.end(), some.begin(), some.end()); };
  join(rows.row, more.row);
  for (std::size_t r = 1; r < more.row_first.size(); ++r) rows.row_first.push_back(before + more.row_first[r]);
  join(rows.column, more.column);
  join(rows.F, more.F);
  join(rows.F_error, more.F_error);
  join(rows.F_reverse, more.F_reverse);
  join(rows.F_reverse_error, more.F_reverse_error);
  join(rows.mark, more.mark);
}

std::array<std::uint64_t, 4> pairs_by_class(std::span<const PairRows> rows, std::uint64_t patches) {
  std::array<std::uint64_t, 4> pairs{};
  for (const PairRows& part : rows) {
    for (const std::uint8_t mark : part.mark) ++pairs[static_cast<std::size_t>(class_of(mark))];
  }
  const std::uint64_t kept = std::accumulate(pairs.begin(), pairs.end(), std::uint64_t{0});
  pairs[static_cast<std::size_t>(PairClass::facing_away)] = patches * (patches + 1) / 2 - kept;
  return pairs;
}

double expected_pair_density(const ExchangeScene& scene) {
  constexpr std::size_t kSample = 256;  // of the rows, and of the columns of each
  const std::size_t n = scene.size(), count = std::min(n, kSample);
  if (n == 0) return 0;
  const auto sampled = [&](std::size_t k) { return n * (2 * k + 1) / (2 * count); };
  std::size_t facing = 0;
  for (std::size_t r = 0; r < count; ++r) {
    for (std::size_t c = 0; c < count; ++c) {
      facing += seem_to_face(scene.pieces(sampled(r)), scene.pieces(sampled(c)));
    }
  }
  return static_cast<double>(facing) / static_cast<double>(count * count);
}

std::uint64_t pair_rows_bytes(std::uint64_t patches, double density) {
  // Of a pair: column, four numbers and a mark in its row; two entries in the matrix, twice while it is being sorted.
  constexpr double kPair = sizeof(std::uint32_t) + 4 * sizeof(double) + sizeof(std::uint8_t);
  constexpr double kEntry = sizeof(std::uint32_t) + 2 * sizeof(double);
  const double n = static_cast<double>(patches), pairs = density * n * (n + 1) / 2;
  return static_cast<std::uint64_t>(std::min(pairs * (kPair + 4 * kEntry) + 64 * n, 0x1p63));
}

FormFactorMatrix matrix_of(std::span<const PairRows> rows, std::uint32_t patches) {
  const auto for_each_entry = [&](const auto& visit) {
    for (const PairRows& part : rows) {
      for (std::size_t r = 0; r < part.row.size(); ++r) {
        for (std::uint64_t k = part.row_first[r]; k < part.row_first[r + 1]; ++k) {
          const std::uint32_t i = part.row[r], j = part.column[k];
          if (part.F[k] == 0 && part.F_error[k] == 0) continue;
          visit(i, j, part.F[k], part.F_error[k]);
          if (i != j) visit(j, i, part.F_reverse[k], part.F_reverse_error[k]);
        }
      }
    }
  };
  FormFactorMatrix matrix;
  matrix.columns = patches;
  matrix.row_first.assign(patches + std::size_t{1}, 0);
  for_each_entry([&](std::uint32_t i, std::uint32_t, double, double) { ++matrix.row_first[i + 1]; });
  for (std::size_t i = 0; i < patches; ++i) matrix.row_first[i + 1] += matrix.row_first[i];
  const std::size_t entries = matrix.row_first.back();
  FormFactorMatrix unsorted;  // by row, in the order in which they are met
  unsorted.column.resize(entries);
  unsorted.F.resize(entries);
  unsorted.F_error.resize(entries);
  std::vector<std::uint64_t> next(matrix.row_first.begin(), matrix.row_first.end() - 1);
  for_each_entry([&](std::uint32_t i, std::uint32_t j, double F, double F_error) {
    const std::uint64_t place = next[i]++;
    unsorted.column[place] = j;
    unsorted.F[place] = F;
    unsorted.F_error[place] = F_error;
  });
  matrix.column.resize(entries);
  matrix.F.resize(entries);
  matrix.F_error.resize(entries);
  std::vector<std::uint64_t> order;
  for (std::size_t i = 0; i < patches; ++i) {
    order.clear();
    for (std::uint64_t k = matrix.row_first[i]; k < matrix.row_first[i + 1]; ++k) order.push_back(k);
    std::ranges::sort(order, {}, [&](std::uint64_t k) { return unsorted.column[k]; });
    std::uint64_t place = matrix.row_first[i];
    for (const std::uint64_t k : order) {
      matrix.column[place] = unsorted.column[k];
      matrix.F[place] = unsorted.F[k];
      matrix.F_error[place] = unsorted.F_error[k];
      ++place;
    }
  }
  return matrix;
}

}  // namespace exitance
