#include "src/reference/pair_fault.h"

#include "geometry/contour_form_factor.h"
#include "src/form_factor/area_rows.h"

namespace exitance {
namespace {

/// F_ij without occluders.
double unoccluded(const ExchangeScene& exchange, std::uint32_t i, std::uint32_t j) {
  double sum = 0;
  for (const ExchangeScene::Piece& a : exchange.pieces(i)) {
    for (const ExchangeScene::Piece& b : exchange.pieces(j))
      sum += unobstructed_exchange(a.radiator, b.radiator).integral;
  }
  return sum / exchange.area(i);
}

}  // namespace

std::string_view describe(Fault fault) {
  switch (fault) {
    case Fault::seen_from_behind:
      return "they face away from each other";
    case Fault::leak:
      return "a leak: occluders that meet hide all";
    case Fault::self_intersection:
      return "self-intersection: nothing stands between";
    case Fault::contact:
      return "contact: something lies on one of them";
    case Fault::missed_gap:
      return "what is left open was missed";
    case Fault::missed_occluder:
      return "what stands between was missed";
    case Fault::sampling:
      return "too few rays";
    case Fault::integration:
      return "a loose tolerance";
    case Fault::unknown:
      return "unknown";
  }
  return "";
}

Fault find_fault(const WorstPair& pair, PairClass kind, Maker maker, const PatchMesh& mesh,
                 const ExchangeScene& exchange) {
  const auto covered = [&](std::uint32_t patch) {
    return may_be_covered(exchange.soup(), mesh.pieces_of(mesh.patches[patch]));
  };
  if (kind == PairClass::facing_away) return Fault::seen_from_behind;
  if (maker == Maker::exact) return Fault::integration;  // visibility is no question
  const bool by_rays = maker == Maker::shadow_rays || maker == Maker::hemisphere_rays;
  if (kind == PairClass::open) {
    // Shadow rays are weighed against what an open pair exchanges: all that arrive make no error.
    if (maker == Maker::shadow_rays) return Fault::self_intersection;
    return by_rays ? Fault::sampling : Fault::unknown;
  }
  if (covered(pair.i) || covered(pair.j)) return Fault::contact;
  // Blocked by one convex solid, a pair is known to be; by several together, its value is 0 up to its error.
  if (kind == PairClass::blocked || (pair.truth == 0 && pair.F > 0)) return Fault::leak;
  if (pair.F == 0) return Fault::missed_gap;
  if (pair.F >= unoccluded(exchange, pair.i, pair.j) * (1 - 1e-6)) return Fault::missed_occluder;
  return by_rays ? Fault::sampling : Fault::unknown;
}

}  // namespace exitance
