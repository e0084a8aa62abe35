#pragma once
// An intersection of open half-spaces whose planes go through input points, and what of it a facet meets, exactly.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "geometry/lanes.h"
#include "geometry/polygon_soup.h"
#include "geometry/predicates.h"

namespace exitance {

class OpenRegion {
 public:
  /// All of space. No point that is added or asked about may be farther from the origin, in the sum of the coordinates'
  /// absolute differences, than `reach`.
  void clear(const Vec3& origin, double reach);

  /// Adds what lies in front of a plane (sign 1), or behind it (−1).
  void add(const Plane& plane, int sign);

  /// Adds what lies in front of the plane through three points, which must live as long as the region. Points that are
  /// exactly collinear leave nothing of the region.
  void add(const Vec3& a, const Vec3& b, const Vec3& c);

  void remove_last();

  /// Sign of v against plane i, exact: +1 inside.
  int side(std::size_t i, const Vec3& v, StageCounts& counts) const {
    const int quick = certain_side(i, v, counts);
    return quick != 0 ? quick : exact_side(i, v, counts);
  }

  /// The same, 0 where doubles do not tell.
  int certain_side(std::size_t i, const Vec3& v, StageCounts& counts) const;

  /// The same, to be asked where doubles do not tell.
  int exact_side(std::size_t i, const Vec3& v, StageCounts& counts) const;

  /// Plane i as a half-space of an index whose coordinates are at most `extent`.
  HalfSpace half_space(std::size_t i, double extent) const;

  std::size_t count() const { return count_; }

  /// Whether the relative interior of a facet meets the region, when signs of its corners against the planes tell:
  /// a corner inside, or a plane that leaves all corners outside or on it. These are exact. Sets what `meets` needs.
  std::optional<bool> meets_at_sight(std::span<const Corner> facet, StageCounts& counts);

  /// The same where they don't tell, for the facet asked about last, which lies in the plane through three points.
  bool meets(std::span<const Corner> facet, const PlanePoints& plane, StageCounts& counts);

 private:
  struct Side {
    PlanePoints points;
    int sign = 1;
    int axis = -1;  ///< 0, 1, 2: exactly perpendicular to that axis
    int axis_sign = 0;
  };
  struct alignas(64) Block {
    double x[kLanes], y[kLanes], z[kLanes], offset[kLanes], error[kLanes];
  };

  void put(std::size_t i, const Vec3& normal, double offset, double error);
  void append(const Side& side, const Vec3& normal, double normal_error);
  bool clip_leaves_some(std::size_t corners, double slack);
  bool clip_leaves_some_exactly(std::span<const Corner> facet, const PlanePoints& plane) const;

  Vec3 origin_;
  double reach_ = 0;
  std::size_t count_ = 0;
  std::vector<Side> sides_;
  std::vector<Block> blocks_;  ///< normal · (v − origin) − offset, positive inside; unused lanes are positive

  // Of the facet asked about last.
  struct Signs {
    SignBytes some_inside = 0, all_inside = kOnes, all_outside = kOnes;
  };
  std::vector<Signs> signs_;            ///< [block]
  std::vector<double> values_;          ///< [corner][lane of all blocks]
  std::vector<std::uint32_t> cutting_;  ///< planes that some corner does not certainly lie inside of
  std::vector<double> rows_, next_;
};

}  // namespace exitance
