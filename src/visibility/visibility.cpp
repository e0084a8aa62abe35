#include "src/visibility/visibility.h"

#include <algorithm>

namespace exitance {

PointRowStatistics& PointRowStatistics::operator+=(const PointRowStatistics& other) {
  pairs += other.pairs;
  stages += other.stages;
  extended += other.extended;
  covered_points += other.covered_points;
  closure_max_defect = std::max(closure_max_defect, other.closure_max_defect);
  rays += other.rays;
  sampled += other.sampled;
  standard_error_sum += other.standard_error_sum;
  return *this;
}

}  // namespace exitance
