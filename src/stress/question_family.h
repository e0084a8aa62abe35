#pragma once
// Families of degenerate questions "what does this point see of that polygon", drawn at random.

#include <span>
#include <string>

#include "src/stress/stage.h"

namespace exitance {

struct QuestionFamily {
  std::string name;
  std::string what;  ///< in one line
  /// Sets up the exact position, or one that departs from it by Stage::size where that is what the family is about.
  void (*set_up)(Stage& stage);
  bool departs_by_itself = false;  ///< its parts are not moved any further
};

std::span<const QuestionFamily> question_families();

}  // namespace exitance
