#include "src/form_factor/area_closure.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "geometry/viewpoint.h"
#include "src/form_factor/area_cell.h"
#include "src/form_factor/area_rows.h"

namespace exitance {
namespace {

/// Rows that lack of 1 no more than their errors and this need no excuse.
constexpr double kRounding = 1e-13;

/// Whether a facet shows something else than its front to a point.
bool may_show_a_back(const PolygonSoup& soup, std::uint32_t facet, const Vec3& from) {
  const Facet& f = soup.facets()[facet];
  const Role role = soup.role(f.polygon);
  if (role == Role::unoccluding) return false;
  return role != Role::patch || dot(f.plane.normal, from - f.plane.origin) < 0;
}

bool sees_backs(const PatchMesh& mesh, const PolygonSoup& soup, const Element& element, Viewpoint& view) {
  constexpr int kOrder = 3;
  constexpr double kPointTolerance = 1e-6;
  std::vector<WeightedPoint> points;
  for (const PatchPiece& piece : mesh.pieces_of(element)) {
    for (const AreaCell& cell : cells_of(corners_of(soup, {piece.facet, mesh.loop(piece)}))) {
      gauss_points(cell, kOrder, points);
      for (const WeightedPoint& p : points) {
        view.look_from({p.point, soup.facets()[piece.facet].plane.normal, piece.facet});
        for (std::uint32_t f = 0; f < soup.facets().size(); ++f) {
          if (soup.is_present(f) && may_show_a_back(soup, f, p.point) &&
              view.form_factor({f, {}}, kPointTolerance).F > 0) {
            return true;
          }
        }
      }
    }
  }
  return false;
}

}  // namespace

AreaClosure area_closure(const PatchMesh& mesh, const PolygonSoup& soup, const FormFactorMatrix& rows, bool closed) {
  AreaClosure result;
  const std::vector<double> sums = row_sums(rows);
  const Contacts contacts(soup);
  Viewpoint view(soup);
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    const auto errors = rows.row_error(e);
    const double error = std::accumulate(errors.begin(), errors.end(), 0.0), defect = std::fabs(sums[e] - 1);
    result.largest_row_error = std::max(result.largest_row_error, error);
    const Element& element = mesh.elements[e];
    const bool needs_excuse = closed && 1 - sums[e] > error + kRounding;
    if (may_be_covered(soup, contacts, mesh.pieces_of(element)) ||
        (needs_excuse && sees_backs(mesh, soup, element, view))) {
      ++result.not_judged;
    } else if (closed) {
      result.max_defect = std::max(result.max_defect, defect);
    }
  }
  return result;
}

}  // namespace exitance
