#include "src/visibility/contacts.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace exitance {
namespace {

constexpr double kNear = 0x1p-49;  // of the extent
constexpr double kOfComputed = 8;  // times that, for points that were computed and not given

bool face_against(const Plane& a, const Plane& b) {
  return dot(a.normal, b.normal) < -0.5 * norm(a.normal) * norm(b.normal);
}

}  // namespace

bool lies_within(const PolygonSoup& soup, std::uint32_t facet, const Vec3& point) {
  const Facet& f = soup.facets()[facet];
  const auto corners = soup.corners(f);
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Vec3 &a = corners[k].at, &b = corners[(k + 1) % corners.size()].at;
    if (dot(cross(b - a, point - a), f.plane.normal) < 0) return false;
  }
  return true;
}

Contacts::Contacts(const PolygonSoup& soup)
    : soup_(&soup), near_(kNear * soup.extent()), lying_on_(soup.facets().size()) {
  const auto set = [&](std::uint32_t f, LyingOn found) {
    if (!found.empty()) lying_on_.set(f, std::move(found));
  };
  for (std::uint32_t f = 0; f < soup.facets().size(); ++f) {
    if (soup.is_present(f)) set(f, find_lying_on(f));
  }
}

Contacts::Contacts(const Contacts& before, const PolygonSoup& soup)
    : soup_(&soup), near_(before.near_), lying_on_(before.lying_on_) {
  for (const std::uint32_t f : soup.touched()) lying_on_.set(f, find_lying_on(f));
}

Contacts::LyingOn Contacts::find_lying_on(std::uint32_t f) const {
  LyingOn found;
  const auto facets = soup_->facets();
  const Plane& plane = facets[f].plane;
  const auto coplanar = soup_->coplanar(f);
  for (const std::uint32_t t : coplanar) {
    if (!soup_->covers(t, f)) continue;
    const bool of_solid = soup_->role(facets[t].polygon) != Role::sheet && face_against(facets[t].plane, plane);
    (of_solid ? found.burying : found.overlying).push_back(t);
  }
  std::vector<std::uint32_t> items, near;
  soup_->index().find(soup_->box_of(f).grown(near_), items);
  for (const std::uint32_t item : items) {
    if (item < facets.size()) {
      near.push_back(item);
    } else {
      const auto& of_shell = soup_->shells()[item - facets.size()].facets;
      near.insert(near.end(), of_shell.begin(), of_shell.end());
    }
  }
  std::ranges::sort(near);
  for (const std::uint32_t t : near) {
    if (t == f || std::ranges::binary_search(coplanar, t)) continue;
    if (face_against(facets[t].plane, plane) && reaches(t, plane) &&
        !are_sides_of_a_sheet(facets[t].polygon, facets[f].polygon))
      found.touching.push_back(t);
  }
  return found;
}

bool Contacts::touched(std::uint32_t facet, const Vec3& point) const {
  return any_at(lying_on_[facet].touching, point, near_);
}

bool Contacts::buried(std::uint32_t facet, const Vec3& point) const {
  return any_at(lying_on_[facet].burying, point, kOfComputed * near_ + soup_->pile()) ||
         any_at(lying_on_[facet].touching, point, kOfComputed * near_);
}

bool Contacts::overlaid(std::uint32_t facet, const Vec3& point) const {
  return any_at(lying_on_[facet].overlying, point, kOfComputed * near_ + soup_->pile());
}

Contacts::Pair Contacts::pair(std::uint32_t i, std::uint32_t j) const {
  Pair pair;
  pair.contacts_ = this;
  pair.i_ = i;
  pair.j_ = j;
  pair.overlying_ = may_be_overlaid(i) || may_be_overlaid(j);
  pair.burying_ = burying_count(i) > 0 && burying_count(j) > 0;
  return pair;
}

bool Contacts::Pair::cover(const Vec3& point_i, const Vec3& point_j) const {
  if (overlying_ && (contacts_->overlaid(i_, point_i) || contacts_->overlaid(j_, point_j))) return true;
  if (!burying_) return false;
  return contacts_->burying_count(i_) <= contacts_->burying_count(j_) ? contacts_->buried(i_, point_i)
                                                                      : contacts_->buried(j_, point_j);
}

bool Contacts::any_at(std::span<const std::uint32_t> facets, const Vec3& point, double near) const {
  return std::ranges::any_of(facets, [&](std::uint32_t facet) {
    const Facet& f = soup_->facets()[facet];
    if (std::fabs(dot(f.plane.normal, point - f.plane.origin)) > near * norm(f.plane.normal)) return false;
    return lies_within(*soup_, facet, point);
  });
}

/// Facets of the two that lie exactly in one plane do not cover each other: then nor do those that do but for rounding.
bool Contacts::are_sides_of_a_sheet(std::uint32_t p, std::uint32_t q) const {
  for (std::uint32_t f = soup_->first_facet(q); f < soup_->first_facet(q + 1); ++f) {
    for (const std::uint32_t t : soup_->coplanar(f)) {
      const auto facets = soup_->facets();
      if (facets[t].polygon == p && face_against(facets[t].plane, facets[f].plane) && !soup_->covers(t, f)) return true;
    }
  }
  return p == q;
}

std::vector<std::uint32_t> Contacts::covering(std::uint32_t facet) const {
  const LyingOn& on = lying_on_[facet];
  std::vector<std::uint32_t> found = on.overlying;
  found.insert(found.end(), on.burying.begin(), on.burying.end());
  std::ranges::copy_if(on.touching, std::back_inserter(found),
                       [&](std::uint32_t t) { return lies_in(t, soup_->facets()[facet].plane); });
  return found;
}

bool Contacts::lies_in(std::uint32_t facet, const Plane& plane) const {
  const double limit = kOfComputed * near_ * norm(plane.normal);
  return std::ranges::all_of(soup_->corners(soup_->facets()[facet]), [&](const Corner& c) {
    return std::fabs(dot(plane.normal, c.at - plane.origin)) <= limit;
  });
}

/// Whether some of the facet lies in the plane, or nearly.
bool Contacts::reaches(std::uint32_t facet, const Plane& plane) const {
  const double limit = 2 * kOfComputed * near_ * norm(plane.normal);
  bool before = false, behind = false;
  for (const Corner& c : soup_->corners(soup_->facets()[facet])) {
    const double height = dot(plane.normal, c.at - plane.origin);
    before = before || height >= -limit;
    behind = behind || height <= limit;
  }
  return before && behind;
}

}  // namespace exitance
