#include "geometry/shadow_volume.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace exitance {
namespace {

/// A point this share of the scene's extent away from the object may be in contact with it.
constexpr double kContact = 0x1p-40;

}  // namespace

ShadowCaster::ShadowCaster(const PolygonSoup& soup, std::uint32_t first_facet, std::uint32_t last_facet)
    : soup_(soup), first_(first_facet), last_(last_facet) {
  std::vector<Box> boxes(last_ - first_);
  std::vector<std::uint32_t> shells;
  for (std::uint32_t f = first_; f < last_; ++f) {
    const Facet& facet = soup.facets()[f];
    for (const Corner& c : soup.corners(facet)) {
      boxes[f - first_].extend(c.at);
      vertices_.push_back(c.vertex);
    }
    box_.extend(boxes[f - first_]);
    if (facet.shell != kNone) shells.push_back(facet.shell);
  }
  index_ = SpatialIndex(boxes);
  const auto each_once = [](std::vector<std::uint32_t>& list) {
    std::ranges::sort(list);
    list.erase(std::unique(list.begin(), list.end()), list.end());
  };
  each_once(vertices_);
  each_once(shells);
  for (const std::uint32_t s : shells) {
    const Shell& shell = soup.shells()[s];
    if (shell.convex && has(shell.facets.front()) && has(shell.facets.back())) convex_shells_.push_back(s);
  }
}

ShadowVolume::ShadowVolume(const ShadowCaster& caster)
    : caster_(caster), point_shaft_(caster.soup()), shaft_(caster.soup()) {}

void ShadowVolume::set_shooter(const ShaftEnd& shooter) {
  const PolygonSoup& soup = caster_.soup();
  const Plane& plane = soup.facets()[shooter.facet].plane;
  loop_.assign(shooter.loop.begin(), shooter.loop.end());
  if (loop_.empty()) {
    for (const Corner& c : soup.corners(soup.facets()[shooter.facet])) loop_.push_back(c.at);
  }
  shooter_ = {shooter.facet, loop_};
  const auto coplanar = soup.coplanar(shooter.facet);
  Box box;
  for (const Vec3& v : loop_) box.extend(v);
  box = box.grown(soup.pile());
  covers_shooter_ = std::any_of(coplanar.begin(), coplanar.end(), [&](std::uint32_t t) {
    return caster_.has(t) && soup.covers(t, shooter.facet) && soup.box_of(t).overlaps(box);
  });

  region_.clear();
  const double reach = 4 * soup.extent();
  const auto lowered = [&](const Vec3& normal, double normal_error, double offset) {
    return offset - (2 * normal_error + 32 * kRoundoff * norm(normal)) * reach;
  };
  std::vector<std::int8_t> side;
  double lowest = std::numeric_limits<double>::infinity();
  bool behind = false;
  for (const std::uint32_t v : caster_.vertices()) {
    const Vec3& at = soup.vertices()[v];
    side.push_back(static_cast<std::int8_t>(side_of(plane, at, counts_)));
    behind = behind || side.back() < 0;
    lowest = std::min(lowest, dot(plane.normal, at));
  }
  const double own = dot(plane.normal, plane.origin);
  region_.push_back({plane.normal, lowered(plane.normal, plane.normal_error, std::max(own, lowest))});
  if (behind) return;
  for (std::size_t k = 0; k < loop_.size(); ++k) {
    const Vec3 &p = loop_[k], &q = loop_[k + 1 < loop_.size() ? k + 1 : 0];
    if (p == q) continue;
    const Vec3* nearest = nullptr;  // turned about the edge, starting at the shooter
    bool separates = true;
    for (std::size_t i = 0; i < side.size() && separates; ++i) {
      const Vec3& v = soup.vertices()[caster_.vertices()[i]];
      if (side[i] == 0) {
        separates = dot(cross(q - p, v - p), plane.normal) <= 0;  // else it lies beside the shooter on the inner side
      } else if (nearest == nullptr || orientation(p, q, *nearest, v, counts_) < 0) {
        nearest = &v;
      }
    }
    if (!separates || nearest == nullptr) continue;
    const Vec3 a = q - p, b = *nearest - p, normal = cross(a, b);
    region_.push_back({normal, lowered(normal, 5 * kRoundoff * norm(a) * norm(b), dot(normal, p))});
  }
}

/// Whether a facet of the object may lie in the receiver's plane and over the point, or against it.
bool ShadowVolume::lies_over(const Receiver& receiver) const {
  const PolygonSoup& soup = caster_.soup();
  const double near = kContact * soup.extent();
  if (!caster_.box().contains(receiver.point, near)) return false;
  Box box;
  box.extend(receiver.point - Vec3{near, near, near});
  box.extend(receiver.point + Vec3{near, near, near});
  std::vector<std::uint32_t> found;
  caster_.index().find(box, found);
  return std::ranges::any_of(found, [&](std::uint32_t k) {
    const Facet& f = soup.facets()[caster_.first() + k];
    return std::fabs(dot(f.plane.normal, receiver.point - f.plane.origin)) <= near * norm(f.plane.normal);
  });
}

/// Whether other facets of the object hide all that a facet hides from a point: those in front of it of the same convex
/// solid.
bool ShadowVolume::is_behind_its_shell(std::uint32_t facet, const Vec3& from) {
  const PolygonSoup& soup = caster_.soup();
  const Facet& f = soup.facets()[facet];
  return f.shell != kNone && std::ranges::binary_search(caster_.convex_shells(), f.shell) &&
         side_of(f.plane, from, counts_) < 0 && !soup.shells()[f.shell].box.contains(from, 0);
}

Shade ShadowVolume::at(const Receiver& receiver, std::span<const std::uint32_t> screens) {
  const PolygonSoup& soup = caster_.soup();
  point_shaft_.reset(receiver, shooter_);
  if (point_shaft_.is_empty()) return Shade::outside;
  Shade shade = covers_shooter_ ? Shade::penumbra : Shade::outside;
  found_.clear();
  if (caster_.box().overlaps(point_shaft_.box()))
    caster_.index().find(point_shaft_.half_spaces(), point_shaft_.box(), found_);
  bool screens_are_set = screens.empty();
  const auto takes = [&](std::uint32_t k) {
    const std::uint32_t facet = caster_.first() + k;
    if (is_behind_its_shell(facet, receiver.point) || !point_shaft_.enters(facet)) return false;
    if (!std::exchange(screens_are_set, true)) point_shaft_.set_screens(screens);
    return screens.empty() || !point_shaft_.hidden(facet);
  };
  if (std::ranges::any_of(found_, takes)) {
    const auto blocked = std::ranges::any_of(caster_.convex_shells(), [&](std::uint32_t s) {
      return soup.shells()[s].box.overlaps(point_shaft_.box()) && point_shaft_.blocks(soup.shells()[s]);
    });
    if (blocked ||
        std::ranges::any_of(found_, [&](std::uint32_t k) { return point_shaft_.blocks(caster_.first() + k); }))
      return Shade::umbra;
    shade = Shade::penumbra;
  }
  if (shade == Shade::outside && lies_over(receiver)) shade = Shade::penumbra;
  return shade;
}

Shade ShadowVolume::of(const ShaftEnd& receiver) {
  const PolygonSoup& soup = caster_.soup();
  shaft_.reset(receiver, shooter_);
  if (!shaft_.face_each_other()) return Shade::outside;
  Shade shade = covers_shooter_ ? Shade::penumbra : Shade::outside;
  const auto add = [&](std::uint32_t item) {
    switch (shaft_.overlap(item)) {
      case Shaft::Overlap::outside:
        return;
      case Shaft::Overlap::partial:
        shade = std::max(shade, Shade::penumbra);
        return;
      case Shaft::Overlap::blocking:
        shade = Shade::umbra;
    }
  };
  const auto facets = static_cast<std::uint32_t>(soup.facets().size());
  for (const std::uint32_t s : caster_.convex_shells()) add(facets + s);
  for (std::uint32_t f = caster_.first(); f < caster_.last() && shade != Shade::umbra; ++f) {
    const std::uint32_t shell = soup.facets()[f].shell;
    if (shell != kNone && std::ranges::binary_search(caster_.convex_shells(), shell)) continue;
    add(f);
  }
  return shade;
}

}  // namespace exitance
