#include "src/cli/ray_settings.h"

#include <array>

#include "src/cli/number_range.h"

namespace exitance {
namespace {

constexpr std::array kSamplers = {Sampler::random, Sampler::stratified, Sampler::sobol, Sampler::owen};
constexpr std::array kEstimators = {Estimator::kernel, Estimator::fraction, Estimator::hemisphere, Estimator::centre};

template <class All>
std::vector<std::string> names(const All& all) {
  std::vector<std::string> result;
  for (const auto one : all) result.push_back(to_string(one));
  return result;
}

template <class All>
auto named(const All& all, const std::string& name) -> std::optional<typename All::value_type> {
  for (const auto one : all) {
    if (to_string(one) == name) return one;
  }
  return {};
}

}  // namespace

std::optional<Sampler> sampler_named(const std::string& name) {
  return named(kSamplers, name);
}

std::optional<Estimator> estimator_named(const std::string& name) {
  return named(kEstimators, name);
}

void RaySettings::add_to(CLI::App& verb) {
  verb.add_option("--visibility", visibility_, "How visibility is decided: exact, or sampled by rays")
      ->check(CLI::IsMember({"exact", "rays"}))
      ->capture_default_str();
  of_rays_ = {
      verb.add_option("--rays", options_.rays, "Rays of a pair, or of a hemisphere; powers of two suit Sobol points")
          ->check(whole_number_between(1, kMostRays))
          ->capture_default_str(),
      verb.add_option("--replicates", options_.replicates,
                      "Independent estimates by so many rays, of which the mean is taken; their spread gives the error")
          ->check(whole_number_between(1, kMostRays))
          ->capture_default_str(),
      verb.add_option("--sampler", sampler_, "Points that rays go to")
          ->check(CLI::IsMember(names(kSamplers)))
          ->capture_default_str(),
      verb.add_option("--estimator", estimator_,
                      "kernel: rays to the source, weighted; fraction: unweighted; hemisphere: rays in all directions; "
                      "centre: one ray")
          ->check(CLI::IsMember(names(kEstimators)))
          ->capture_default_str(),
      verb.add_option("--ray-offset", options_.offset, "Both ends of rays off their surfaces, of the scene's radius")
          ->check(number_between(0, 1))
          ->capture_default_str()};
}

std::optional<RayOptions> RaySettings::chosen(std::uint64_t seed) const {
  if (visibility_ == "exact") {
    for (const CLI::Option* option : of_rays_) {
      if (option->count() > 0) throw CLI::ValidationError(option->get_name(), "needs --visibility rays");
    }
    return {};
  }
  RayOptions options = options_;
  options.sampler = sampler_named(sampler_).value();
  options.estimator = estimator_named(estimator_).value();
  options.seed = seed;
  return options;
}

}  // namespace exitance
