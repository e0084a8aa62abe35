#include "src/stress/point_contender.h"

#include <charconv>
#include <cmath>
#include <stdexcept>

#include "src/stress/plain_visibility.h"
#include "src/stress/visibility_oracle.h"
#include "src/visibility/shadow_rays.h"

namespace exitance {
namespace {

constexpr double kTolerance = 1e-13, kRelative = 1e-10, kLeast = 1e-15;

Opinion ask_exactly(const PointQuestion& question, std::uint64_t) {
  PointAnswer a = answer(question, kTolerance);
  const double wanted = kRelative * std::fmax(a.F, kLeast);
  if (a.F_error > wanted && a.visibility != Visibility::blocked) {
    const StageCounts stages = a.stages;
    a = answer(question, wanted);
    a.stages = stages;
  }
  return {a.F, a.F_error, a.visibility, a.stages, a.extended};
}

Opinion ask_plainly(const PointQuestion& question, std::uint64_t) {
  return {plain_form_factor(scaled_near_one(question).question), kPlainMargin, Visibility::partial, {}, 0};
}

Opinion ask_oracle(const PointQuestion& question, std::uint64_t) {
  const OracleAnswer a = oracle_form_factor(question);
  const auto F = static_cast<double>(a.F);
  return {F, kRoundoff * F, Visibility::partial, {}, 0};
}

/// Six standard errors, and, as rays that all agree have no spread, six rays' share.
Opinion ask_rays(const PointQuestion& given, std::uint64_t seed, const RayOptions& options) {
  const PointQuestion question = scaled_near_one(given).question;
  QuestionScene scene;
  if (!scene.add(question.source, Role::unoccluding, "source")) return {};
  scene.add(question.occluders);
  const PolygonSoup soup(scene.polygons, scene.roles);
  const ShadowRays rays(soup, options);
  const Receiver receiver{question.point, normalized(question.normal)};
  SampledSum sum;
  StageCounts counts;
  for (std::uint32_t f = soup.first_facet(0); f < soup.first_facet(1); ++f) {
    if (side_of(soup.facets()[f].plane, receiver.point, counts) > 0) sum.add(rays.form_factor(receiver, {f, {}}, seed));
  }
  const SampledFormFactor F = sum.value();
  return {F.F, 6 * (F.standard_error + F.F_unoccluded / options.rays), Visibility::partial, {}, 0};
}

/// The number of rays of "rays:N" or "rays:N:fast".
RayOptions options_of(const std::string& name) {
  RayOptions options;
  const std::string::size_type colon = name.find(':', 5);
  const char *first = name.data() + 5, *last = name.data() + std::min(colon, name.size());
  const auto [end, wrong] = std::from_chars(first, last, options.rays);
  const bool is_fast = colon != std::string::npos && name.substr(colon) == ":fast";
  if (wrong != std::errc() || end != last || options.rays < 1 || options.rays > (1u << 24) ||
      (colon != std::string::npos && !is_fast)) {
    throw std::invalid_argument(name + ": rays:N or rays:N:fast, with 1 to 16777216 rays");
  }
  options.robust = !is_fast;
  return options;
}

}  // namespace

Contender point_contender_named(const std::string& name) {
  if (name == "exact") return {name, ask_exactly, true, true};
  if (name == "plain-double") return {name, ask_plainly, false, true};
  if (name == "cgal-epeck") return {name, ask_oracle, true, false};
  if (name.starts_with("rays:")) {
    const RayOptions options = options_of(name);
    return {name, [options](const PointQuestion& q, std::uint64_t seed) { return ask_rays(q, seed, options); }};
  }
  throw std::invalid_argument(name +
                              ": no contender; there are exact, plain-double, rays:N, rays:N:fast and cgal-epeck");
}

}  // namespace exitance
