#pragma once
// Metamorphic properties: what must hold between the answers to forms of one question, whatever the truth is.

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "src/stress/placement.h"
#include "src/stress/point_contender.h"

namespace exitance {

/// What a property came to for one question.
struct PropertyTrial {
  double defect = 0;   ///< by how much it does not hold
  double allowed = 0;  ///< what the margins of the answers allow
  bool holds() const { return defect <= allowed; }
};

struct Property {
  std::string name;
  std::string what;  ///< in one line
  /// Forms of the question that the property is about, drawn at random; empty where it does not apply.
  std::vector<PointQuestion> (*forms)(const PointQuestion& question, Random& random);
  PropertyTrial (*judge)(const Opinion& opinion, std::span<const Opinion> of_forms);
};

/// permuted, split, duplicated, reversed, triangulated, as_sheets, scaled, translated, renumbered, added, pieces.
std::span<const Property> properties();

using AskPoint = std::function<Opinion(const PointQuestion&)>;

/// Asks; nothing where the property does not apply.
std::optional<PropertyTrial> try_property(const Property& property, const PointQuestion& question,
                                          const Opinion& opinion, const AskPoint& ask, Random& random);

/// Puts a closed room around the question, makes patches of everything, and sums the form factors of all fronts and
/// backs that the point sees: by how much the sum misses 1, and the bounds of all of its terms.
PropertyTrial try_closure(const PointQuestion& question);

}  // namespace exitance
