#include "geometry/view.h"

#include <algorithm>
#include <cmath>

namespace exitance {

View::View(const PolygonSoup& soup) : soup_(soup), facets_(soup.facets().size()), vertices_(soup.vertices().size()) {}

void View::look_from(const Receiver& receiver) {
  receiver_ = receiver;
  if (++epoch_ == 0) {
    std::fill(facets_.begin(), facets_.end(), SeenFacet{});
    std::fill(vertices_.begin(), vertices_.end(), SeenVertex{});
    epoch_ = 1;
  }
  covered_ = false;
  if (receiver.facet == kNone) return;
  for (const std::uint32_t t : soup_.coplanar(receiver.facet)) {
    covered_ = covered_ || (soup_.covers(t, receiver.facet) && holds_receiver(t));
  }
}

bool View::excluded(std::uint32_t facet) const {
  if (receiver_.facet == kNone) return false;
  if (facet == receiver_.facet) return true;  // facets of one polygon that is bent see each other
  const auto coplanar = soup_.coplanar(receiver_.facet);
  return std::binary_search(coplanar.begin(), coplanar.end(), facet);
}

const View::SeenFacet& View::seen(std::uint32_t facet) {
  SeenFacet& seen = facets_[facet];
  if (seen.epoch != epoch_) {
    seen.epoch = epoch_;
    const Facet& f = soup_.facets()[facet];
    seen.side = static_cast<std::int8_t>(side_of(f.plane, receiver_.point, counts_));
    const bool back_of_shell = seen.side < 0 && f.shell != kNone && outside(soup_.shells()[f.shell]);
    seen.facing = back_of_shell || excluded(facet) ? std::int8_t{0} : seen.side;
  }
  return seen;
}

int View::horizon(std::uint32_t vertex) {
  SeenVertex& seen = vertices_[vertex];
  if (seen.epoch != epoch_) {
    seen.epoch = epoch_;
    seen.sign =
        static_cast<std::int8_t>(horizon_side(receiver_.point, receiver_.normal, soup_.vertices()[vertex], counts_));
  }
  return seen.sign;
}

/// Whether the receiver, by identity in the facet's plane, lies in the facet's interior: exact in the projection along
/// the largest component of the normal.
bool View::holds_receiver(std::uint32_t facet) {
  const Facet& f = soup_.facets()[facet];
  const Vec3 n = f.plane.normal;
  const int axis = std::fabs(n.x) >= std::fabs(n.y) && std::fabs(n.x) >= std::fabs(n.z) ? 0
                   : std::fabs(n.y) >= std::fabs(n.z)                                   ? 1
                                                                                        : 2;
  const auto loop = soup_.corners(f);
  for (const int other : {(axis + 1) % 3, (axis + 2) % 3}) {
    const double at = receiver_.point[other];
    if (std::ranges::all_of(loop, [&](const Corner& c) { return c.at[other] <= at; }) ||
        std::ranges::all_of(loop, [&](const Corner& c) { return c.at[other] >= at; }))
      return false;
  }
  for (std::size_t k = 0; k < loop.size(); ++k) {
    Vec3 p = soup_.vertices()[loop[k].vertex], q = soup_.vertices()[loop[(k + 1) % loop.size()].vertex];
    Vec3 v = receiver_.point, above = p;  // three points in the plane of projection and one on the normal's side of it
    p[axis] = q[axis] = v[axis] = 0;
    above[axis] = n[axis] > 0 ? 1 : -1;
    if (orientation(p, q, v, above, counts_) <= 0) return false;
  }
  return true;
}

}  // namespace exitance
