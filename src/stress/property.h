#pragma once
// Metamorphic properties: what must hold between the answers to forms of one question, whatever the truth is.

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "src/stress/contender.h"
#include "src/stress/question_form.h"

namespace exitance {

/// What a property came to for one question.
struct PropertyTrial {
  double defect = 0;                                ///< by how much it does not hold
  double allowed = 0;                               ///< what the margins of the answers allow
  bool holds() const { return defect <= allowed; }  ///< not where either is no number
};

struct Property {
  std::string name;
  std::string what;  ///< in one line
  /// Forms of the question that the property is about, drawn at random; empty where it does not apply.
  Forms (*forms)(const Question& question, Random& random);
  PropertyTrial (*judge)(const Opinion& opinion, std::span<const Opinion> of_forms);
};

/// permuted, split, duplicated, reversed, triangulated, as_sheets, scaled, translated, renumbered, added, pieces: of F.
std::span<const Property> point_properties();
/// The same of pairs, and swapped: F and F back change places.
std::span<const Property> pair_properties();
/// Of Opinion::visibility. What is cut, turned over or taken to pieces is as open as before; it may be blocked by
/// several things together then.
std::span<const Property> shaft_properties();
/// Those that leave the object the same.
std::span<const Property> shadow_properties();

using Ask = std::function<Opinion(const Question&)>;

/// Asks; nothing where the property does not apply.
std::optional<PropertyTrial> try_property(const Property& property, const Question& question, const Opinion& opinion,
                                          const Ask& ask, Random& random);

/// Puts a closed room around the question, makes patches of everything, and sums the form factors of all fronts and
/// backs that the point sees: by how much the sum misses 1, and the bounds of all of its terms.
PropertyTrial try_closure(const PointQuestion& question);

}  // namespace exitance
