#pragma once
// What two polygons exchange past others, by integrating over one of them what its points see of the other.

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "geometry/viewpoint.h"
#include "src/form_factor/edge_event.h"
#include "src/form_factor/form_factor_bound.h"
#include "src/form_factor/rounded_contact.h"
#include "src/form_factor/rule_decay.h"
#include "src/form_factor/visual_events.h"

namespace exitance {

/// ∫ F(x → visible part of the source) dA over the receiver, refined on demand. The integrand is analytic but for
/// visual events, so that cells are cut along the straight ones that are known first. Then points of a cell are
/// compared by the outlines of what they see: where those differ an event lies between, which is found by halving the
/// way, and the cell is cut along it, if need be along the conic of three edges. A cell whose points and corners agree
/// is integrated by a product Gauss rule, whose order rises, and which is halved where that does not help: beside
/// shared edges and contacts. Where events are still uncut, a share of what could be seen at most is part of the error,
/// because no rule notices what happens between its points. Deterministic.
class ObstructedExchange {
 public:
  /// Receiver and source: pieces of two facets. items: what may stand between, of the soup's index, ascending.
  ObstructedExchange(const PolygonSoup& soup, const Source& receiver, const Source& source,
                     std::span<const std::uint32_t> items);

  /// Refines until error() ≤ tolerance [m²] or `points` points have been looked from in all; one that needs extended
  /// precision counts for several; or until `stop`, asked before each cell, says so.
  void refine(Viewpoint& view, double tolerance, std::uint64_t points, const std::function<bool()>& stop = {});

  double integral() const;  ///< [m²]
  double error() const;     ///< [m²] estimate of |integral − true| that is meant to hold
  std::uint64_t points() const { return points_; }
  std::size_t events() const { return events_.size(); }

 private:
  struct Cell {
    AreaCell shape;
    double most = 1;  ///< bound of what its points see
    int order = 0;    ///< of the rule that measured it; 0: none did
    double fall = 1;
    double slowest = 0;                ///< fall that its first rule is believed to have at least
    std::vector<std::uint32_t> uncut;  ///< events that concern it
    bool mixed = false;                ///< its points see different outlines
    bool looked = false;               ///< for events that happen between its points and its sides
    std::vector<std::uint32_t> found;  ///< such events
    double integral = 0, error = 0, point_error = 0;
    RuleDecay decay;  ///< of the rules that measured it
  };

  /// Where a point of a cell lies, its form factor, and the outline of what it sees.
  struct Sighting {
    Vec3 point;
    double F = 0;
    std::uint64_t outline = 0;
  };

  bool is_over() const { return points_ >= most_points_ || (*stop_ && (*stop_)()); }
  Cell unmeasured(const AreaCell& shape) const;
  PointFormFactor look(Viewpoint& view, const Vec3& from, double tolerance);
  std::uint64_t outline_of(const Viewpoint& view) const;
  Sighting sight(Viewpoint& view, const Vec3& from);
  void sight_corners(Viewpoint& view, const AreaCell& shape, std::vector<Sighting>& sightings);
  bool find_hidden_events(Viewpoint& view, Cell& cell, std::uint64_t outline, const Vec3& from);
  double side_of_event(std::uint32_t e, const Vec3& x) const;
  std::vector<AreaCell> cut_along(std::uint32_t e, const AreaCell& shape) const;
  std::vector<std::uint32_t> events_in(Viewpoint& view, const Cell& cell);
  std::optional<std::uint32_t> find_event(Viewpoint& view, Sighting here, Sighting there);
  std::vector<AreaCell> separate(Viewpoint& view, const Cell& cell);
  void measure(Viewpoint& view, Cell& cell, int order, double tolerance);
  std::vector<Cell> parts_of(Viewpoint* view, const Cell& cell);
  void find_contacts();
  void add_about_contacts(const AreaCell& shape, std::vector<AreaCell>& shapes) const;
  void cut_all();

  const PolygonSoup* soup_;
  Source receiver_, source_;
  std::span<const std::uint32_t> items_;
  FormFactorBound bound_;
  double area_ = 0;
  RoundedContact contact_;
  std::vector<VisualEvent> events_;
  std::vector<SeenEdge> edges_;                            ///< of the source and of what stands between
  std::unordered_map<std::uint64_t, std::uint64_t> same_;  ///< outlines that stand for others
  std::vector<EdgeEvent> found_;                           ///< events that points of a cell saw on different sides of
  std::vector<Vec3> contacts_;  ///< corners of the source and of occluders in the receiver's plane
  std::vector<Cell> cells_;
  std::vector<std::uint32_t> heap_;  ///< indices of cells, worst on top
  bool started_ = false;
  double running_error_ = 0;
  std::uint64_t points_ = 0, most_points_ = 0;
  const std::function<bool()>* stop_ = nullptr;  ///< while it refines
  std::vector<WeightedPoint> scratch_;
  std::vector<double> weighted_;
  std::vector<Sighting> sightings_;
};

}  // namespace exitance
