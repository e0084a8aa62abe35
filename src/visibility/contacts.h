#pragma once
// What lies on the facets of a scene and hides their points from whatever looks at them, however it looks.

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/paged.h"
#include "geometry/polygon_soup.h"

namespace exitance {

/// Whether a point of a facet's plane, or nearly of it, lies within the facet or on its edge; decided in double
/// precision.
bool lies_within(const PolygonSoup& soup, std::uint32_t facet, const Vec3& point);

/// Rays start and end a little off their surfaces, and so beyond what lies on them: from within a solid that stands on
/// the floor, say, to within the same. They are told what lies where; exact visibility is told only what does so up to
/// rounding, as it knows the rest. Any number of threads may ask at once.
class Contacts {
 public:
  /// Keeps a reference to the soup.
  explicit Contacts(const PolygonSoup& soup);

  /// Of a soup that an edit made from that of `before`: takes time by what changed.
  Contacts(const Contacts& before, const PolygonSoup& soup);

  /// Whether something that faces the facet, and does not count as in its plane (PolygonSoup::coplanar), lies against it
  /// at this point of it: within 2^-49 of the scene's extent, as turned solids do where their contacts are narrow. The
  /// corners of patches are rounded to some 2^-52 of it; seen from so near, patches would leave gaps and overlap. On an
  /// edge of what lies there: yes.
  bool touched(std::uint32_t facet, const Vec3& point) const;

  /// Whether anything lies on the facet at this point of it, computed with some roundings; on its edges, too.
  bool covered(std::uint32_t facet, const Vec3& point) const { return buried(facet, point) || overlaid(facet, point); }
  /// Whether something does with open space before it: a later surface that faces the same way, or a sheet.
  bool overlaid(std::uint32_t facet, const Vec3& point) const;
  bool may_be_overlaid(std::uint32_t facet) const { return !lying_on_[facet].overlying.empty(); }
  bool may_be_covered(std::uint32_t facet) const { return may_be_overlaid(facet) || burying_count(facet) > 0; }
  /// The facets that cover some of it by lying in its plane (PolygonSoup::coplanar) or, against it, nearly, in no
  /// particular order.
  std::vector<std::uint32_t> covering(std::uint32_t facet) const;

  /// The contacts of two facets, between points of which nothing else stands.
  class Pair {
   public:
    Pair() = default;
    bool exist() const { return overlying_ || burying_; }
    /// Whether one of the points (or both) is covered. Two that lie in solids lie in the same, or something would stand
    /// between: the facet with fewer contacts is asked.
    bool cover(const Vec3& point_i, const Vec3& point_j) const;

   private:
    friend class Contacts;
    const Contacts* contacts_ = nullptr;
    std::uint32_t i_ = 0, j_ = 0;
    bool overlying_ = false, burying_ = false;
  };
  Pair pair(std::uint32_t i, std::uint32_t j) const;

 private:
  bool buried(std::uint32_t facet, const Vec3& point) const;
  std::size_t burying_count(std::uint32_t facet) const {
    return lying_on_[facet].burying.size() + lying_on_[facet].touching.size();
  }
  bool any_at(std::span<const std::uint32_t> facets, const Vec3& point, double near) const;
  bool are_sides_of_a_sheet(std::uint32_t p, std::uint32_t q) const;  ///< polygons
  bool reaches(std::uint32_t facet, const Plane& plane) const;
  bool lies_in(std::uint32_t facet, const Plane& plane) const;

  /// The facets that lie on one: against it up to rounding; of what counts as in its plane, solids, and others.
  struct LyingOn {
    std::vector<std::uint32_t> touching, burying, overlying;

    bool empty() const { return touching.empty() && burying.empty() && overlying.empty(); }
  };
  LyingOn find_lying_on(std::uint32_t facet) const;

  const PolygonSoup* soup_;
  double near_;  ///< [m]
  Paged<LyingOn> lying_on_;
};

}  // namespace exitance
