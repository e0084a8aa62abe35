#pragma once
// Why a form factor is wrong, as far as it can be told.

#include <cstdint>
#include <optional>
#include <string_view>

#include "src/form_factor/pair_form_factor.h"
#include "src/reference/contender.h"
#include "src/reference/matrix_comparison.h"
#include "src/scene/patch_mesh.h"
#include "src/visibility/contacts.h"
#include "src/visibility/shadow_rays.h"

namespace exitance {

enum class Fault : std::uint8_t {
  none_known,         ///< no further from what is taken for true than that may be from the truth
  seen_from_behind,   ///< the patches face away from each other
  leak,               ///< something arrives though occluders hide all: between two that meet, or through a gap
  self_intersection,  ///< rays stopped though nothing stands between: by the surfaces they connect
  offset,             ///< rays start or end beyond what is near to their surfaces; a smaller offset is less wrong
  contact,            ///< something lies in the plane of one of the patches and covers part of it
  missed_gap,         ///< nothing arrived through what is left open, a sliver perhaps
  missed_occluder,    ///< as if nothing stood between, though something does
  unweighted,         ///< the share of rays that arrive is not the share of the light
  sampling,           ///< too few rays: more of them approach the truth
  integration,        ///< too loose a tolerance
  unknown
};

/// In words, without a full stop.
std::string_view describe(Fault fault);

/// Finds what is wrong of one contender. Where pair and class leave it open for shadow rays, sixteen independent sets
/// of them are cast: if the truth lies within four standard errors of their mean, it is their number; if not, and half
/// the offset is less wrong, the offset. Rays of hemispheres are held against the binomial standard error. The same
/// questions get the same answers.
class FaultFinder {
 public:
  /// Keeps references. `exchange` holds the mesh's patches. Throws as ShadowRays does.
  FaultFinder(const Contender& contender, const PatchMesh& mesh, const ExchangeScene& exchange);

  /// kind: the true class of the pair.
  Fault find(const WorstPair& pair, PairClass kind) const;

 private:
  Fault of_shadow_rays(const WorstPair& pair, PairClass kind) const;
  Fault shown_by(const WorstPair& pair, PairClass kind) const;
  Fault of_hemispheres(const WorstPair& pair, PairClass kind) const;
  Fault of_unknown(const WorstPair& pair, PairClass kind) const;
  bool touched(const WorstPair& pair) const;
  double unoccluded(const WorstPair& pair) const;
  SampledFormFactor by_rays(const ShadowRays& rays, const WorstPair& pair) const;

  const Contender& contender_;
  const PatchMesh& mesh_;
  const ExchangeScene& exchange_;
  Contacts contacts_;
  std::optional<ShadowRays> more_rays_, nearer_rays_;  // with half the offset
};

}  // namespace exitance
