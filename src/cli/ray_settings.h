#pragma once
// How a verb decides visibility: exactly or by rays, and by which.

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "src/visibility/ray_options.h"

namespace exitance {

/// More rays to one question than this are asked for by mistake only: points take memory before the first is cast.
inline constexpr std::uint64_t kMostRays = std::uint64_t{1} << 24;

/// By name, as it stands in options and results; none where there is none of that name.
std::optional<Sampler> sampler_named(const std::string& name);
std::optional<Estimator> estimator_named(const std::string& name);

class RaySettings {
 public:
  /// Adds --visibility and what rays need. The object must live as long as the verb.
  void add_to(CLI::App& verb);

  /// None for exact visibility. Throws CLI::ValidationError where an option of rays was given without them.
  std::optional<RayOptions> chosen(std::uint64_t seed) const;

 private:
  RayOptions options_;
  std::string visibility_ = "exact", sampler_ = "sobol", estimator_ = "kernel";
  std::vector<CLI::Option*> of_rays_;
};

}  // namespace exitance
