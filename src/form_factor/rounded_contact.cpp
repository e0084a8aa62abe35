#include "src/form_factor/rounded_contact.h"

#include <algorithm>
#include <cmath>

#include "geometry/level.h"
#include "src/visibility/contacts.h"

namespace exitance {
namespace {

bool in_contact(const PolygonSoup& soup, std::uint32_t face, std::uint32_t polygon) {
  const Plane& plane = soup.facets()[polygon].plane;
  if (!(dot(soup.facets()[face].plane.normal, plane.normal) < 0)) return false;
  const double flat = kLevel * soup.extent() * norm(plane.normal);
  const auto coplanar = soup.coplanar(polygon);
  return !std::ranges::binary_search(coplanar, face) &&
         std::ranges::all_of(soup.corners(soup.facets()[face]), [&](const Corner& c) {
           return std::fabs(dot(plane.normal, c.at - plane.origin)) <= flat;
         });
}

/// That of a triangle as seen from the origin, positive seen from its back (Van Oosterom and Strackee 1983).
double solid_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double A = norm(a), B = norm(b), C = norm(c);
  return 2 * std::atan2(dot(a, cross(b, c)), A * B * C + dot(a, b) * C + dot(b, c) * A + dot(c, a) * B);
}

}  // namespace

RoundedContact::RoundedContact(const PolygonSoup& soup, const Source& receiver, const Source& source,
                               std::span<const std::uint32_t> items)
    : soup_(&soup) {
  const auto facets = static_cast<std::uint32_t>(soup.facets().size());
  std::vector<std::uint32_t> shells;
  for (const std::uint32_t item : items) {
    const std::uint32_t shell = item < facets ? soup.facets()[item].shell : item - facets;
    if (shell != kNone && shell != soup.facets()[receiver.facet].shell) shells.push_back(shell);
  }
  std::ranges::sort(shells);
  shells.erase(std::unique(shells.begin(), shells.end()), shells.end());
  for (const std::uint32_t s : shells) {
    bool stands = false, of_source = false;
    for (const std::uint32_t f : soup.shells()[s].facets) {
      if (in_contact(soup, f, receiver.facet)) {
        faces_.push_back(f);
        stands = true;
      }
      of_source = of_source || in_contact(soup, f, source.facet);
    }
    if (of_source && !stands) shells_.push_back(s);
  }
  std::ranges::sort(faces_);
}

bool RoundedContact::buries(const Vec3& point) const {
  return std::ranges::any_of(faces_, [&](std::uint32_t f) { return lies_within(*soup_, f, point); }) ||
         std::ranges::any_of(shells_, [&](std::uint32_t s) { return holds(soup_->shells()[s], point); });
}

/// From within, a closed surface is seen all around.
bool RoundedContact::holds(const Shell& shell, const Vec3& point) const {
  for (int axis = 0; axis < 3; ++axis) {
    if (point[axis] < shell.box.lower[axis] || point[axis] > shell.box.upper[axis]) return false;
  }
  double angle = 0;
  for (const std::uint32_t f : shell.facets) {
    const auto c = soup_->corners(soup_->facets()[f]);
    for (std::size_t k = 1; k + 1 < c.size(); ++k) {
      angle += solid_angle(c[0].at - point, c[k].at - point, c[k + 1].at - point);
    }
  }
  return angle > 6;  // it is 4π or 0
}

}  // namespace exitance
