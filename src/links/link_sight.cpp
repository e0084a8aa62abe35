#include "src/links/link_sight.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>

#include "src/scene/scene_soup.h"
#include "src/visibility/convex_loop.h"
#include "src/visibility/exact_visibility.h"

namespace exitance {
namespace {

class Lap {
 public:
  explicit Lap(double& seconds) : seconds_(seconds) {}
  ~Lap() { seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }
  Lap(const Lap&) = delete;
  Lap& operator=(const Lap&) = delete;

 private:
  double& seconds_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Objects as their facets stand, but for one, which comes last.
std::vector<std::uint32_t> order_after(const Obstacles& before, const EditedScene& scene, std::uint32_t last) {
  std::vector<std::uint32_t> order = objects_of(scene);
  std::ranges::stable_sort(
      order, {}, [&](std::uint32_t object) { return std::pair(object == last, before.facets_of(object).first); });
  return order;
}

}  // namespace

Obstacles::Obstacles(const EditedScene& scene) : soup_(make_soup(scene, objects_of(scene))), contacts_(soup_) {
  place(scene, objects_of(scene));
}

Obstacles::Obstacles(const Obstacles& before, const EditedScene& scene, std::uint32_t object)
    : soup_(soup_after(before.soup_, before.polygons_[object], scene, object, order_after(before, scene, object))),
      contacts_(soup_.shares_with(before.soup_) ? Contacts(before.contacts_, soup_) : Contacts(soup_)),
      polygons_(before.polygons_),
      facets_(before.facets_) {
  if (soup_.shares_with(before.soup_)) {
    polygons_[object] = soup_.arrived();
    facets_[object] =
        facet_range(soup_, soup_.first_facet(polygons_[object].first), soup_.first_facet(polygons_[object].last));
  } else {
    place(scene, order_after(before, scene, object));
  }
}

/// Where objects are in a soup that was made in this order.
void Obstacles::place(const EditedScene& scene, std::span<const std::uint32_t> order) {
  polygons_.resize(order.size());
  facets_.resize(order.size());
  std::uint32_t first = 0;
  for (const std::uint32_t object : order) {
    const EditedScene::Range range = scene.surfaces_of(object);
    const std::uint32_t last = first + range.last - range.first;
    polygons_[object] = {first, last};
    facets_[object] = facet_range(soup_, soup_.first_facet(first), soup_.first_facet(last));
    first = last;
  }
}

std::vector<std::uint32_t> Obstacles::items_of(std::uint32_t object) const {
  const auto facets = static_cast<std::uint32_t>(soup_.facets().size());
  std::vector<std::uint32_t> items;
  for (std::uint32_t f = facets_[object].first; f < facets_[object].last; ++f) {
    const std::uint32_t shell = soup_.facets()[f].shell;
    items.push_back(shell != kNone && soup_.shells()[shell].convex ? facets + shell : f);
  }
  std::ranges::sort(items);
  items.erase(std::unique(items.begin(), items.end()), items.end());
  return items;
}

SightWork& SightWork::operator+=(const SightWork& other) {
  shaft_tests += other.shaft_tests;
  visibility_tests += other.visibility_tests;
  form_factors += other.form_factors;
  seconds_shafts += other.seconds_shafts;
  seconds_visibility += other.seconds_visibility;
  seconds_form_factors += other.seconds_form_factors;
  return *this;
}

LinkSight::LinkSight(const PatchTree& tree, const Obstacles& obstacles, unsigned per_edge)
    : tree_(tree), obstacles_(obstacles), per_edge_(per_edge), shaft_(obstacles.soup()), view_(obstacles.soup()) {
  for (std::uint32_t object = 0; object < obstacles.objects(); ++object)
    facet_offset_.push_back(obstacles.facets_of(object).first - tree.facet_first(object));
}

void LinkSight::set_shaft(std::uint32_t receiver, std::uint32_t source) {
  if (shaft_of_ == std::pair(receiver, source)) return;
  shaft_of_ = {receiver, source};
  ++work_.shaft_tests;
  ShaftEnd to = shaft_end(tree_.node(receiver)), from = shaft_end(tree_.node(source));
  to.facet += facet_offset_[tree_.object_of(receiver)];
  from.facet += facet_offset_[tree_.object_of(source)];
  shaft_.reset(to, from);
}

/// Of the items, what enters the shaft as it is set.
Sight LinkSight::select(std::span<const std::uint32_t> items) {
  Sight sight;
  sight.first = items_.size();
  chosen_.clear();
  for (const std::uint32_t item : items) {
    const Shaft::Overlap of_item = shaft_.overlap(item);
    if (of_item == Shaft::Overlap::outside) continue;
    chosen_.push_back(item);
    if (of_item == Shaft::Overlap::blocking) sight.state = Sight::State::blocked;
  }
  items_.insert(items_.end(), chosen_.begin(), chosen_.end());
  sight.count = chosen_.size();
  if (sight.count > 0 && sight.state == Sight::State::open) sight.state = Sight::State::partial;
  return sight;
}

Sight LinkSight::between_roots(std::uint32_t receiver, std::uint32_t source) {
  const Lap lap(work_.seconds_shafts);
  set_shaft(receiver, source);
  const Shaft::Overlap most = shaft_.find_occluders(found_);
  Sight sight;
  sight.first = items_.size();
  sight.count = found_.size();
  sight.state = most == Shaft::Overlap::outside    ? Sight::State::open
                : most == Shaft::Overlap::blocking ? Sight::State::blocked
                                                   : Sight::State::partial;
  items_.insert(items_.end(), found_.begin(), found_.end());
  return sight;
}

Sight LinkSight::between_roots(std::uint32_t receiver, std::uint32_t source, std::span<const std::uint32_t> items) {
  const Lap lap(work_.seconds_shafts);
  set_shaft(receiver, source);
  return select(items);
}

Sight LinkSight::between(std::uint32_t receiver, std::uint32_t source, const Sight& parent) {
  if (parent.state != Sight::State::partial) return {parent.state, items_.size(), 0};
  const Lap lap(work_.seconds_shafts);
  set_shaft(receiver, source);
  return select(items(parent));
}

bool LinkSight::touched(std::uint32_t receiver, std::uint32_t source, const Sight& parent,
                        std::span<const std::uint32_t> some) {
  if (parent.state != Sight::State::partial) return false;
  found_.clear();
  std::ranges::set_intersection(items(parent), some, std::back_inserter(found_));
  return touched(receiver, source, found_);
}

bool LinkSight::touched(std::uint32_t receiver, std::uint32_t source, std::span<const std::uint32_t> some) {
  if (some.empty()) return false;
  const Lap lap(work_.seconds_shafts);
  set_shaft(receiver, source);
  return std::ranges::any_of(some, [&](std::uint32_t item) { return shaft_.overlap(item) != Shaft::Overlap::outside; });
}

/// Takes from the last sight what the one above it does not have.
void LinkSight::keep_inherited(Sight& sight, const Sight& parent) {
  if (parent.state != Sight::State::partial) {
    items_.resize(sight.first);
    sight = {parent.state, sight.first, 0};
    return;
  }
  const auto of_parent = items(parent);
  found_.clear();
  for (const std::uint32_t item : items(sight)) {
    if (std::ranges::binary_search(of_parent, item)) found_.push_back(item);
  }
  if (found_.size() == sight.count) return;
  items_.resize(sight.first);
  sight = select(found_);
}

Sight LinkSight::between_alone(std::uint32_t receiver, std::uint32_t source, const Sight& parent) {
  Sight sight = between_roots(receiver, source);
  keep_inherited(sight, parent);
  return sight;
}

Sight LinkSight::between_alone(std::uint32_t receiver, std::uint32_t source, const Sight& parent,
                               std::span<const std::uint32_t> items) {
  Sight sight = between_roots(receiver, source, items);
  keep_inherited(sight, parent);
  return sight;
}

double LinkSight::form_factor(std::uint32_t receiver, std::uint32_t source) {
  const Lap lap(work_.seconds_form_factors);
  tree_.open_points(receiver, per_edge_, points_);
  const Node &node = tree_.node(receiver), &of = tree_.node(source);
  const Vec3 normal = normalized(obstacles_.soup().facets()[node.facet].plane.normal);
  work_.form_factors += points_.size();
  double sum = 0;
  for (const NodePoint& p : points_) {
    ConvexLoop loop;
    for (const Vec3& v : of.loop()) loop.push_back(v - p.at);
    // Counter-clockwise seen from the front: the point sees that side where the sum is negative.
    sum += p.weight * std::max(0.0, -lambert(part_above(normal, loop), normal));
  }
  return sum;
}

double LinkSight::visible_form_factor(std::uint32_t receiver, std::uint32_t source, const Sight& sight) {
  if (sight.state == Sight::State::blocked) return 0;
  const Lap lap(work_.seconds_visibility);
  tree_.open_points(receiver, per_edge_, points_);
  const Node& node = tree_.node(receiver);
  const Vec3 normal = obstacles_.soup().facets()[node.facet].plane.normal;
  work_.visibility_tests += points_.size();
  double sum = 0;
  for (const NodePoint& p : points_) {
    view_.look_from({p.at, normal, node.facet});
    if (view_.covered() || obstacles_.contacts().touched(node.facet, p.at)) continue;
    const PointFormFactor f = view_.form_factor(source_of(tree_.node(source)), items(sight), kPointTolerance);
    if (f.side == Side::front) sum += p.weight * f.F;
  }
  return sum;
}

}  // namespace exitance
