#include "src/links/root_shadows.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace exitance {

ChangedObjects::ChangedObjects(const Obstacles& obstacles, std::span<const std::uint8_t> moved) {
  for (std::uint32_t object = 0; object < moved.size(); ++object) {
    const FacetRange facets = obstacles.facets_of(object);
    if (moved[object] == 0 || facets.first == facets.last) continue;
    const std::vector<std::uint32_t> of_object = obstacles.items_of(object);
    items.insert(items.end(), of_object.begin(), of_object.end());
    casters.push_back(std::make_unique<ShadowCaster>(obstacles.soup(), facets.first, facets.last));
  }
  std::ranges::sort(items);
}

RootShadows::RootShadows(const LinkTask& task, const ChangedObjects& now, const ChangedObjects* before)
    : tree_(*task.tree) {
  std::vector<const ShadowCaster*> casters;
  for (const auto& caster : now.casters) casters.push_back(caster.get());
  const std::size_t of_now = casters.size();
  if (before != nullptr) {
    for (const auto& caster : before->casters) casters.push_back(caster.get());
  }
  count_ = casters.size();
  const std::size_t roots = tree_.roots().size();
  shadows_.resize(roots * count_);
  balls_.resize(roots);
  tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, static_cast<std::uint32_t>(roots)), [&](const auto& range) {
    for (std::size_t k = 0; k < count_; ++k) {
      ShadowVolume volume(*casters[k]);
      for (std::uint32_t r = range.begin(); r < range.end(); ++r) {
        const Root& root = tree_.root(r);
        if (!root.present || task.moved[root.object] != 0) continue;
        ShaftEnd shooter = shaft_end(tree_.node(root.node_first));
        const Obstacles& obstacles = k < of_now ? *task.now : *task.before;
        shooter.facet += obstacles.facets_of(root.object).first - tree_.facet_first(root.object);
        volume.set_shooter(shooter);
        Shadow& shadow = shadows_[r * count_ + k];
        shadow.covers = volume.covers_shooter();
        for (HalfSpace h : volume.region()) {
          const double per_length = 1 / norm(h.normal);
          shadow.region.push_back({per_length * h.normal, per_length * h.offset});
        }
      }
    }
    for (std::uint32_t r = range.begin(); r < range.end(); ++r)
      balls_[r] = ball_around(tree_.node(tree_.root(r).node_first));
  });
}

bool RootShadows::may_change(std::uint32_t a, std::uint32_t b) const {
  for (std::size_t k = 0; k < count_; ++k) {
    const Shadow &of_a = shadows_[a * count_ + k], &of_b = shadows_[b * count_ + k];
    if (of_a.covers || of_b.covers || (reaches(b, of_a.region) && reaches(a, of_b.region))) return true;
  }
  return false;
}

bool RootShadows::reaches(std::uint32_t r, const std::vector<HalfSpace>& region) const {
  const Ball& ball = balls_[r];
  const auto beyond = [&](const HalfSpace& h) {
    const double height = dot(h.normal, ball.centre) - h.offset;
    if (height >= 0) return false;
    const double rounding = 1e-12 * (std::fabs(h.offset) + norm(ball.centre) + ball.radius);
    return height < -ball.radius - rounding ||
           std::ranges::all_of(tree_.node(tree_.root(r).node_first).loop(),
                               [&](const Vec3& v) { return dot(h.normal, v) < h.offset - rounding; });
  };
  return std::ranges::none_of(region, beyond);
}

}  // namespace exitance
