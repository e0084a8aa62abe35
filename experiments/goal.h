#pragma once
// When a contender's error is below what is asked, and stays there.

#include <fmt/format.h>

#include <cstdint>
#include <optional>
#include <string>

namespace exitance {

/// Errors below which a contender counts as there.
inline constexpr double kGoal = 0.05;

class GoalReached {
 public:
  void record(double error, std::uint64_t shots, double seconds) {
    if (error > kGoal) at_.reset();
    if (error <= kGoal && !at_) at_ = At{shots, seconds};
  }
  /// As tables have them; "none" where it is not there.
  std::string shots() const { return at_ ? fmt::format("{}", at_->shots) : "none"; }
  std::string seconds() const { return at_ ? fmt::format("{:.3g}", at_->seconds) : "none"; }

 private:
  struct At {
    std::uint64_t shots;
    double seconds;
  };
  std::optional<At> at_;
};

}  // namespace exitance
