#pragma once
// What stands in the shaft between two convex polygons, by another route than the kernel's: everything is constructed
// with rational coordinates: the planes of the hull of both, and what of each facet they leave.

#include <cstdint>
#include <vector>

#include "geometry/shaft.h"
#include "src/stress/exact_polygon.h"
#include "src/stress/placement.h"

namespace exitance {

/// Whether the relative interior of a convex loop meets the open intersection of half-spaces.
bool meets_open(const ExactLoop& loop, const std::vector<ExactSide>& sides);

/// One end of a shaft.
struct ExactEnd {
  std::uint32_t facet = 0;
  ExactLoop points;
  ExactSide plane;
};

/// All planes through three points of both that have the others on one side, and the planes of both.
std::vector<ExactSide> sides_of_hull(const ExactEnd& a, const ExactEnd& b);

/// A facet, or a convex shell.
struct ExactItem {
  std::vector<ExactLoop> loops;  ///< one, or the shell's
  std::vector<ExactSide> planes;
  bool solid = false;
};

/// How many lines there were, and how many of them cross something strictly between.
struct Lines {
  int seen = 0, blocked = 0;
};

/// Looks along lines between interior points of the ends, of what each sees of the other.
Lines look_along_lines(const ExactEnd& a, const ExactEnd& b, const ExactItem& item, int count, Random& random);

/// Whether a plane of a shell's face, or of an end, separates the shell from one of the ends: else Shaft may call
/// partial what is blocking.
bool plainly_separated(const ExactEnd& a, const ExactEnd& b, const ExactItem& shell);

/// Whether the interior of a convex shell holds a point of a convex loop.
bool reaches_into(const ExactLoop& loop, const ExactItem& shell);

/// What a soup's index should hold, ascending: facets that occlude and are of no convex shell, and such shells.
std::vector<std::uint32_t> items_of(const PolygonSoup& soup);

/// Of the facets of one soup, which must outlive it. Not for several threads at once.
class ShaftOracle {
 public:
  explicit ShaftOracle(const PolygonSoup& soup);

  ExactEnd end(const ShaftEnd& given) const;
  const ExactLoop& loop(std::uint32_t facet) const { return loops_[facet]; }
  const ExactSide& plane(std::uint32_t facet) const { return planes_[facet]; }
  ExactItem item(std::uint32_t index) const;
  std::vector<std::uint32_t> facets_of(std::uint32_t item) const;

  bool face_each_other(const ExactEnd& a, const ExactEnd& b) const;

  /// How an item of the index, or a facet of a shell by itself, stands to the shaft of two ends that face each other.
  /// `sides` of the ends' hull.
  Shaft::Overlap overlap(const ExactEnd& a, const ExactEnd& b, const std::vector<ExactSide>& sides,
                         std::uint32_t index) const;

  /// Whether a facet lies in the plane of another: exactly; of the same polygon where the soup says so, which lets
  /// rounding pass.
  bool in_one_plane(std::uint32_t t, std::uint32_t f) const;
  /// Whether a facet in the plane of another covers its front where they overlap (Role).
  bool covers(std::uint32_t t, std::uint32_t f) const;
  /// Whether an item of the index, or a facet of it, does.
  bool touches_plane(std::uint32_t index, std::uint32_t f) const;

 private:
  const PolygonSoup& soup_;
  std::vector<ExactLoop> loops_;
  std::vector<ExactSide> planes_;
};

}  // namespace exitance
