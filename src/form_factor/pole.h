#pragma once
// What makes a rule over a cell converge slowly although nothing happens within, and hides below coefficients that
// fall: poles near it. Crossings of edges that are nearly parallel as seen from there, and corners close by.

#include <span>

#include "geometry/viewpoint.h"
#include "src/form_factor/area_cell.h"

namespace exitance {

struct PoleError {
  double error = 0;  ///< of a rule's integral [m²]
  double fall = 0;   ///< at most 1: of the error of the worst pole, from one order to the next
};

/// Seen from x, edge e crosses edge g at the parameter N(x) / M(x) of e, both linear in x; M is 0 where e is parallel
/// to the plane through x and g. Where that line runs past a cell, the form factor has a pole there that hides below
/// the falling coefficients of a rule until it alone is left: a share N²/M of what the triangle between both edges
/// contributes. With δ the pole's distance from the cell, in halves of the cell's width across, a rule of order n errs
/// by the pole's size times (1 + δ + √(δ² + 2δ))^-2n. Edges in one plane cross at one point, which is a corner.
PoleError crossing_poles(std::span<const SeenEdge> edges, const AreaCell& cell, int order);

/// About a corner that ends an edge as seen from x, in the cell's plane or at a distance d from it, the form factor is
/// a function of the direction, and smooth only beyond d. A cell much wider than d that begins beside the corner has so
/// little area there, about d², that its coefficients fall as if it saw nothing of this: what is seen there differs by
/// V, what the edge contributes from beside the corner less what it contributes from the cell's middle or corners,
/// whichever differs most: by chance one of them sees as much. In the interval
/// [−1, 1] from the cell's point nearest to the corner to the one farthest from it, the corner is a point z of the
/// complex plane, and a rule of order n errs by d² V |z + √(z² − 1)|^-2n. Edges end at vertices and where they pierce
/// a surface that bounds what is seen. One that stands on the cell's plane but is seen elsewhere turns about that
/// point; there V is what the edges that it meets contribute. A triangle's last corner is no pole: its points lie on
/// rays from there (ray_fall); one at distance d from it is, but of the triangle only its area times (d / length)² is
/// near. So it is with any other corner of the cell that is one, where rules err as n^-4: they see what is farther
/// off than length / n², which stands for d. `x`: where the edges are seen from. `contacts`: further corners in the
/// cell's plane, such as those where edges pierce it.
PoleError corner_poles(std::span<const SeenEdge> edges, const Vec3& x, std::span<const Vec3> contacts,
                       const AreaCell& cell, int order);

/// Along rays from a contact what is seen hardly changes, from ray to ray it does. A rule over a triangle with the
/// contact at its last corner takes rays to points of the first side, in equal steps of which the direction turns
/// fastest where the side passes the contact: it is a function with poles where the (complex) distance is 0. How fast
/// its coefficients fall at best, from one order to the next, at most 1; 0 for any other cell.
double ray_fall(std::span<const Vec3> contacts, const AreaCell& cell);

}  // namespace exitance
