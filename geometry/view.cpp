#include "geometry/view.h"

#include <algorithm>
#include <cmath>

#include "geometry/lanes.h"

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
  coplanar_ = {};
  if (receiver.facet == kNone) return;
  coplanar_ = soup_.coplanar(receiver.facet);
  for (const std::uint32_t t : coplanar_) {
    covered_ = covered_ || (soup_.covers(t, receiver.facet) && holds_receiver(t));
  }
}

bool View::excluded(std::uint32_t facet) const {
  if (facet == receiver_.facet) return true;  // facets of one polygon that is bent see each other
  return std::ranges::binary_search(coplanar_, facet);
}

const View::SeenFacet& View::seen(std::uint32_t facet) {
  SeenFacet& seen = facets_[facet];
  if (seen.epoch != epoch_) {
    const Facet& f = soup_.facets()[facet];
    const int side = side_of(f.plane, receiver_.point, counts_);
    set(seen, facet, side, side < 0 && f.shell != kNone && outside(soup_.shells()[f.shell]));
  }
  return seen;
}

void View::set(SeenFacet& seen, std::uint32_t facet, int side, bool outside_shell) {
  seen.epoch = epoch_;
  seen.side = static_cast<std::int8_t>(side);
  seen.facing = (side < 0 && outside_shell) || excluded(facet) ? std::int8_t{0} : seen.side;
}

/// As side_of, by the bound that is proven there (polygon_soup.cpp), four at a time, the last facet once more where
/// there are fewer.
void View::look_at(const Shell& shell) {
  const bool is_outside = outside(shell);
  const Vec3 x = receiver_.point;
  const auto magnitude = [](const Doubles& v) { return v < 0 ? -v : v; };
  for (std::size_t first = 0; first < shell.facets.size(); first += kLanes) {
    const auto number = [&](std::size_t k) { return shell.facets[std::min(first + k, shell.facets.size() - 1)]; };
    const Plane* const plane[kLanes] = {&soup_.facets()[number(0)].plane, &soup_.facets()[number(1)].plane,
                                        &soup_.facets()[number(2)].plane, &soup_.facets()[number(3)].plane};
    const auto four = [&](const auto& of) {
      return Doubles{of(*plane[0]), of(*plane[1]), of(*plane[2]), of(*plane[3])};
    };
    const Doubles w_x = x.x - four([](const Plane& p) { return p.origin.x; }),
                  w_y = x.y - four([](const Plane& p) { return p.origin.y; }),
                  w_z = x.z - four([](const Plane& p) { return p.origin.z; });
    const Doubles value = four([](const Plane& p) { return p.normal.x; }) * w_x +
                          four([](const Plane& p) { return p.normal.y; }) * w_y +
                          four([](const Plane& p) { return p.normal.z; }) * w_z;
    const Doubles bound = (1.01 * four([](const Plane& p) { return p.normal_error; }) +
                           5 * kRoundoff * four([](const Plane& p) { return p.normal_size; })) *
                              (magnitude(w_x) + magnitude(w_y) + magnitude(w_z)) +
                          0x1p-1000;
    const SignBytes signs = certain_signs(value, bound);
    for (std::size_t k = 0; k < std::min(kLanes, shell.facets.size() - first); ++k) {
      SeenFacet& seen = facets_[number(k)];
      const int certain = sign_byte(signs, k);
      if (certain != 0) ++counts_.filter;
      set(seen, number(k), certain != 0 ? certain : side_of(*plane[k], x, counts_), is_outside);
    }
  }
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
