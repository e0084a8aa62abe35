#pragma once
// The cones in which occluders are seen from the current view, kept because every occluder is met on the way to many
// sources.

#include <memory>
#include <utility>

#include "geometry/silhouette.h"
#include "geometry/view.h"

namespace exitance {

/// Corners of a polygon, input points.
using PointLoop = std::span<const Vec3* const>;

/// Of cones with a part above the horizon: an edge on or below the horizon bounds nothing, and above the horizon the
/// cone is the same without it, because the cut of a convex cone by the horizon has its closing side in the horizon
/// itself. So those sides are left out.
template <class Real>
class ViewCones {
 public:
  explicit ViewCones(View& view) : view_(view), soup_(view.soup()) {}

  /// The cone of a facet, which must not be seen edge-on. Valid until the view moves.
  const Cone<Real>& of_facet(std::uint32_t facet) {
    bool is_new = false;
    Cone<Real>& cone = cached(facet, is_new);
    if (is_new) {
      set_whole(cone, facet);
      drop_below_horizon(cone);
    }
    return cone;
  }

  /// The silhouette of a convex shell: the edges between faces that are seen from the front and others. A face in the
  /// receiver's plane counts by the side on which the rounded point lies; without it the ring might not be convex.
  const Cone<Real>& of_shell(std::uint32_t shell) {
    bool is_new = false;
    Cone<Real>& cone = cached(static_cast<std::uint32_t>(soup_.facets().size()) + shell, is_new);
    if (is_new) set_silhouette(cone, shell);
    return cone;
  }

  /// The same edges of any shell that the point is outside of. Valid until the view moves.
  const Silhouette<Real>& silhouette_of(std::uint32_t shell) {
    if (silhouettes_.empty()) silhouettes_.resize(soup_.shells().size());
    auto& [epoch, silhouette] = silhouettes_[shell];
    if (epoch != view_.epoch() || !silhouette) {
      epoch = view_.epoch();
      if (!silhouette) silhouette = std::make_unique<Silhouette<Real>>();
      set_silhouette(*silhouette, shell);
    }
    return *silhouette;
  }

  /// What that shell hides of one of its own edges. REQUIRES: silhouette_of(shell), usable, in this view.
  const typename Silhouette<Real>::Hidden& hidden_of(std::uint32_t shell, std::size_t edge) {
    Silhouette<Real>& silhouette = *silhouettes_[shell].second;
    auto& hidden = silhouette.hidden[edge];
    if (!hidden.is_known) {
      hidden.is_known = true;
      hidden.stretches.clear();
      const ViewFrame frame{view_.receiver().point, view_.receiver().normal, {}};
      hidden.is_all = layers_.find(silhouette.cone, silhouette.cone.sides[edge], silhouette, Tie::own_edge,
                                   {frame, view_.counts(), kFinestPerAngle}, hidden.stretches);
    }
    return hidden;
  }

  /// A facet's cone with the sides below the horizon.
  void set_whole(Cone<Real>& cone, std::uint32_t facet) {
    const auto loop = soup_.corners(soup_.facets()[facet]);
    loop_.clear();
    for (const Corner& c : loop) loop_.push_back(&c.at);
    set(cone, loop_, -view_.facing(facet));
    find_horizon(cone.corners);
    for (std::size_t k = 0; k < loop.size(); ++k) cone.sides[k].across = loop[k].neighbour;
  }

  /// Whether some corner is above the horizon.
  static bool reaches_above(const Cone<Real>& cone) {
    for (std::size_t b = 0; b < cone.corners.block_count(); ++b) {
      if ((positive_bytes(cone.corners.block(b).horizon) & cone.corners.present(b)) != 0) return true;
    }
    return false;
  }

  /// Of corners that run counter-clockwise seen from the front: seen from there, det(c − x, d − x, v − x) is negative
  /// inside, so that sign is −1 where x is in front.
  void set(Cone<Real>& cone, PointLoop loop, int sign, const Drop* drop = nullptr) {
    set_cone(cone, view_.receiver().point, loop, sign, drop);
  }

 private:
  Cone<Real>& cached(std::uint32_t item, bool& is_new) {
    if (slots_.empty()) slots_.resize(soup_.facets().size() + soup_.shells().size());
    if (epoch_ != view_.epoch()) {
      epoch_ = view_.epoch();
      used_ = 0;
    }
    Slot& slot = slots_[item];
    is_new = slot.epoch != epoch_;
    if (is_new) {
      slot = {epoch_, used_++};
      if (cones_.size() < used_) cones_.push_back(std::make_unique<Cone<Real>>());
    }
    return *cones_[slot.cone];
  }

  /// Edges between faces that are seen from the front and others, which lie to their right.
  void find_ring(std::uint32_t shell) {
    ring_.clear();
    view_.look_at(soup_.shells()[shell]);
    for (const ShellEdge& edge : soup_.shells()[shell].edges) {
      const bool left = view_.side(edge.left) > 0, right = view_.side(edge.right) > 0;
      if (left != right) ring_.push_back(left ? std::pair(edge.from, edge.to) : std::pair(edge.to, edge.from));
    }
  }

  void set_silhouette(Silhouette<Real>& silhouette, std::uint32_t shell) {
    find_ring(shell);
    std::ranges::sort(ring_);
    loop_.clear();
    next_.clear();
    for (const auto& [from, to] : ring_) {
      loop_.push_back(&soup_.vertices()[from]);
      const auto next = std::ranges::lower_bound(ring_, std::pair(to, 0u));  // the edges form closed rings
      next_.push_back(static_cast<std::uint32_t>(next - ring_.begin()));
    }
    set_cone<Real>(silhouette.cone, view_.receiver().point, loop_, -1, nullptr, next_);
    const Shell& s = soup_.shells()[shell];
    silhouette.is_usable = view_.surely_above(s.box) ||
                           std::ranges::all_of(s.vertices, [&](std::uint32_t v) { return view_.horizon(v) > 0; });
    if (!silhouette.is_usable) return;
    const ViewFrame frame{view_.receiver().point, view_.receiver().normal, {}};
    silhouette.is_usable = !has_edges_that_coincide<Real>(silhouette, {frame, view_.counts(), kFinestPerAngle});
    silhouette.hidden.resize(silhouette.cone.sides.size());
    for (auto& hidden : silhouette.hidden) hidden.is_known = false;
  }

  void set_silhouette(Cone<Real>& cone, std::uint32_t shell) {
    find_ring(shell);
    // The edges form one ring: each in turn gets behind it the one that starts where it ends.
    for (std::size_t k = 0; k + 1 < ring_.size(); ++k) {
      const auto next = std::find_if(ring_.begin() + static_cast<std::ptrdiff_t>(k) + 1, ring_.end(),
                                     [&](const auto& e) { return e.first == ring_[k].second; });
      if (next != ring_.end()) std::swap(ring_[k + 1], *next);
    }
    loop_.clear();
    for (const auto& edge : ring_) loop_.push_back(&soup_.vertices()[edge.first]);
    set(cone, loop_, -1);
    find_horizon(cone.corners);
    drop_below_horizon(cone);
  }

  /// n · w: w is wrong by u of each component, each product and two sums are rounded, and the terms' sizes sum to at
  /// most |n||w|.
  void find_horizon(Corners<Real>& corners) {
    const Vec3 n = view_.receiver().normal;
    const double per_length = 5 * kRoundoff * norm(n);
    for (std::size_t b = 0; b < corners.block_count(); ++b) {
      auto& block = corners.block(b);
      if constexpr (std::is_same_v<Real, double>) {
        const Doubles value = n.x * load(block.x.data()) + n.y * load(block.y.data()) + n.z * load(block.z.data());
        block.horizon = certain_signs(value, per_length * load(block.length.data()));
      } else {
        block.horizon = 0;
      }
      for_each_byte(zero_bytes(block.horizon) & corners.present(b), [&](std::size_t k) {
        const Vec3& v = *corners.exact(b * kLanes + k).a;
        set_sign_byte(block.horizon, k, horizon_side(view_.receiver().point, n, v, view_.counts()));
      });
    }
  }

  static void drop_below_horizon(Cone<Real>& cone) {
    const auto horizon = [&](std::size_t k) { return sign_byte(cone.corners.block(k / kLanes).horizon, k % kLanes); };
    std::erase_if(cone.sides,
                  [&](const ConeSide<Real>& side) { return horizon(side.from) <= 0 && horizon(side.to) <= 0; });
  }

  struct Slot {
    std::uint32_t epoch = 0, cone = 0;
  };

  View& view_;
  const PolygonSoup& soup_;
  LargeArray<Slot> slots_;  // by facet, then by shell
  std::vector<std::unique_ptr<Cone<Real>>> cones_;
  std::uint32_t epoch_ = 0, used_ = 0;
  std::vector<const Vec3*> loop_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> ring_;
  std::vector<std::uint32_t> next_;
  std::vector<std::pair<std::uint32_t, std::unique_ptr<Silhouette<Real>>>> silhouettes_;  // by shell, with their epochs
  LayersOverEdge<Real> layers_;
};

}  // namespace exitance
