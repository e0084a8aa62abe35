#include "src/links/link_task.h"

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

}  // namespace exitance
