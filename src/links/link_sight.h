#pragma once
// What stands between the two nodes of a link, and what the one sees of the other.

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "geometry/shaft.h"
#include "geometry/viewpoint.h"
#include "src/links/patch_tree.h"
#include "src/scene/facet_range.h"
#include "src/visibility/contacts.h"

namespace exitance {

/// The obstacles of a scene as it is at one time, and whose they are.
class Obstacles {
 public:
  explicit Obstacles(const EditedScene& scene);
  /// After an edit of the geometry of one object: takes time by what that changes, where the soup can share with the
  /// one before (scene_soup.h). Of several objects that changed at once, one after the other. All facets but the
  /// object's stand in the same order as before, so that what is seen past them adds up to the same bits.
  Obstacles(const Obstacles& before, const EditedScene& scene, std::uint32_t object);
  Obstacles(const Obstacles&) = delete;  // contacts refer to the soup
  Obstacles& operator=(const Obstacles&) = delete;

  const PolygonSoup& soup() const { return soup_; }
  const Contacts& contacts() const { return contacts_; }
  /// Items (of the soup's index) of which some is an object's, ascending: a facet of no convex shell, or such a shell,
  /// which several objects may close together.
  std::vector<std::uint32_t> items_of(std::uint32_t object) const;
  std::size_t objects() const { return facets_.size(); }
  FacetRange facets_of(std::uint32_t object) const { return facets_[object]; }
  /// By object: its facets, and its polygons in the soup.
  std::span<const FacetRange> facets() const { return facets_; }
  std::span<const PolygonSoup::PolygonRange> polygons() const { return polygons_; }

 private:
  void place(const EditedScene& scene, std::span<const std::uint32_t> order);

  PolygonSoup soup_;
  Contacts contacts_;
  std::vector<PolygonSoup::PolygonRange> polygons_;  ///< by object
  std::vector<FacetRange> facets_;                   ///< by object
};

/// What enters the shaft of a link, as far as it was asked about.
struct Sight {
  enum class State : std::uint8_t {
    open,     ///< nothing
    partial,  ///< the items
    blocked   ///< something that alone blocks the shaft of the link or of one that it descends from
  };
  State state = State::open;
  std::size_t first = 0, count = 0;  ///< items, in the LinkSight's memory
};

/// What was done, and what it took.
struct SightWork {
  std::uint64_t shaft_tests = 0;       ///< links whose shaft was made
  std::uint64_t visibility_tests = 0;  ///< points from which it was looked past items
  std::uint64_t form_factors = 0;      ///< points from which an unobstructed form factor was computed
  double seconds_shafts = 0, seconds_visibility = 0, seconds_form_factors = 0;  ///< summed over threads

  SightWork& operator+=(const SightWork& other);
};

/// Answers for one thread; holds scratch memory.
///
/// The shaft of a link lies within that of the link it descends from. So what enters it is sought among what enters
/// there, from whole patches downwards; below an open link everything is open, and below a blocked one blocked. What
/// rounding of the corners of sub-patches could change in this is defined away, and all answers depend on the two
/// nodes and the scene only, whatever was asked before.
class LinkSight {
 public:
  /// per_edge: squared, the points from which a node looks (node_points). The obstacles may be those before an edit
  /// that the tree has followed: then only shafts among some items can be asked for, of nodes that did not change.
  LinkSight(const PatchTree& tree, const Obstacles& obstacles, unsigned per_edge);

  /// Of whole patches, among all items or among some; then of links that descend from them. The memory of items is a
  /// stack: forget them in the opposite order.
  Sight between_roots(std::uint32_t receiver, std::uint32_t source);
  Sight between_roots(std::uint32_t receiver, std::uint32_t source, std::span<const std::uint32_t> items);
  Sight between(std::uint32_t receiver, std::uint32_t source, const Sight& parent);
  /// The same answers, but nothing is inherited: the link's own shaft is sought in the index of the scene, or among
  /// `items`. What rounding lets enter a descendant's shaft but not that of the link above it does not count here,
  /// either.
  Sight between_alone(std::uint32_t receiver, std::uint32_t source, const Sight& parent);
  Sight between_alone(std::uint32_t receiver, std::uint32_t source, const Sight& parent,
                      std::span<const std::uint32_t> items);
  /// Whether any of `some`, ascending, enters the shaft of a link, given what enters that of the link above.
  bool touched(std::uint32_t receiver, std::uint32_t source, const Sight& parent, std::span<const std::uint32_t> some);
  /// The same, given nothing of the link above.
  bool touched(std::uint32_t receiver, std::uint32_t source, std::span<const std::uint32_t> some);
  /// That of a link whose shaft nothing is known to enter.
  Sight open() const { return {Sight::State::open, items_.size(), 0}; }
  void forget(const Sight& sight) { items_.resize(sight.first); }
  std::span<const std::uint32_t> items(const Sight& sight) const { return {items_.data() + sight.first, sight.count}; }

  /// Mean over the receiver's points of the form factor to the source as if nothing stood between. Points are those
  /// that nothing covers (PatchTree::open_points): what is covered sees nothing and does not count. 0 where all is.
  double form_factor(std::uint32_t receiver, std::uint32_t source);
  /// The same to what is seen of it. REQUIRES: sight is theirs, among all items.
  double visible_form_factor(std::uint32_t receiver, std::uint32_t source, const Sight& sight);

  const SightWork& work() const { return work_; }

 private:
  void set_shaft(std::uint32_t receiver, std::uint32_t source);
  Sight select(std::span<const std::uint32_t> items);
  void keep_inherited(Sight& sight, const Sight& parent);

  const PatchTree& tree_;
  const Obstacles& obstacles_;
  unsigned per_edge_;
  std::vector<std::uint32_t> facet_offset_;  ///< by object: from the tree's numbers to the obstacles', modulo 2^32
  Shaft shaft_;
  std::pair<std::uint32_t, std::uint32_t> shaft_of_{kNone, kNone};  ///< the nodes whose it is
  Viewpoint view_;
  std::vector<std::uint32_t> items_, found_, chosen_;
  std::vector<NodePoint> points_;
  SightWork work_;
};

}  // namespace exitance
