#pragma once
// Solids that stand on a polygon but for the rounding of their coordinates, as turned ones do.

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/polygon_soup.h"
#include "geometry/viewpoint.h"

namespace exitance {

/// Where a solid stands on a receiver or a source, rounding has left some of the contact a gap and put some of it into
/// the solid, from where points would see what else lies there: a source that pierces it. A contact is one whatever
/// its rounding: what lies in it, and what lies within the solid, sees nothing of the other polygon. Contacts that the
/// soup knows (coplanar) are none of these; Viewpoint sees to them.
class RoundedContact {
 public:
  /// Of closed solids among the items, of the soup's index, but for the one that the receiver bounds: its points are on
  /// that one's surface, neither within nor without. A face is in contact if it looks at the polygon and all its
  /// corners lie within 2^-47 of the scene's size of the polygon's plane.
  RoundedContact(const PolygonSoup& soup, const Source& receiver, const Source& source,
                 std::span<const std::uint32_t> items);

  /// Whether a point of the receiver lies in a contact, or in a solid that is in contact with the source. False for all
  /// points where there is no such solid. A point on a border may be either.
  bool buries(const Vec3& point) const;

  /// Faces in contact with the receiver, ascending.
  std::span<const std::uint32_t> faces() const { return faces_; }

 private:
  bool holds(const Shell& shell, const Vec3& point) const;

  const PolygonSoup* soup_;
  std::vector<std::uint32_t> faces_;
  std::vector<std::uint32_t> shells_;  ///< in contact with the source, and not with the receiver
};

}  // namespace exitance
