#pragma once
// Kinds of questions about the same degenerate scenes: of points, shafts, shadow volumes, and pairs of polygons.

#include <span>
#include <string>
#include <vector>

#include "src/stress/contender.h"
#include "src/stress/drawn_question.h"
#include "src/stress/property.h"
#include "src/stress/verdict.h"

namespace exitance {

struct QuestionKind {
  std::string name;
  std::string what;             ///< in one line
  std::string contender_names;  ///< those that there are
  /// Throws std::invalid_argument on other names.
  Contender (*contender_named)(const std::string& name);
  Truth (*truth)(const Question& question);
  std::span<const Property> (*properties)();
  bool of_areas = false;     ///< a receiver is drawn
  bool sums_to_one = false;  ///< whether closure is asked of contenders that are proven
};

/// points, shafts, shadows, pairs.
std::span<const QuestionKind> question_kinds();

/// Throws std::invalid_argument on a name that there is not, naming those that there are.
const QuestionKind& question_kind_named(const std::string& name);

/// Of a kind's properties, and "closure" where it has that.
std::vector<std::string> property_names(const QuestionKind& kind);
inline constexpr const char* kClosure = "closure";  ///< the last of them, where what is seen sums to one

}  // namespace exitance
