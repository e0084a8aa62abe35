#pragma once
// How long a piece of work takes.

#include <time.h>

#include <chrono>
#include <utility>

namespace exitance {

class RunClock {
 public:
  /// Since it was made: by the clock on the wall [s].
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }
  /// The same since the last lap ended, or since it was made [s]; begins the next.
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    return std::chrono::duration<double>(now - std::exchange(lap_start_, now)).count();
  }
  /// Of the processor, all threads of this process together [s]: what else runs on the machine counts little.
  double cpu_seconds() const { return processor() - processor_start_; }

 private:
  static double processor() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
  }

  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now(), lap_start_ = start_;
  double processor_start_ = processor();
};

}  // namespace exitance
