#include "src/cli/progress_display.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>

namespace exitance {
namespace {

using namespace std::chrono_literals;
using Seconds = std::chrono::duration<double>;

std::string in_words(double seconds) {
  const auto whole = static_cast<long>(std::ceil(seconds));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{}:{:02} min", whole / 60, whole % 60);
  return fmt::format("{}:{:02} h", whole / 3600, whole / 60 % 60);
}

std::string remaining(double fraction, double elapsed) {
  return fraction > 0.01 ? in_words(elapsed * (1 - fraction) / fraction) + " left" : "";
}

}  // namespace

ProgressDisplay::ProgressDisplay() : on_terminal_(isatty(STDERR_FILENO) == 1) {}

void ProgressDisplay::show(double fraction, std::string_view label) {
  const auto now = Clock::now();
  if (label != label_) {
    label_ = label;
    started_ = shown_ = now;
  }
  if (now - shown_ < (on_terminal_ ? Clock::duration(100ms) : Clock::duration(10s))) return;
  shown_ = now;
  const std::string left = remaining(fraction, Seconds(now - started_).count());
  const double percent = std::floor(100 * fraction);
  if (on_terminal_) {
    constexpr int kWidth = 40;
    const int full = static_cast<int>(kWidth * fraction);
    fmt::print(stderr, "\r\033[K{} [{:#<{}}{:.<{}}] {:.0f} % {}", label, "", full, "", kWidth - full, percent, left);
    std::fflush(stderr);
    bar_stands_ = true;
  } else {
    fmt::print(stderr, "{} {:.0f} %{}{}\n", label, percent, left.empty() ? "" : ", ", left);
  }
}

void ProgressDisplay::clear() {
  if (bar_stands_) fmt::print(stderr, "\r\033[K");
  bar_stands_ = false;
}

}  // namespace exitance
