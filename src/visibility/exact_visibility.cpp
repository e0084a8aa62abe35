#include "src/visibility/exact_visibility.h"

#include <algorithm>
#include <cmath>

namespace exitance {
namespace {

/// A point in a contact that holds only up to rounding, as of turned boxes, may see out through the gap of an ulp. What
/// is below the rounding of 1 is no view.
constexpr double kSeesNothing = 0x1p-53;

class ExactObserver final : public Observer {
 public:
  ExactObserver(const PatchMesh& mesh, const PolygonSoup& soup, const Contacts& contacts)
      : mesh_(mesh), soup_(soup), contacts_(contacts), view_(soup) {}

  PointRow row(std::size_t element) override {
    PointRow row;
    const StageCounts stages_before = view_.stage_counts();
    const std::uint64_t extended_before = view_.extended_count();
    if (!look_from(element)) {
      row.statistics.covered_points = 1;
      return row;
    }
    double front = 0, back = 0;
    for (std::uint32_t p = 0; p < mesh_.patches.size(); ++p) {
      const PointFormFactor f = to_patch(p, back, row.statistics.pairs);
      if (f.F > 0) {
        row.column.push_back(p);
        row.F.push_back(f.F);
        row.F_error.push_back(f.error);
        front += f.F;
      }
    }
    const double seen = front + back + obstructions();
    if (front == 0 || seen < kSeesNothing) {
      row.statistics.covered_points = 1;
    } else {
      row.statistics.closure_max_defect = std::fabs(seen - 1);
    }
    row.statistics.stages = difference(view_.stage_counts(), stages_before);
    row.statistics.extended = view_.extended_count() - extended_before;
    return row;
  }

  PointFormFactor entry(std::size_t element, std::size_t patch) override {
    if (!look_from(element)) return {};
    double back = 0;
    PairCounts pairs;
    return to_patch(static_cast<std::uint32_t>(patch), back, pairs);
  }

 private:
  static StageCounts difference(const StageCounts& a, const StageCounts& b) {
    return {a.filter - b.filter, a.interval - b.interval, a.exact - b.exact};
  }

  /// False for a point in contact, which sees nothing.
  bool look_from(std::size_t element) {
    const Element& e = mesh_.elements[element];
    view_.look_from({e.sample, e.normal, e.facet});
    return !view_.covered() && !contacts_.touched(e.facet, e.sample);
  }

  /// F to the patch's front, the sum of its pieces'; adds what is seen of its back.
  PointFormFactor to_patch(std::uint32_t patch, double& back, PairCounts& pairs) {
    PointFormFactor sum;
    bool open = false, blocked = false, partial = false;
    for (const PatchPiece& piece : mesh_.pieces_of(mesh_.patches[patch])) {
      const PointFormFactor f = view_.form_factor({piece.facet, mesh_.loop(piece)}, kPointTolerance);
      if (f.side == Side::back) back += f.F;
      if (f.side != Side::front) continue;
      sum.F += f.F;
      sum.error += f.error;
      open = open || f.visibility == Visibility::open;
      blocked = blocked || f.visibility == Visibility::blocked;
      partial = partial || f.visibility == Visibility::partial;
    }
    if (partial || (open && blocked)) {
      ++pairs.partial;
    } else if (open) {
      ++pairs.open;
    } else if (blocked) {
      ++pairs.blocked;
    } else {
      ++pairs.facing_away;
    }
    return sum;
  }

  double obstructions() {
    double seen = 0;
    for (std::uint32_t f = 0; f < soup_.facets().size(); ++f) {
      if (!soup_.is_present(f)) continue;
      const Role role = soup_.role(soup_.facets()[f].polygon);
      if (role == Role::sheet || role == Role::solid_face) seen += view_.form_factor({f, {}}, kPointTolerance).F;
    }
    return seen;
  }

  const PatchMesh& mesh_;
  const PolygonSoup& soup_;
  const Contacts& contacts_;
  Viewpoint view_;
};

}  // namespace

std::unique_ptr<Observer> ExactVisibility::observer() const {
  return std::make_unique<ExactObserver>(mesh_, soup_, contacts_);
}

}  // namespace exitance
