#include "src/dynamic/importance.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "geometry/point_shaft.h"
#include "geometry/viewpoint.h"
#include "src/scene/sample_site.h"

namespace exitance {
namespace {

/// A patch that no point sees counts with this share of what light spread evenly over the scene would give: some of the
/// object may see it.
constexpr double kUnseen = 0.02;

/// Of an estimate, errors of this size do not matter.
constexpr double kTolerance = 1e-6;

/// Patches of `before` that have shot and are not there any more take back all.
std::vector<double> own_areas(const VersionDifference& difference) {
  const auto& patches = difference.before().mesh().patches;
  std::vector<double> importance(std::max(difference.before().patches(), difference.after().patches()));
  for (std::uint32_t p = 0; p < patches.size(); ++p) {
    if (difference.before().object_of_patch(p) != SceneVersion::kVoid && !difference.keeps(p))
      importance[p] = patches[p].area;
  }
  return importance;
}

std::vector<Vec3> points_in(const Box& box, std::uint32_t points) {
  std::uint32_t per_edge = 1;
  while (per_edge * per_edge * per_edge < points) ++per_edge;
  std::vector<Vec3> all;
  const Vec3 size = box.upper - box.lower;
  const auto at = [&](std::uint32_t k) { return (k + 0.5) / per_edge; };
  for (std::uint32_t k = 0; k < points; ++k) {
    const std::uint32_t z = k / (per_edge * per_edge), y = k / per_edge % per_edge, x = k % per_edge;
    all.push_back(box.lower + Vec3{at(x) * size.x, at(y) * size.y, at(z) * size.z});
  }
  return all;
}

/// Looks from points past an object.
class LookPast {
 public:
  explicit LookPast(const SceneVersion& version) : version_(version), view_(version.soup()), shaft_(version.soup()) {}

  /// Form factor from a differential area that faces the patch to what is seen of it past the facets first … last − 1.
  double form_factor(const Vec3& point, std::uint32_t patch, std::uint32_t first, std::uint32_t last) {
    const PatchMesh& mesh = version_.mesh();
    const PolygonSoup& soup = version_.soup();
    double sum = 0;
    Vec3 middle;
    const auto pieces = mesh.pieces_of(mesh.patches[patch]);
    for (const PatchPiece& piece : pieces) {
      loop_.assign(mesh.loop(piece).begin(), mesh.loop(piece).end());
      if (loop_.empty()) {
        for (const Corner& c : soup.corners(soup.facets()[piece.facet])) loop_.push_back(c.at);
      }
      middle = middle + (piece.area / mesh.patches[patch].area) * centroid(loop_);
    }
    const Vec3 way = middle - point;
    if (pieces.empty() || way == Vec3{}) return 0;
    const Receiver receiver{point, way};
    bool looks = false;
    for (const PatchPiece& piece : pieces) {
      shaft_.reset(receiver, {piece.facet, mesh.loop(piece)});
      if (shaft_.is_empty()) continue;
      if (!looks) view_.look_from(receiver);
      looks = true;
      items_.clear();
      soup.index().find(shaft_.half_spaces(), shaft_.box(), items_);
      const auto facets = static_cast<std::uint32_t>(soup.facets().size());
      std::erase_if(items_, [&](std::uint32_t item) {
        const std::uint32_t facet = item < facets ? item : soup.shells()[item - facets].facets.front();
        return first <= facet && facet < last;
      });
      std::ranges::sort(items_);
      const PointFormFactor f = view_.form_factor({piece.facet, mesh.loop(piece)}, items_, kTolerance);
      if (f.side == Side::front) sum += f.F;
    }
    return sum;
  }

 private:
  const SceneVersion& version_;
  Viewpoint view_;
  PointShaft shaft_;
  std::vector<Vec3> loop_;
  std::vector<std::uint32_t> items_;
};

}  // namespace

std::vector<double> exact_importance(const VersionDifference& difference, const ObjectRows& known) {
  std::vector<double> importance = own_areas(difference);
  const auto add = [&](const SceneVersion& version, const ObjectSlot& slot, const ObjectRows& known_rows) {
    if (!slot.present) return;
    std::vector<PointRow> rows(slot.element_count);
    tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, slot.element_count, 1), [&](const auto& some) {
      for (std::uint32_t k = some.begin(); k < some.end(); ++k) {
        if (!known_rows.has(slot.element_first + k)) rows[k] = version.row(slot.element_first + k);
      }
    });
    for (std::uint32_t k = 0; k < slot.element_count; ++k) {
      const std::uint32_t e = slot.element_first + k;
      const PointRow& row = known_rows.has(e) ? known_rows.row(e) : rows[k];
      for (std::size_t i = 0; i < row.column.size(); ++i) {
        const std::uint32_t p = row.column[i];
        if (difference.keeps(p)) importance[p] += version.mesh().elements[e].area * row.F[i];
      }
    }
  };
  for (const std::uint32_t object : difference.objects()) {
    add(difference.before(), difference.before().slot(object), {});
    add(difference.after(), difference.after().slot(object), known);
  }
  return importance;
}

std::vector<double> estimated_importance(const VersionDifference& difference, std::uint32_t points,
                                         std::span<const std::uint32_t> patches) {
  std::vector<double> importance = own_areas(difference);
  const auto add = [&](const SceneVersion& version, const ObjectSlot& slot) {
    if (!slot.present) return;
    double area = 0;
    for (std::uint32_t p = 0; p < slot.patch_count; ++p) area += version.mesh().patches[slot.patch_first + p].area;
    const double share = area / 4 / points;
    double scene_area = 0;
    for (const Patch& patch : version.mesh().patches) scene_area += patch.area;
    for (const std::uint32_t p : patches) {
      if (difference.keeps(p))
        importance[p] += kUnseen * area / 4 * (difference.before().mesh().patches[p].area / scene_area);
    }
    tbb::enumerable_thread_specific<std::unique_ptr<LookPast>> looks(
        [&] { return std::make_unique<LookPast>(version); });
    for (const Vec3& point : points_in(slot.box, points)) {
      tbb::parallel_for(tbb::blocked_range<std::size_t>(0, patches.size(), 64), [&](const auto& some) {
        LookPast& look = *looks.local();
        for (std::size_t k = some.begin(); k < some.end(); ++k) {
          const std::uint32_t p = patches[k];
          if (difference.keeps(p))
            importance[p] += share * look.form_factor(point, p, slot.facet_first, slot.facet_last);
        }
      });
    }
  };
  for (const std::uint32_t object : difference.objects()) {
    add(difference.before(), difference.before().slot(object));
    add(difference.after(), difference.after().slot(object));
  }
  return importance;
}

}  // namespace exitance
