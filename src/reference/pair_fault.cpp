#include "src/reference/pair_fault.h"

#include <algorithm>
#include <cmath>

#include "geometry/contour_form_factor.h"
#include "src/form_factor/area_rows.h"
#include "src/visibility/seed.h"

namespace exitance {
namespace {

constexpr std::uint32_t kSets = 16;    // of rays cast anew
constexpr double kStandardErrors = 4;  // of a mean of so many sets, Student's t: exceeded once in 800 times
constexpr double kRounding = 1e-6;     // of a form factor that is as if nothing stood between

/// Visits F's pieces: what the pair exchanges is the sum of what they do, `times` each.
template <class Visit>
void for_each_exchange(const ExchangeScene& exchange, const WorstPair& pair, const Visit& visit) {
  const auto a = exchange.pieces(pair.i), b = exchange.pieces(pair.j);
  for (std::size_t k = 0; k < a.size(); ++k) {
    for (std::size_t l = pair.i == pair.j ? k + 1 : 0; l < b.size(); ++l)
      visit(a[k], b[l], pair.i == pair.j ? 2.0 : 1.0);
  }
}

}  // namespace

std::string_view describe(Fault fault) {
  switch (fault) {
    case Fault::none_known:
      return "none: within the error of the truth";
    case Fault::seen_from_behind:
      return "they face away from each other";
    case Fault::leak:
      return "a leak: occluders that meet hide all";
    case Fault::self_intersection:
      return "self-intersection: nothing stands between";
    case Fault::offset:
      return "the offset of rays: they pass what is near to their ends";
    case Fault::contact:
      return "contact: something lies on one of them";
    case Fault::missed_gap:
      return "what is left open was missed";
    case Fault::missed_occluder:
      return "what stands between was missed";
    case Fault::unweighted:
      return "rays are counted without their kernel";
    case Fault::sampling:
      return "too few rays";
    case Fault::integration:
      return "a loose tolerance";
    case Fault::unknown:
      return "unknown";
  }
  return "";
}

FaultFinder::FaultFinder(const Contender& contender, const PatchMesh& mesh, const ExchangeScene& exchange)
    : contender_(contender), mesh_(mesh), exchange_(exchange), contacts_(exchange.soup()) {
  if (contender.maker() != Maker::shadow_rays) return;
  RayOptions options = std::get<RayOptions>(contender.how);
  if (options.estimator == Estimator::centre) return;
  options.replicates = kSets;
  options.seed = mixed(options.seed);
  more_rays_.emplace(exchange.soup(), options);
  options.offset /= 2;
  if (options.offset > 0) nearer_rays_.emplace(exchange.soup(), options);
}

Fault FaultFinder::find(const WorstPair& pair, PairClass kind) const {
  if (std::fabs(pair.F - pair.truth) <= pair.truth_error) return Fault::none_known;
  if (kind == PairClass::facing_away) return Fault::seen_from_behind;
  switch (contender_.maker()) {
    case Maker::exact:
      return Fault::integration;  // visibility is no question
    case Maker::shadow_rays:
      return of_shadow_rays(pair, kind);
    case Maker::hemisphere_rays:
      return of_hemispheres(pair, kind);
    case Maker::unknown:
      return of_unknown(pair, kind);
  }
  return Fault::unknown;
}

Fault FaultFinder::of_shadow_rays(const WorstPair& pair, PairClass kind) const {
  const Fault shown = shown_by(pair, kind);
  if (!more_rays_) return shown;
  const SampledFormFactor again = by_rays(*more_rays_, pair);
  const double apart = std::fabs(again.F - pair.truth);
  if (apart <= kStandardErrors * again.standard_error) return shown == Fault::unknown ? Fault::sampling : shown;
  if (nearer_rays_ && std::fabs(by_rays(*nearer_rays_, pair).F - pair.truth) < 0.75 * apart) return Fault::offset;
  if (shown != Fault::unknown) return shown;
  const auto& options = std::get<RayOptions>(contender_.how);
  if (!options.contacts && touched(pair)) return Fault::contact;
  // What is left of the kernel's estimate is the bias of a ratio, which falls with the number of rays.
  return options.estimator == Estimator::fraction ? Fault::unweighted : Fault::sampling;
}

/// What class and value of a pair show by themselves of shadow rays.
Fault FaultFinder::shown_by(const WorstPair& pair, PairClass kind) const {
  // They are weighed against what an open pair exchanges: all that arrive make no error.
  if (kind == PairClass::open) return Fault::self_intersection;
  // Blocked by one convex solid, a pair is known to be; by several together, its value is 0 up to its error.
  if (kind == PairClass::blocked || pair.truth == 0) {
    const bool untold = !std::get<RayOptions>(contender_.how).contacts;
    return untold && touched(pair) ? Fault::contact : Fault::leak;
  }
  if (pair.F == 0) return Fault::missed_gap;
  return pair.F >= unoccluded(pair) * (1 - kRounding) ? Fault::missed_occluder : Fault::unknown;
}

Fault FaultFinder::of_hemispheres(const WorstPair& pair, PairClass kind) const {
  const auto& options = std::get<RayOptions>(contender_.how);
  const double p = std::clamp(std::max(pair.F, pair.truth), 0.0, 1.0),
               rays = static_cast<double>(options.rays) * options.replicates;
  if (kind == PairClass::blocked || pair.truth == 0) return Fault::leak;
  if (pair.F == 0) return Fault::missed_gap;
  // A ray more or less is no fault, however few are meant to arrive.
  if (std::fabs(pair.F - pair.truth) <= 5 * std::sqrt(p * (1 - p) / rays) + 1 / rays) return Fault::sampling;
  return touched(pair) ? Fault::contact : Fault::unknown;
}

Fault FaultFinder::of_unknown(const WorstPair& pair, PairClass kind) const {
  if (kind != PairClass::open && touched(pair)) return Fault::contact;
  if (pair.F == 0) return Fault::missed_gap;
  if (kind == PairClass::open) return Fault::unknown;
  if (pair.F >= unoccluded(pair) * (1 - kRounding)) return Fault::missed_occluder;
  return kind == PairClass::blocked || pair.truth == 0 ? Fault::leak : Fault::unknown;
}

bool FaultFinder::touched(const WorstPair& pair) const {
  const auto may_be = [&](std::uint32_t patch) {
    return may_be_covered(exchange_.soup(), contacts_, mesh_.pieces_of(mesh_.patches[patch]));
  };
  return may_be(pair.i) || may_be(pair.j);
}

/// F_ij without occluders.
double FaultFinder::unoccluded(const WorstPair& pair) const {
  double sum = 0;
  for_each_exchange(exchange_, pair, [&](const auto& a, const auto& b, double times) {
    sum += times * unobstructed_exchange(a.radiator, b.radiator).integral;
  });
  return sum / exchange_.area(pair.i);
}

/// F_ij by rays of their own.
SampledFormFactor FaultFinder::by_rays(const ShadowRays& rays, const WorstPair& pair) const {
  SampledSum sum;
  std::uint64_t seed = question_seed(rays.options().seed, pair.i, pair.j);
  for_each_exchange(exchange_, pair, [&](const auto& a, const auto& b, double times) {
    seed = mixed(seed);
    sum.add(rays.exchange(a.source, b.source, unobstructed_exchange(a.radiator, b.radiator).integral, seed), times);
  });
  SampledFormFactor F = sum.value();
  F.F /= exchange_.area(pair.i);
  F.standard_error /= exchange_.area(pair.i);
  return F;
}

}  // namespace exitance
