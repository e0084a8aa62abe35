#pragma once
// Rows of form factors averaged over elements, by integration to a tolerance.

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "src/form_factor/form_factor_matrix.h"
#include "src/form_factor/pair_run.h"
#include "src/scene/patch_mesh.h"
#include "src/visibility/contacts.h"

namespace exitance {

struct AreaRows {
  FormFactorMatrix F;                    ///< elements × patches
  std::array<std::uint64_t, 4> pairs{};  ///< of elements, by class (pairs_by_class)
  std::uint32_t resumed = 0;             ///< rows of elements that the checkpoint held
  /// Largest |A_i F_ij − A_j F_ji| / min(A_i, A_j) of some partial pairs of elements, each F integrated over its own
  /// receiver; none where there is no such pair.
  std::optional<double> reciprocity_max_defect;
};

/// Every pair of elements is integrated once; what an element sees of a patch is the sum of the patch's elements. In
/// parallel; any number of threads gives the same bits, however often the run was ended (run_pairs, whose checkpoint
/// may be null). The mesh must be of the soup's scene. seed: of the pairs whose reciprocity is measured. Where
/// options.pairs.stop ends the work, F is empty.
AreaRows area_rows(const PatchMesh& mesh, const PolygonSoup& soup, const PairRunOptions& options, std::uint64_t seed,
                   Checkpoint* checkpoint = nullptr);

/// Columns of elements summed to columns of patches, with the errors and the rounding.
FormFactorMatrix sum_to_patches(const FormFactorMatrix& elements, const PatchMesh& mesh);

/// Whether something in the planes of an element's or a patch's pieces covers it, wholly or in part, or might; also if
/// it lies there but for rounding.
bool may_be_covered(const PolygonSoup& soup, const Contacts& contacts, std::span<const PatchPiece> pieces);

}  // namespace exitance
