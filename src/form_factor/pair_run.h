#pragma once
// A long run: all rows of pairs of a scene, block after block, each saved before the next.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "src/form_factor/pair_rows.h"
#include "src/output/checkpoint.h"
#include "src/output/progress.h"

namespace exitance {

struct PairRun {
  std::vector<PairRows> rows;
  PairStatistics statistics;   ///< of the rows that were computed now
  std::uint32_t finished = 0;  ///< rows
  std::uint32_t resumed = 0;   ///< of them, those that the checkpoint held
  bool complete = false;       ///< whether all rows asked for are finished; if not, pairs.stop ended the run

  std::uint64_t unreached() const;  ///< pairs of all finished rows whose error exceeds the tolerance
};

struct PairRunOptions {
  PairOptions pairs = {};
  std::optional<std::uint32_t> rows = {};  ///< only the first so many; all unless given
  double block_seconds = 2;                ///< about how much work is put into a block
  Progress progress = {};                  ///< by pairs, of those that were left to do
};

/// What the rows of a scene's patches depend on, for the key of their checkpoint: the build, the scene (its hash), the
/// longest edge of its patches and the options.
std::string pair_run_key(const std::string& scene_hash, double patch_size, const PairOptions& pairs);

/// The rows that the checkpoint does not hold, ascending, in blocks of at least a row. The same bits for any
/// number of threads, and however often the run was ended. checkpoint: may be null; what it throws passes through, but
/// that a damaged file asks to be removed (unless the checkpoint forgets it).
PairRun run_pairs(const ExchangeScene& scene, const PairRunOptions& options, Checkpoint* checkpoint);

}  // namespace exitance
