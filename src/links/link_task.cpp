#include "src/links/link_task.h"

#include <fmt/format.h>

#include "src/scene/input_error.h"

namespace exitance {

LinkWork& LinkWork::operator+=(const LinkWork& other) {
  links_updated += other.links_updated;
  links_affected += other.links_affected;
  skipped += other.skipped;
  refined += other.refined;
  unrefined += other.unrefined;
  sight += other.sight;
  return *this;
}

void refuse_more_links(const LinkTask& task) {
  throw LimitError(
      fmt::format("there would be more than {} new links, for which there is no memory; choose a larger threshold or "
                  "smallest area",
                  task.most_links));
}

}  // namespace exitance
