#include "src/cli/number_range.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <optional>
#include <string>

namespace exitance {
namespace {

template <typename Number>
std::optional<Number> parsed(const std::string& text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return number;
}

/// what: the numbers that `holds` lets through, in words.
template <typename Number, typename Holds>
CLI::Validator range(const std::string& what, const Holds& holds) {
  const auto refusal = [what, holds](const std::string& text) {
    const auto number = parsed<Number>(text);
    return number && holds(*number) ? std::string() : "must be a " + what;
  };
  return {refusal, what};
}

}  // namespace

CLI::Validator positive_number() {
  return range<double>("number above 0", [](double x) { return x > 0 && std::isfinite(x); });
}

CLI::Validator number_between(double lowest, double highest) {
  const bool is_bounded = highest < std::numeric_limits<double>::max();
  return range<double>(
      is_bounded ? fmt::format("number from {} to {}", lowest, highest) : fmt::format("number of at least {}", lowest),
      [=](double x) { return x >= lowest && x <= highest; });
}

CLI::Validator whole_number_between(std::uint64_t lowest, std::uint64_t highest) {
  const bool is_bounded = highest < std::numeric_limits<std::uint64_t>::max();
  return range<std::uint64_t>(
      fmt::format("whole number from {} to {}", lowest, is_bounded ? fmt::to_string(highest) : "2^64 - 1"),
      [=](std::uint64_t n) { return n >= lowest && n <= highest; });
}

}  // namespace exitance
