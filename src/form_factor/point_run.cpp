#include "src/form_factor/point_run.h"

#include <algorithm>

#include "src/form_factor/kept_rows.h"
#include "src/output/run_clock.h"

namespace exitance {
namespace {

/// Rows that are made in parallel before anything is asked or saved.
constexpr std::size_t kBlock = 256;

void append(PointRows& rows, const PointRows& more) {
  const std::uint64_t before = rows.F.F.size();
  for (std::size_t r = 1; r < more.F.row_first.size(); ++r) rows.F.row_first.push_back(before + more.F.row_first[r]);
  rows.F.column.insert(rows.F.column.end(), more.F.column.begin(), more.F.column.end());
  rows.F.F.insert(rows.F.F.end(), more.F.F.begin(), more.F.F.end());
  rows.F.F_error.insert(rows.F.F_error.end(), more.F.F_error.begin(), more.F.F_error.end());
  rows.statistics += more.statistics;
}

}  // namespace

PointRun run_points(const MeshVisibility& visibility, const PointRunOptions& options, Checkpoint* checkpoint) {
  const std::size_t n = visibility.mesh().elements.size();
  PointRun run;
  run.rows.F.columns = static_cast<std::uint32_t>(visibility.mesh().patches.size());
  if (checkpoint != nullptr) run.rows = kept_points(*checkpoint, run.rows.F.columns);
  run.resumed = run.rows.F.rows();

  std::size_t saved = run.resumed;
  RunClock since_saved;
  const auto save = [&] {
    if (checkpoint == nullptr || saved == run.rows.F.rows()) return;
    keep_points(*checkpoint, run.rows, saved);
    saved = run.rows.F.rows();
    since_saved = RunClock();
  };
  for (std::size_t first = run.resumed; first < n; first = run.rows.F.rows()) {
    if (options.stop && options.stop()) {
      save();
      return run;
    }
    append(run.rows, point_rows(visibility, first, std::min(n, first + kBlock)));
    if (since_saved.seconds() >= options.block_seconds) save();
    if (options.progress)
      options.progress(static_cast<double>(run.rows.F.rows()) / static_cast<double>(n), "form factors");
  }
  run.complete = true;
  return run;
}

}  // namespace exitance
