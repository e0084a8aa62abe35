#pragma once
// A long run: the rows of all sample points of a mesh, block after block.

#include <cstdint>
#include <functional>

#include "src/form_factor/point_rows.h"
#include "src/output/checkpoint.h"

namespace exitance {

struct PointRun {
  PointRows rows;             ///< the first so many
  std::uint64_t resumed = 0;  ///< of them, those that the checkpoint held
  bool complete = false;      ///< whether all are there; if not, `stop` ended the run
};

struct PointRunOptions {
  double block_seconds = 2;         ///< about how much work is put into what is saved at a time (SavePace)
  std::function<bool()> stop = {};  ///< asked between blocks of rows; may be empty
  Progress progress = {};
};

/// The rows that the checkpoint does not hold. Where it is ended, or where some were saved, all that are finished are
/// saved before it returns.
/// The same bits for any number of threads, and however often the run was ended. checkpoint: may be null; what it
/// throws passes through.
PointRun run_points(const MeshVisibility& visibility, const PointRunOptions& options, Checkpoint* checkpoint);

}  // namespace exitance
