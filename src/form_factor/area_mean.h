#pragma once
// The mean over one polygon of the form factor from its points to another, by adaptive integration.

#include <cstdint>
#include <vector>

#include "geometry/viewpoint.h"
#include "src/form_factor/visual_events.h"

namespace exitance {

/// A soup with the points of view of one thread: `open` looks at the same facets with nothing in the way.
struct AreaViews {
  Viewpoint view, open;
};

/// ∫ F(x → visible part of the source) dA over the receiver, refined on demand. The integrand is smooth but for visual
/// events, so that cells are cut along those first and then halved; each carries the difference of two Gauss rules as
/// its error, and where events are still uncut a share of what could be seen at most, because no rule notices what
/// happens between its points. Deterministic.
class AreaMean {
 public:
  AreaMean(const PolygonSoup& soup, std::uint32_t receiver_polygon, std::uint32_t source_polygon);

  /// Refines until error() ≤ tolerance or `points` points have been looked from in all; one that needs extended
  /// precision counts for several.
  void refine(AreaViews& views, double tolerance, std::uint64_t points);

  bool sees_nothing() const { return cells_.empty(); }  ///< decided exactly
  double integral() const;                              ///< [m²]
  double error() const;                                 ///< [m²] estimate of |integral − true| that is meant to hold
  std::uint64_t points() const { return points_; }

 private:
  struct Cell {
    AreaCell shape;
    std::uint32_t facet = 0;
    std::uint32_t order = 4;
    std::vector<std::uint32_t> uncut;  ///< events of its facet that concern it
    double integral = 0, error = 0, point_error = 0;
  };

  void measure(AreaViews& views, Cell& cell, double tolerance);
  double rule(AreaViews& views, const Cell& cell, int order, double tolerance, double& point_error);
  std::vector<Cell> parts_of(const Cell& cell) const;

  const PolygonSoup* soup_;
  std::uint32_t source_;
  std::vector<std::vector<VisualEvent>> events_;  ///< of each facet of the receiver
  std::uint32_t first_facet_;
  std::vector<Cell> cells_;          ///< those that count
  std::vector<std::uint32_t> heap_;  ///< indices of cells, worst on top
  bool started_ = false;
  double running_error_ = 0;
  std::uint64_t points_ = 0;
  std::vector<WeightedPoint> scratch_;
};

}  // namespace exitance
