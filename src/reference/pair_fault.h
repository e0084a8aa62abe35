#pragma once
// Why a form factor is wrong, as far as it can be told.

#include <cstdint>
#include <string_view>

#include "src/form_factor/pair_form_factor.h"
#include "src/reference/matrix_comparison.h"
#include "src/scene/patch_mesh.h"

namespace exitance {

enum class Maker : std::uint8_t { exact, shadow_rays, hemisphere_rays, unknown };

enum class Fault : std::uint8_t {
  seen_from_behind,   ///< the patches face away from each other
  leak,               ///< something arrives though occluders hide all: between two that meet, or through a gap
  self_intersection,  ///< rays stopped though nothing stands between: by the surfaces they connect
  contact,            ///< something lies in the plane of one of the patches and covers part of it
  missed_gap,         ///< nothing arrived through what is left open
  missed_occluder,    ///< as if nothing stood between, though something does
  sampling,           ///< too few rays
  integration,        ///< too loose a tolerance
  unknown
};

/// In words, without a full stop.
std::string_view describe(Fault fault);

/// `exchange` holds the mesh's patches.
Fault find_fault(const WorstPair& pair, PairClass kind, Maker maker, const PatchMesh& mesh,
                 const ExchangeScene& exchange);

}  // namespace exitance
