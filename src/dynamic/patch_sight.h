#pragma once
// What the sample points of one patch see of another: what stands between is looked for once for all of them.

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/shaft.h"
#include "geometry/viewpoint.h"
#include "src/scene/patch_mesh.h"
#include "src/visibility/contacts.h"

namespace exitance {

/// Form factors from the elements of a receiver patch to a shooter patch, exact (kPointTolerance). The shaft of both
/// tells first whether they face each other and what enters (Shaft): nothing, and each form factor is a closed form; or
/// what hides all; else only what enters is clipped away. Patches of one facet ask the shaft of the whole facet before
/// their own. What it answers depends on the question only, not on those before.
///
/// For one thread: holds scratch memory. All that it is made of must outlive it.
class PatchSight {
 public:
  PatchSight(const PatchMesh& mesh, const PolygonSoup& soup, const Contacts& contacts);

  /// Goes on with another pair of patches, both with pieces.
  void set(std::uint32_t receiver, std::uint32_t shooter);

  /// Whether some element may see something: not when the patches face away or one thing hides all.
  bool sees() const { return sees_; }

  /// Items of the soup's index that stand between some piece of the receiver and some of the shooter, in any order,
  /// some more than once.
  std::span<const std::uint32_t> between() const { return items_; }

  /// REQUIRES: element is one of the receiver's.
  PointFormFactor form_factor(std::uint32_t element);

 private:
  /// From what lies on one facet of the receiver to one piece of the shooter.
  struct Way {
    std::uint32_t facet, piece;
    bool hidden;              ///< nothing is seen
    std::size_t first, last;  ///< in items_
  };
  /// Of a whole facet and a piece of the shooter.
  struct FromFacet {
    std::uint32_t facet = kNone, piece = kNone;
    bool faces = false, blocked = false;
    std::vector<std::uint32_t> items;
  };

  const FromFacet& from_facet(std::uint32_t facet, std::uint32_t piece);
  std::span<const std::uint32_t> items_of(std::size_t way);
  bool find_between(const PatchPiece& from, std::uint32_t piece);

  const PatchMesh& mesh_;
  const PolygonSoup& soup_;
  const Contacts& contacts_;
  Viewpoint view_;
  Shaft shaft_;
  std::vector<FromFacet> facets_;  ///< by piece of the shooter
  std::uint32_t shooter_ = kNone;
  std::vector<Way> ways_;
  bool sees_ = false;
  std::vector<std::uint32_t> items_, found_;
};

}  // namespace exitance
