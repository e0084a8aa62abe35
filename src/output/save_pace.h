#pragma once
// How often a long run saves.

#include <algorithm>

#include "src/output/run_clock.h"

namespace exitance {

/// Every so many seconds, but each time after at least 20 times as long as the last saving took, so that what is saved
/// in time takes at most 5 % of the time until the next. 0 s: whenever it is asked, whatever that takes.
class SavePace {
 public:
  explicit SavePace(double seconds) : interval_(seconds) {}

  /// Has save() save if it is time.
  template <class Save>
  void in_time(const Save& save) {
    if (since_.seconds() < interval_) return;
    const RunClock saving;
    save();
    if (interval_ > 0) interval_ = std::max(interval_, saving.seconds() / kShare);
    since_ = RunClock();
  }

 private:
  static constexpr double kShare = 0.05;

  double interval_;
  RunClock since_;
};

}  // namespace exitance
