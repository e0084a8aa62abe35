#pragma once
// Progress on stderr: a bar with the remaining time on a terminal, a line now and then elsewhere.

#include <chrono>
#include <string>
#include <string_view>

namespace exitance {

class ProgressDisplay {
 public:
  ProgressDisplay();
  ~ProgressDisplay() { clear(); }
  ProgressDisplay(const ProgressDisplay&) = delete;
  ProgressDisplay& operator=(const ProgressDisplay&) = delete;

  /// As Progress (src/output/progress.h); a new label starts a new piece of work.
  void show(double fraction, std::string_view label);

  /// Removes the bar, so that other text can be printed.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;

  bool on_terminal_;
  bool bar_stands_ = false;
  std::string label_;
  Clock::time_point started_, shown_;
};

}  // namespace exitance
