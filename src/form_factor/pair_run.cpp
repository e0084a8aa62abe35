#include "src/form_factor/pair_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <span>

#include "src/form_factor/kept_rows.h"
#include "src/output/manifest.h"

namespace exitance {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// How many rows to ask for at a time, so that it takes a fraction of a block.
class Stride {
 public:
  explicit Stride(double block_seconds) : aim_(0.5 * block_seconds) {}

  std::size_t rows() const { return rows_; }
  void learn(double seconds) {
    const double fitting = aim_ / std::max(seconds, 1e-6) * static_cast<double>(rows_);
    rows_ = static_cast<std::size_t>(std::clamp(fitting, 1.0, 4 * static_cast<double>(rows_)));
  }

 private:
  std::size_t rows_ = 1;
  double aim_;
};

std::vector<PairRows> finished_rows(Checkpoint& checkpoint) {
  try {
    return kept_pairs(checkpoint);
  } catch (const DamagedFile& damaged) {
    throw InputError(damaged.path().string(), 0, damaged.damage() + "; remove it, and its rows are computed again");
  }
}

}  // namespace

std::uint64_t PairRun::unreached() const {
  std::uint64_t count = 0;
  for (const PairRows& part : rows)
    for (const std::uint8_t mark : part.mark) count += !reached_of(mark);
  return count;
}

std::string pair_run_key(const std::string& scene_hash, double patch_size, const PairOptions& pairs) {
  return build_key() + fmt::format("scene {}\npatch_size {}\ntolerance {}\nrelative {}\npoints {}\n", scene_hash,
                                   patch_size, pairs.tolerance, pairs.relative, pairs.points);
}

PairRun run_pairs(const ExchangeScene& scene, const PairRunOptions& options, Checkpoint* checkpoint) {
  const auto n = static_cast<std::uint32_t>(scene.size());
  const std::uint32_t rows_asked = std::min(n, options.rows.value_or(n));
  PairRun run;
  if (checkpoint != nullptr) run.rows = finished_rows(*checkpoint);
  std::vector<bool> is_finished(n);
  for (const PairRows& part : run.rows) {
    for (const std::uint32_t row : part.row) is_finished.at(row) = true;
    run.resumed += static_cast<std::uint32_t>(part.row.size());
  }
  run.finished = run.resumed;
  std::vector<std::uint32_t> left;
  double pairs_left = 0, pairs_done = 0;
  for (std::uint32_t row = 0; row < rows_asked; ++row) {
    if (is_finished[row]) continue;
    left.push_back(row);
    pairs_left += n - row;
  }

  const auto is_over = [&] { return options.pairs.stop && options.pairs.stop(); };
  Stride stride(options.block_seconds);
  for (std::size_t next = 0; next < left.size();) {
    if (is_over()) return run;
    PairRows block;
    bool whole = true;
    const auto begun = Clock::now();
    do {
      const auto before = Clock::now();
      const auto rows = std::span(left).subspan(next, std::min(stride.rows(), left.size() - next));
      const PairRows finished = pair_rows(scene, rows, options.pairs, run.statistics);
      append(block, finished);
      whole = finished.row.size() == rows.size();
      next += rows.size();
      stride.learn(seconds_since(before));
      for (const std::uint32_t row : finished.row) pairs_done += n - row;
    } while (whole && next < left.size() && seconds_since(begun) < options.block_seconds && !is_over());
    if (block.row.empty()) return run;
    if (checkpoint != nullptr) keep_pairs(*checkpoint, block);
    run.finished += static_cast<std::uint32_t>(block.row.size());
    run.rows.push_back(std::move(block));
    if (options.progress) options.progress(pairs_done / pairs_left, "form factors");
    if (!whole) return run;
  }
  run.complete = true;
  return run;
}

}  // namespace exitance
