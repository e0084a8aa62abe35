#pragma once
// A receiver's view: on which side of it, and which side of, things are, exactly; each sign is found once a view.

#include <cstdint>
#include <vector>

#include "geometry/huge_pages.h"
#include "geometry/polygon_soup.h"

namespace exitance {

/// A point that receives, with the normal of its surface (any length but zero). A point of a facet lies on it by
/// identity, not by sign: it names the facet, and then neither that facet nor what lies in its plane hides anything
/// from it.
struct Receiver {
  Vec3 point;
  Vec3 normal;
  std::uint32_t facet = kNone;
};

class View {
 public:
  explicit View(const PolygonSoup& soup);

  /// Moves to another receiver; forgets all signs. Its numbers must be finite, the normal not zero.
  void look_from(const Receiver& receiver);

  const PolygonSoup& soup() const { return soup_; }
  const Receiver& receiver() const { return receiver_; }
  StageCounts& counts() { return counts_; }

  /// Counts the views, so that what was computed for one can be told from what belongs to another.
  std::uint32_t epoch() const { return epoch_; }

  /// Whether a facet is the receiver's own or lies in its plane: it can't be seen and hides nothing.
  bool excluded(std::uint32_t facet) const;

  /// The side from which an occluding facet is seen: +1 front, −1 back, 0 when it hides nothing from here that others
  /// do not hide: excluded, edge-on, or the back face of a shell that the point is outside of.
  int facing(std::uint32_t facet) { return seen(facet).facing; }

  /// The side of a facet's plane on which the point lies as it is rounded, whether the facet hides something or not.
  int side(std::uint32_t facet) { return seen(facet).side; }

  /// Asks for the memory that the side of a facet is found from before it is needed (PolygonSoup::prefetch).
  void prefetch(std::uint32_t facet) const {
    const Facet& f = soup_.facets()[facet];
    __builtin_prefetch(&facets_[facet]);
    __builtin_prefetch(&f);
    __builtin_prefetch(&f.plane.normal_error);
  }

  /// Looks at all facets of a shell at once: soon done for those that lie clear of the point.
  void look_at(const Shell& shell);

  /// Side of a vertex against the receiver's horizon: +1 above.
  int horizon(std::uint32_t vertex);

  /// Whether a box surely lies above the horizon.
  bool surely_above(const Box& box) const { return least_height(box, receiver_.normal, receiver_.point, 0) > 0; }

  /// Whether the point is outside of the shell's box, grown because a point that lies in a contact by identity may be
  /// rounded out of it.
  bool outside(const Shell& shell) const { return !shell.box.contains(receiver_.point, 0x1p-40 * soup_.extent()); }

  /// Whether something that lies in the receiver's plane covers it.
  bool covered() const { return covered_; }

 private:
  struct SeenFacet {
    std::uint32_t epoch = 0;
    std::int8_t facing = 0, side = 0;
  };
  struct SeenVertex {
    std::uint32_t epoch = 0;
    std::int8_t sign = 0;
  };

  const SeenFacet& seen(std::uint32_t facet);
  void set(SeenFacet& seen, std::uint32_t facet, int side, bool outside_shell);
  bool holds_receiver(std::uint32_t facet);

  const PolygonSoup& soup_;
  Receiver receiver_;
  StageCounts counts_;
  std::span<const std::uint32_t> coplanar_;  // with the receiver's facet
  std::uint32_t epoch_ = 0;
  bool covered_ = false;
  LargeArray<SeenFacet> facets_;
  LargeArray<SeenVertex> vertices_;
};

}  // namespace exitance
