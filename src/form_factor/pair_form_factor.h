#pragma once
// Form factors between patches: F_ij is the mean over i of the form factor from its points to what they see of j.

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "geometry/radiator.h"
#include "geometry/shaft.h"
#include "geometry/viewpoint.h"
#include "src/scene/patch_mesh.h"

namespace exitance {

/// Patches that exchange, each as convex pieces of facets of a soup, which must outlive it.
class ExchangeScene {
 public:
  /// Patch k is polygon k of the soup, whole. Polygons that are no patches, or have no area, exchange nothing.
  explicit ExchangeScene(const PolygonSoup& soup);
  /// The patches of a mesh, or its elements, which must be of the soup's scene and outlive this, too.
  enum class Unit : std::uint8_t { patch, element };
  ExchangeScene(const PolygonSoup& soup, const PatchMesh& mesh, Unit unit = Unit::patch);

  const PolygonSoup& soup() const { return *soup_; }
  std::size_t size() const { return area_.size(); }
  double area(std::size_t patch) const { return area_[patch]; }  ///< [m²]

  struct Piece {
    Source source;
    Radiator radiator;
  };
  std::span<const Piece> pieces(std::size_t patch) const {
    return {pieces_.data() + first_[patch], pieces_.data() + first_[patch + 1]};
  }

 private:
  void add(const Source& source);
  void end_patch();

  const PolygonSoup* soup_;
  std::vector<Piece> pieces_;
  std::vector<std::size_t> first_{0};
  std::vector<double> area_;
};

enum class PairClass : std::uint8_t { facing_away, open, blocked, partial };

struct PairOptions {
  double tolerance = 1e-12;        ///< of the form factors' errors, in both directions
  double relative = 0;             ///< an error within this share of its form factor is good enough, too
  std::uint64_t points = 100'000;  ///< that an integral may take; one that needs more has not reached its tolerance
  bool both_ways = false;  ///< integrate over both patches, independently; errors then cover what the other one says
  /// Asked before each cell of an integral, and often while events hidden in one are looked for, from any thread: true,
  /// once and from then on, ends the work, and what it gave then is not to be used. May be empty.
  std::function<bool()> stop = {};
};

/// What two patches exchange. A_i F_ij = A_j F_ji by construction: both come from one integral.
struct PairFormFactor {
  double F = 0, F_reverse = 0;
  double F_error = 0, F_reverse_error = 0;  ///< estimates of |F − true F| that are meant to hold
  bool reached = true;                      ///< whether both errors are within what is asked
  PairClass kind = PairClass::facing_away;
  std::uint64_t points = 0;  ///< that were looked from
};

/// Works on pairs of one scene, for one thread: holds scratch memory.
class PairIntegrator {
 public:
  explicit PairIntegrator(const ExchangeScene& scene);

  /// F from patch i to patch j and back; i = j: what a bent patch sees of itself.
  ///  - Facing away, decided exactly: 0 ± 0.
  ///  - In one plane, but that rounding has left a gap: 0, blocked, with a proven bound of what the gap lets through as
  ///    error. Where they face each other and one lies over the other, that is nothing: they are in contact.
  ///  - Open, decided exactly (nothing reaches into the shaft of both): the contour integral, without a point of view.
  ///  - Blocked, decided exactly for one convex occluder: 0 ± 0; behind several together it counts as partial.
  ///  - Partial: by ObstructedExchange, over the patch on which fewer visual events lie; between 0 and the unobstructed
  ///    exchange, and half of that without integration where it is negligible.
  /// An exchange that cannot be told from 0 at all within tolerance keeps its error.
  PairFormFactor form_factor(std::size_t i, std::size_t j, const PairOptions& options);

 private:
  struct Exchanged {
    double integral = 0, error = 0;
    PairClass kind = PairClass::facing_away;
  };
  Exchanged exchange(const ExchangeScene::Piece& a, const ExchangeScene::Piece& b, double tolerance, double needed,
                     const PairOptions& options, std::uint64_t& points);

  const ExchangeScene& scene_;
  Shaft shaft_;
  Viewpoint view_;
  std::vector<std::uint32_t> items_;
};

}  // namespace exitance
