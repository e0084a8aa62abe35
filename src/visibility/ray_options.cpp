#include "src/visibility/ray_options.h"

#include <stdexcept>

namespace exitance {

void check(const RayOptions& options) {
  if (options.rays < 1) throw std::invalid_argument("rays must be at least 1");
  if (options.replicates < 1) throw std::invalid_argument("replicates must be at least 1");
  if (options.packet != 8 && options.packet != 16) {
    throw std::invalid_argument("packet must be 8 or 16, not " + std::to_string(options.packet));
  }
  if (!(options.offset >= 0)) throw std::invalid_argument("offset must be at least 0");
}

std::string to_string(Estimator estimator) {
  switch (estimator) {
    case Estimator::kernel:
      return "kernel";
    case Estimator::fraction:
      return "fraction";
    case Estimator::hemisphere:
      return "hemisphere";
    case Estimator::centre:
      return "centre";
  }
  return "";
}

}  // namespace exitance
