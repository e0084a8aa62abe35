#pragma once
// The unobstructed form factor between polygons.
//
// A_i F_ij = 1/2π ∮∮ ln r dv·dw over the outlines of the parts that lie in front of each other's planes (Sparrow 1963).
// It exists wherever polygons touch, as ln r is integrable. Where they are well apart the double integral over the
// areas takes its place (separated_exchange.h), for the contour's terms cancel when the value is small against their
// size; if they cancel too much, they are summed again in higher precision.

#include "geometry/separated_exchange.h"

namespace exitance {

/// What error is asked for, in form factors of the smaller polygon: no more than `absolute` nor than `relative` times
/// the value, but nothing less than `negligible`.
struct ExchangeTolerance {
  double absolute = 1e-12, relative = 1e-10, negligible = 1e-15;
};

/// A_i F_ij = A_j F_ji with nothing in between, so that F_ij = integral / A_i. Symmetric up to rounding. Fronts only:
///  - exactly 0 ± 0 if either lies nowhere in front of the other's plane, as do polygons in one plane, the two sides of
///    a sheet, and those of zero area. Decided exactly;
///  - each is clipped by the other's plane; edges and corners may coincide, cross or touch anywhere;
///  - facets whose planes differ so little, or of which so little lies in front of the other, that F < `negligible`
///    (neighbours in a rotated wall, walls that end on another one's rounded edge) count 0, with that bound as their
///    error.
/// The error covers truncation and rounding, that of clipped corners included. Coordinates are taken as they are.
/// REQUIRES: finite coordinates whose products of six neither overflow nor vanish (exact_scale.h).
Exchange unobstructed_exchange(const Radiator& a, const Radiator& b, const ExchangeTolerance& tolerance = {});

}  // namespace exitance
