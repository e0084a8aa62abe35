#include "src/cli/interrupt.h"

#include <signal.h>

#include <atomic>

namespace exitance {
namespace {

// All threads ask, and a handler may write it as no lock is taken.
std::atomic<bool> flag = false;
static_assert(std::atomic<bool>::is_always_lock_free);

}  // namespace

void catch_interrupts() {
  struct sigaction action {};
  action.sa_handler = [](int) { flag = true; };
  action.sa_flags = static_cast<int>(SA_RESETHAND) | SA_RESTART;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool interrupted() {
  return flag;
}

}  // namespace exitance
