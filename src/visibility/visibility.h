#pragma once
// What the sample points of a mesh's elements see of its patches: the same questions to exact visibility and to rays.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "geometry/viewpoint.h"
#include "src/scene/patch_mesh.h"
#include "src/visibility/pair_counts.h"

namespace exitance {

/// No form factor is off by more: all that rays prove.
inline constexpr double kBoundOfAny = 1;

struct PointRowStatistics {
  PairCounts pairs;
  StageCounts stages;          ///< of exact predicates
  std::uint64_t extended = 0;  ///< pairs that needed extended precision
  /// Points that see no front of anything: covered by, or buried in, a contact, which may hold but for rounding. They
  /// have no closure defect.
  std::uint64_t covered_points = 0;
  /// Largest |front + back − 1| of all points that see something, front and back sides of patches and of surfaces that
  /// only obstruct: the defect of a closed scene, without meaning in an open one. Shadow rays ask for fronts alone.
  double closure_max_defect = 0;
  std::uint64_t rays = 0;         ///< that were cast
  std::uint64_t sampled = 0;      ///< pairs that have a standard error
  double standard_error_sum = 0;  ///< of theirs

  PointRowStatistics& operator+=(const PointRowStatistics& other);
};

/// What one sample point sees: form factors to the fronts of patches, ascending.
struct PointRow {
  std::vector<std::uint32_t> column;
  std::vector<double> F;
  /// Bound of |F − true F|; kBoundOfAny by rays.
  std::vector<double> F_error;
  PointRowStatistics statistics;
};

/// Looks from one sample point after the other. Holds scratch memory: one object a thread.
class Observer {
 public:
  virtual ~Observer() = default;
  virtual PointRow row(std::size_t element) = 0;
  /// One entry of that row, the same bits; 0 where the row has none.
  virtual PointFormFactor entry(std::size_t element, std::size_t patch) = 0;
};

/// A way to decide visibility in one mesh. Any number of threads may have an observer, which it must outlive. What an
/// observer answers depends on the question only, not on those before.
class MeshVisibility {
 public:
  virtual ~MeshVisibility() = default;
  virtual const PatchMesh& mesh() const = 0;
  virtual std::unique_ptr<Observer> observer() const = 0;
};

}  // namespace exitance
