#pragma once
// Ways to answer what a point sees of a polygon, behind one interface.

#include <cstdint>
#include <functional>
#include <string>

#include "src/form_factor/point_question.h"

namespace exitance {

/// What a way says of one question.
struct Opinion {
  double F = 0;
  double margin = 0;  ///< by how much F may differ from the truth: the proven bound; of rays, what their number allows
  /// How much of the source is seen; `partial` commits to nothing.
  Visibility visibility = Visibility::partial;
  StageCounts stages;          ///< how its predicates were decided, if it counts them
  std::uint64_t extended = 0;  ///< facets that took more than double precision
};

struct PointContender {
  std::string name;
  /// The same question and seed give the same opinion. Any number of threads may ask.
  std::function<Opinion(const PointQuestion& question, std::uint64_t seed)> ask;
  /// Whether the margin is proven: then it must be small, too.
  bool is_proven = false;
  /// Whether properties are asked of it: not of rays, whose answers to two forms of one question differ by chance, and
  /// not of the oracle, which is slow.
  bool has_properties = false;
};

/// What plain doubles may err by before it counts as wrong: far above what rounding costs them where they decide
/// rightly, far below what a wrong decision does.
inline constexpr double kPlainMargin = 1e-9;

/// By name: "exact" (what `answer` says, with more digits where the relative error would exceed 1e-10 at F ≥ 1e-15),
/// "plain-double", "rays:N", "rays:N:fast" (Embree without its robust mode) or "cgal-epeck". Throws
/// std::invalid_argument on other names.
PointContender point_contender_named(const std::string& name);

}  // namespace exitance
