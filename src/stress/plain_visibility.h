#pragma once
// The kernel's algorithm as it is usually written: stretches of edges that bound what is seen, found by the signs that
// plain doubles give. It is here to show what exact signs are worth.

#include "src/form_factor/point_question.h"

namespace exitance {

/// Form factor from the point to the visible part of the front of the source. Ties are those that doubles happen to
/// give. No bound, no second try.
double plain_form_factor(const PointQuestion& question);

}  // namespace exitance
