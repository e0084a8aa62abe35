#include "src/form_factor/point_rows.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace exitance {
namespace {

/// A point in a contact that holds only up to rounding, as of turned boxes, may see out through the gap of an ulp. What
/// is below the rounding of 1 is no view.
constexpr double kSeesNothing = 0x1p-53;

/// The corners of patches are rounded to some 2^-52 of the scene's extent. What lies nearer to a point than this share
/// of the extent lies in contact with it: seen from so near, patches would leave gaps and overlap.
constexpr double kInContact = 0x1p-49;

/// One thread's work: a point of view and the row it fills.
class RowMaker {
 public:
  RowMaker(const PatchMesh& mesh, const PolygonSoup& soup) : mesh_(mesh), soup_(soup), view_(soup) {}

  struct Row {
    std::vector<std::uint32_t> column;
    std::vector<double> F, F_error;
    PointRowStatistics statistics;
  };

  Row row(std::size_t element) {
    Row row;
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

  PointFormFactor entry(std::size_t element, std::size_t patch) {
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
    return !view_.covered() && !is_in_contact(e);
  }

  /// Whether a facet that faces the point lies against it up to rounding.
  bool is_in_contact(const Element& e) {
    const double near = kInContact * soup_.extent();
    const auto facets = static_cast<std::uint32_t>(soup_.facets().size());
    Box box;
    box.extend(e.sample - Vec3{near, near, near});
    box.extend(e.sample + Vec3{near, near, near});
    found_.clear();
    soup_.index().find(box, found_);
    return std::ranges::any_of(found_, [&](std::uint32_t item) {
      if (item < facets) return lies_against(item, e, near);
      return std::ranges::any_of(soup_.shells()[item - facets].facets,
                                 [&](std::uint32_t f) { return lies_against(f, e, near); });
    });
  }

  bool lies_against(std::uint32_t facet, const Element& e, double near) const {
    const Facet& f = soup_.facets()[facet];
    const double size = norm(f.plane.normal);
    if (facet == e.facet || dot(f.plane.normal, e.normal) > -0.5 * size) return false;
    if (std::fabs(dot(f.plane.normal, e.sample - f.plane.origin)) > near * size) return false;
    const auto corners = soup_.corners(f);
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const Vec3 &a = corners[k].at, &b = corners[(k + 1) % corners.size()].at;
      if (dot(cross(b - a, e.sample - a), f.plane.normal) < 0) return false;
    }
    return true;
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
      const Role role = soup_.role(soup_.facets()[f].polygon);
      if (role == Role::sheet || role == Role::solid_face) seen += view_.form_factor({f, {}}, kPointTolerance).F;
    }
    return seen;
  }

  const PatchMesh& mesh_;
  const PolygonSoup& soup_;
  Viewpoint view_;
  std::vector<std::uint32_t> found_;
};

using RowMakers = tbb::enumerable_thread_specific<RowMaker>;

/// Makes the row of element(k) for k = 0 … count − 1 and gives each to sink(row), in order.
template <class ElementOf, class Sink>
void for_each_row(const PatchMesh& mesh, const PolygonSoup& soup, std::size_t count, const ElementOf& element,
                  const Progress& progress, const Sink& sink) {
  RowMakers makers([&] { return RowMaker(mesh, soup); });
  // Blocks are small enough to report progress between them and large enough to keep all threads busy.
  constexpr std::size_t kBlock = 256;
  std::vector<RowMaker::Row> rows;
  for (std::size_t begin = 0; begin < count; begin += kBlock) {
    const std::size_t end = std::min(count, begin + kBlock);
    rows.assign(end - begin, {});
    tbb::parallel_for(tbb::blocked_range<std::size_t>(begin, end, 1), [&](const auto& range) {
      RowMaker& maker = makers.local();
      for (std::size_t k = range.begin(); k < range.end(); ++k) rows[k - begin] = maker.row(element(k));
    });
    for (const auto& row : rows) sink(row);
    if (progress) progress(static_cast<double>(end) / static_cast<double>(count), "form factors");
  }
}

}  // namespace

PointRowStatistics& PointRowStatistics::operator+=(const PointRowStatistics& other) {
  pairs += other.pairs;
  stages += other.stages;
  extended += other.extended;
  covered_points += other.covered_points;
  closure_max_defect = std::max(closure_max_defect, other.closure_max_defect);
  return *this;
}

PointRows point_rows(const PatchMesh& mesh, const PolygonSoup& soup, std::size_t first, std::size_t last,
                     const Progress& progress) {
  PointRows result;
  result.F.columns = static_cast<std::uint32_t>(mesh.patches.size());
  for_each_row(
      mesh, soup, last - first, [&](std::size_t k) { return first + k; }, progress,
      [&](const RowMaker::Row& row) {
        result.F.column.insert(result.F.column.end(), row.column.begin(), row.column.end());
        result.F.F.insert(result.F.F.end(), row.F.begin(), row.F.end());
        result.F.F_error.insert(result.F.F_error.end(), row.F_error.begin(), row.F_error.end());
        result.F.row_first.push_back(result.F.F.size());
        result.statistics += row.statistics;
      });
  return result;
}

PointRowStatistics point_row_statistics(const PatchMesh& mesh, const PolygonSoup& soup,
                                        std::span<const std::size_t> elements, const Progress& progress) {
  PointRowStatistics sum;
  for_each_row(
      mesh, soup, elements.size(), [&](std::size_t k) { return elements[k]; }, progress,
      [&](const RowMaker::Row& row) { sum += row.statistics; });
  return sum;
}

void point_column(const PatchMesh& mesh, const PolygonSoup& soup, std::size_t patch, std::span<double> F,
                  std::span<double> F_error) {
  RowMakers makers([&] { return RowMaker(mesh, soup); });
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, mesh.elements.size(), 256), [&](const auto& range) {
    RowMaker& maker = makers.local();
    for (std::size_t e = range.begin(); e < range.end(); ++e) {
      const PointFormFactor f = maker.entry(e, patch);
      F[e] = f.F;
      F_error[e] = f.error;
    }
  });
}

PointFormFactor patch_form_factor(const PatchMesh& mesh, const PolygonSoup& soup, std::size_t receiver,
                                  std::size_t source) {
  RowMaker maker(mesh, soup);
  const Patch& patch = mesh.patches[receiver];
  PointFormFactor mean;
  for (std::uint32_t e = patch.element_first; e < patch.element_first + patch.element_count; ++e) {
    const PointFormFactor f = maker.entry(e, source);
    mean.F += f.F * mesh.elements[e].area / patch.area;
    mean.error += f.error * mesh.elements[e].area / patch.area;
  }
  return mean;
}

double expected_row_length(const PatchMesh& mesh, const PolygonSoup& soup) {
  constexpr std::size_t kElements = 8, kPatches = 4096;
  const std::size_t n = mesh.elements.size(), patches = mesh.patches.size();
  const std::size_t rows = std::min(n, kElements), columns = std::min(patches, kPatches);
  if (rows == 0) return 0;
  RowMaker maker(mesh, soup);
  std::size_t entries = 0;
  for (std::size_t k = 0; k < rows; ++k) {
    for (std::size_t c = 0; c < columns; ++c)
      entries += maker.entry(n * (2 * k + 1) / (2 * rows), patches * (2 * c + 1) / (2 * columns)).F > 0;
  }
  return static_cast<double>(entries) / static_cast<double>(rows * columns) * static_cast<double>(patches);
}

}  // namespace exitance
