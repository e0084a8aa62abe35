#pragma once
// How long a piece of work takes.

#include <time.h>

#include <chrono>

namespace exitance {

class RunClock {
 public:
  /// Since it was made: by the clock on the wall [s].
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }
  /// Of the processor, all threads of this process together [s]: what else runs on the machine counts little.
  double cpu_seconds() const { return processor() - processor_start_; }

 private:
  static double processor() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
  }

  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  double processor_start_ = processor();
};

}  // namespace exitance
