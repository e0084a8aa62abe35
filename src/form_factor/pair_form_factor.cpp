#include "src/form_factor/pair_form_factor.h"

#include <algorithm>
#include <boost/math/constants/constants.hpp>
#include <cmath>
#include <optional>

#include "geometry/contour_form_factor.h"
#include "src/form_factor/obstructed_exchange.h"

namespace exitance {
namespace {

/// A pair that could exchange no more than this share of what is needed without anything between is not integrated.
constexpr double kNegligible = 1e-2;
/// Each side of a pair is tried with this part of the points at first. Where one stands still, as it does where
/// outlines differ by roundings all along an edge, the other mostly needs less than that.
constexpr std::uint64_t kTrial = 8;

/// The farthest that a facet's corners lie off another one's plane; infinite if that is more than the rounding of
/// coordinates explains.
double rounding_between(const RadiatorFacet& facet, const RadiatorFacet& plane, double size) {
  constexpr double kRounding = 0x1p-48;
  double farthest = 0, extent = 0;
  for (const Vec3& v : facet.loop) {
    const Vec3 w = v - plane.loop[0];
    farthest = std::max(farthest, std::fabs(dot(plane.normal, w)));
    extent = std::max(extent, norm(w));
  }
  // The normal's relative error is 2^-49, the products' less.
  return farthest <= kRounding * size ? farthest + 0x1p-48 * extent : INFINITY;
}

/// What a convex facet at no more than `height` above or below the plane of another may exchange at most with what of
/// that one lies not straight below or above it, no more than `reach` away [m²]. From distance t, measured in the
/// plane, it is seen at an elevation whose sine is at most height / t, and its form factor is at most the square of
/// that, and 1; less than perimeter · t + π t² lies within t of it. Integrated: 2 P h + π h² (1 + 2 ln(reach / h)).
double exchange_beside(const RadiatorFacet& facet, double height, double reach) {
  double perimeter = 0;
  for (std::size_t k = 0; k < facet.loop.size(); ++k) {
    perimeter += norm(facet.loop[(k + 1) % facet.loop.size()] - facet.loop[k]);
  }
  const double round = boost::math::constants::pi<double>() * (1 + 2 * std::log(std::max(1.0, reach / height)));
  return 1.01 * height * (2 * perimeter + round * height);
}

/// Whether two facets lie in one plane but for the rounding of their coordinates, as a box on a floor does when both
/// are turned; then, what they may exchange beyond nothing [m²]:
///  - Facing the same way. For a direction r from one to the other, both cosines are positive only if n · r is below
///    |n − m|, the difference of the unit normals: what is seen is a band above the horizon, and the form factor from
///    any point at most the square of that.
///  - Facing each other: where one lies over the other they are in contact, which is nothing by definition; else
///    exchange_beside().
std::optional<double> exchange_in_one_plane(const RadiatorFacet& a, const RadiatorFacet& b) {
  double size = 0;
  for (const auto* loop : {&a.loop, &b.loop}) {
    for (const Vec3& v : *loop) size = std::max({size, std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
  }
  const double of_a = rounding_between(a, b, size), of_b = rounding_between(b, a, size);
  if (!(std::max(of_a, of_b) < INFINITY)) return {};
  if (dot(a.normal, b.normal) > 0) {
    const double turn = norm(a.normal - b.normal) + 0x1p-47;
    return 1.01 * turn * turn * std::min(a.area, b.area);
  }
  const double reach = norm(b.centre - a.centre) + a.radius + b.radius;
  return std::min(exchange_beside(a, of_a, reach), exchange_beside(b, of_b, reach));
}

}  // namespace

ExchangeScene::ExchangeScene(const PolygonSoup& soup) : soup_(&soup) {
  for (std::uint32_t p = 0; p < soup.polygon_count(); ++p) {
    if (soup.role(p) == Role::patch) {
      for (std::uint32_t f = soup.first_facet(p); f < soup.first_facet(p + 1); ++f) add({f, {}});
    }
    end_patch();
  }
}

ExchangeScene::ExchangeScene(const PolygonSoup& soup, const PatchMesh& mesh, Unit unit) : soup_(&soup) {
  const auto add_all = [&](const auto& units) {
    for (const auto& u : units) {
      for (const PatchPiece& piece : mesh.pieces_of(u)) add({piece.facet, mesh.loop(piece)});
      end_patch();
    }
  };
  if (unit == Unit::patch) {
    add_all(mesh.patches);
  } else {
    add_all(mesh.elements);
  }
}

void ExchangeScene::add(const Source& source) {
  const std::vector<Loop> loop{corners_of(*soup_, source)};
  Piece piece{source, Radiator(loop)};
  if (!piece.radiator.facets().empty()) pieces_.push_back(std::move(piece));
}

void ExchangeScene::end_patch() {
  double area = 0;
  for (std::size_t k = first_.back(); k < pieces_.size(); ++k) area += pieces_[k].radiator.area();
  first_.push_back(pieces_.size());
  area_.push_back(area);
}

PairIntegrator::PairIntegrator(const ExchangeScene& scene) : scene_(scene), shaft_(scene.soup()), view_(scene.soup()) {}

/// `tolerance`: in form factors; `needed`: of the exchange [m²].
PairIntegrator::Exchanged PairIntegrator::exchange(const ExchangeScene::Piece& a, const ExchangeScene::Piece& b,
                                                   double tolerance, double needed, const PairOptions& options,
                                                   std::uint64_t& points) {
  shaft_.reset({a.source.facet, a.source.loop}, {b.source.facet, b.source.loop});
  if (!shaft_.face_each_other()) return {};
  if (const auto bound = exchange_in_one_plane(a.radiator.facets()[0], b.radiator.facets()[0])) {
    return {0, *bound, PairClass::blocked};
  }
  const Shaft::Overlap overlap = shaft_.find_occluders(items_);
  if (overlap == Shaft::Overlap::blocking) return {0, 0, PairClass::blocked};
  ExchangeTolerance asked;
  asked.absolute = std::min(asked.absolute, tolerance);
  const Exchange open = unobstructed_exchange(a.radiator, b.radiator, asked);
  if (overlap == Shaft::Overlap::outside) return {open.integral, open.error, PairClass::open};
  // What stands between takes away: the exchange lies between 0 and the unobstructed one, however badly it is known.
  const double unobstructed = open.integral + open.error, half = 0.5 * unobstructed;
  if (half <= kNegligible * needed) return {half, half, PairClass::partial};
  ObstructedExchange there(scene_.soup(), a.source, b.source, items_);
  ObstructedExchange back(scene_.soup(), b.source, a.source, items_);
  ObstructedExchange *one = &there, *other = &back;
  if (back.events() < there.events()) std::swap(one, other);
  const auto refine = [&](ObstructedExchange& side, std::uint64_t most) {
    side.refine(view_, needed, most, options.stop);
    return side.error() <= needed;
  };
  // A side that has much trouble, as beside a contact, leaves it to the other; where both have, it is that of less.
  const bool at_once = refine(*one, options.points / kTrial);
  if (!at_once && !refine(*other, options.points / kTrial)) {
    if (other->error() < one->error()) std::swap(one, other);
    if (!refine(*one, options.points)) refine(*other, options.points);
  }
  if (options.both_ways) {
    refine(*one, options.points);
    refine(*other, options.points);
  }
  points += one->points() + other->points();
  if (other->points() > 0 && other->error() < one->error()) std::swap(one, other);
  Exchanged result{one->integral(), one->error(), PairClass::partial};
  // What the two sides say of each other is the best judge of their errors.
  if (other->points() > 0) {
    const double apart = std::fabs(there.integral() - back.integral());
    if (apart > there.error() + back.error()) result.error = apart;
  }
  result.integral = std::clamp(result.integral, 0.0, unobstructed);
  result.error = std::min(result.error, std::max(result.integral, unobstructed - result.integral));
  return result;
}

PairFormFactor PairIntegrator::form_factor(std::size_t i, std::size_t j, const PairOptions& options) {
  const double A_i = scene_.area(i), A_j = scene_.area(j), smaller = std::min(A_i, A_j);
  PairFormFactor result;
  if (!(smaller > 0)) return result;
  bool open = false, blocked = false, partial = false;
  double integral = 0, error = 0;
  const auto a = scene_.pieces(i), b = scene_.pieces(j);
  const double share = 1 / static_cast<double>(a.size() * b.size());
  // A relative tolerance needs a value first: the rough one is good enough if it is large.
  double tolerance = options.relative > 0 ? std::max(options.tolerance, 1e-3 * options.relative) : options.tolerance;
  for (;;) {
    integral = error = 0;
    open = blocked = partial = false;
    for (std::size_t k = 0; k < a.size(); ++k) {
      for (std::size_t l = i == j ? k + 1 : 0; l < b.size(); ++l) {
        const Exchanged e =
            exchange(a[k], b[l], tolerance * share, tolerance * smaller * share, options, result.points);
        const double times = i == j ? 2 : 1;  // of a bent patch, what goes there and what comes back
        integral += times * e.integral;
        error += times * e.error;
        open = open || e.kind == PairClass::open;
        blocked = blocked || e.kind == PairClass::blocked;
        partial = partial || e.kind == PairClass::partial;
      }
    }
    const double enough = std::max(options.tolerance * smaller, options.relative * integral);
    if (error <= enough || tolerance <= options.tolerance || (options.stop && options.stop())) break;
    tolerance = std::max(options.tolerance, std::min(0.1 * tolerance, 0.5 * options.relative * integral / smaller));
  }
  result.kind = partial || (open && blocked) ? PairClass::partial
                : open                       ? PairClass::open
                : blocked                    ? PairClass::blocked
                                             : PairClass::facing_away;
  const auto ratio = [&](double area, double& F, double& F_error) {
    F = integral / area;
    F_error = error / area + 16 * kRoundoff * F;
  };
  ratio(A_i, result.F, result.F_error);
  ratio(A_j, result.F_reverse, result.F_reverse_error);
  result.reached = result.F_error <= std::max(options.tolerance, options.relative * result.F) &&
                   result.F_reverse_error <= std::max(options.tolerance, options.relative * result.F_reverse);
  return result;
}

}  // namespace exitance
