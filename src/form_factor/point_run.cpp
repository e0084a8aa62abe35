#include "src/form_factor/point_run.h"

#include <algorithm>

#include "src/form_factor/kept_rows.h"
#include "src/output/save_pace.h"

namespace exitance {
namespace {

/// Rows that are made in parallel before anything is asked or saved.
constexpr std::size_t kBlock = 256;

}  // namespace

PointRun run_points(const MeshVisibility& visibility, const PointRunOptions& options, Checkpoint* checkpoint) {
  const std::size_t n = visibility.mesh().elements.size();
  PointRun run;
  run.rows.F.columns = static_cast<std::uint32_t>(visibility.mesh().patches.size());
  if (checkpoint != nullptr) run.rows = kept_points(*checkpoint, run.rows.F.columns);
  run.resumed = run.rows.F.rows();

  std::size_t saved = run.resumed;
  SavePace pace(options.block_seconds);
  const auto save = [&] {
    if (checkpoint == nullptr || saved == run.rows.F.rows()) return;
    keep_points(*checkpoint, run.rows, saved);
    saved = run.rows.F.rows();
  };
  for (std::size_t first = run.resumed; first < n; first = run.rows.F.rows()) {
    if (options.stop && options.stop()) {
      save();
      return run;
    }
    const PointRows more = point_rows(visibility, first, std::min(n, first + kBlock));
    append(run.rows.F, more.F);
    run.rows.statistics += more.statistics;
    pace.in_time(save);
    if (options.progress)
      options.progress(static_cast<double>(run.rows.F.rows()) / static_cast<double>(n), "form factors");
  }
  if (saved > 0) save();
  run.complete = true;
  return run;
}

}  // namespace exitance
