#pragma once
// What can have changed of a source's light when an object between comes or goes.

#include "src/stress/verdict.h"

namespace exitance {

/// Asks ShadowVolume, of the first half of the occluders as the object and the source as the shooter. Opinion::classes
/// (Shade), for up to four pairs of facets of receiver and source: of the receiver's facet; of the question's point; of
/// three sample points of the facet; each point once without screens and once with all that is not the object's.
Opinion ask_shadows(const Question& question);

/// What may be said, exactly. Of a facet: what ShaftOracle says of the object's facets and convex shells, but that an
/// object in the shooter's plane may be penumbra to all. Of a point: not outside where CGAL's Boolean operations find
/// another region visible with the object than without it (a part of it above 1e-12 in F for sample points, whose
/// rounded coordinates leave their facet's plane); not umbra where they find some. Takes some ten milliseconds.
Truth shadow_truth(const Question& question);

}  // namespace exitance
