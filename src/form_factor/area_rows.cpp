#include "src/form_factor/area_rows.h"

#include <algorithm>

#include "src/form_factor/pair_sample.h"

namespace exitance {
FormFactorMatrix sum_to_patches(const FormFactorMatrix& elements, const PatchMesh& mesh) {
  FormFactorMatrix patches;
  patches.columns = static_cast<std::uint32_t>(mesh.patches.size());
  for (std::size_t e = 0; e < elements.rows(); ++e) {
    const auto columns = elements.row_columns(e);
    const auto F = elements.row(e), F_error = elements.row_error(e);
    const std::size_t first = patches.column.size();
    for (std::size_t k = 0; k < F.size(); ++k) {
      const std::uint32_t patch = mesh.elements[columns[k]].patch;
      if (patches.column.size() > first && patches.column.back() == patch) {
        patches.F.back() += F[k];
        patches.F_error.back() += F_error[k] + kRoundoff * patches.F.back();
      } else {
        patches.column.push_back(patch);
        patches.F.push_back(F[k]);
        patches.F_error.push_back(F_error[k]);
      }
    }
    patches.row_first.push_back(patches.column.size());
  }
  return patches;
}

bool may_be_covered(const PolygonSoup& soup, const Contacts& contacts, std::span<const PatchPiece> pieces) {
  return std::ranges::any_of(pieces, [&](const PatchPiece& piece) {
    const std::uint32_t f = piece.facet;
    // Most that only touch the plane but for rounding meet it along an edge.
    return std::ranges::any_of(contacts.covering(f),
                               [&](std::uint32_t t) { return std::ranges::binary_search(soup.coplanar(f), t); });
  });
}

AreaRows area_rows(const PatchMesh& mesh, const PolygonSoup& soup, const PairRunOptions& options, std::uint64_t seed,
                   Checkpoint* checkpoint) {
  const ExchangeScene scene(soup, mesh, ExchangeScene::Unit::element);
  const auto n = static_cast<std::uint32_t>(scene.size());
  const PairRun run = run_pairs(scene, options, checkpoint);
  if (!run.complete) return {};
  AreaRows result;
  result.pairs = pairs_by_class(run.rows, n);
  result.resumed = run.resumed;
  const FormFactorMatrix elements = matrix_of(run.rows, n);
  constexpr std::size_t kPairs = 64;
  const PairSample sample = sample_pairs(scene, run.rows, options.pairs, kPairs, seed);
  if (!sample.complete) return {};
  for (const PairDefect& pair : sample.reciprocity) {
    result.reciprocity_max_defect = std::max(result.reciprocity_max_defect.value_or(0), pair.amount);
  }
  result.F = sum_to_patches(elements, mesh);
  return result;
}

}  // namespace exitance
