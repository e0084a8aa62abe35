#include "src/cli/contender_names.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>

#include "src/cli/number_range.h"
#include "src/cli/ray_settings.h"

namespace exitance {
namespace {

[[noreturn]] void refuse(const std::string& name, const std::string& why) {
  throw CLI::ValidationError("--against", name + ": " + why);
}

/// The number that a part is, or what the validator has against it.
template <class Number>
Number number_in(const std::string& name, std::string part, const CLI::Validator& validator) {
  if (const std::string wrong = validator(part); !wrong.empty()) refuse(name, wrong);
  Number number{};
  if (!CLI::detail::lexical_cast(part, number)) refuse(name, part + " is not a number");
  return number;
}

Contender contender_named(const std::string& name, const RayOptions& defaults) {
  const std::vector<std::string> parts = CLI::detail::split(name, ':');
  if (parts[0] == "exact" && parts.size() == 2) {
    PairOptions pairs;
    pairs.tolerance = number_in<double>(name, parts[1], positive_number());
    return {name, pairs};
  }
  if (parts[0] == "rays" && parts.size() >= 2) {
    RayOptions rays = defaults;
    rays.rays = number_in<std::uint32_t>(name, parts[1], whole_number_between(1, kMostRays));
    for (std::size_t k = 2; k < parts.size(); ++k) {
      if (const auto sampler = sampler_named(parts[k])) {
        rays.sampler = *sampler;
      } else if (const auto estimator = estimator_named(parts[k])) {
        rays.estimator = *estimator;
      } else if (parts[k] == "fast") {
        rays.robust = false;
      } else if (parts[k] == "untold") {
        rays.contacts = false;
      } else {
        refuse(name, parts[k] + " is neither a sampler nor an estimator, nor fast or untold");
      }
    }
    return {name, rays};
  }
  const std::filesystem::path path = name;
  constexpr std::array kExtensions = {".h5", ".csv", ".txt"};
  if (std::ranges::find(kExtensions, CLI::detail::to_lower(path.extension().string())) == kExtensions.end())
    refuse(name, "is none of rays:N, exact:TOLERANCE and a matrix file (.h5, .csv, .txt)");
  return {name, path};
}

}  // namespace

std::vector<Contender> contenders_named(const std::vector<std::string>& names, const RayOptions& defaults) {
  std::vector<Contender> contenders;
  for (const std::string& name : names) contenders.push_back(contender_named(name, defaults));
  return contenders;
}

}  // namespace exitance
