#pragma once
// Families of degenerate questions "what does this point see of that polygon", drawn at random.

#include <cstdint>
#include <span>
#include <string>

#include "src/stress/stage.h"

namespace exitance {

/// How far from the degenerate position things are moved before they are put into space.
struct Departure {
  std::string name;
  double size = 0;         ///< of the stage's unit; most of its lengths are 1 to 16
  bool by_an_ulp = false;  ///< every coordinate, once it stands in space, by one ulp at most
};

/// None, an ulp, and 1e-12 to 1e-3.
std::span<const Departure> departures();

struct QuestionFamily {
  std::string name;
  std::string what;  ///< in one line
  /// Sets up the exact position, or one that departs from it by Stage::size where that is what the family is about.
  void (*set_up)(Stage& stage);
  bool departs_by_itself = false;  ///< its parts are not moved any further
};

std::span<const QuestionFamily> question_families();

struct DrawnQuestion {
  std::string placement;   ///< how it was put into space
  PointQuestion question;  ///< without defects other than zero area
};

/// A question of the family: set up, moved, and put into space: on the lattice, on a tilted one, or rotated at random
/// (rounded), near the origin or as far as 1e9, from 1e-12 to 1e12 in size, or down among the denormals. Solids stay
/// closed. The same numbers give the same question.
DrawnQuestion draw_question(const QuestionFamily& family, const Departure& departure, Random& random);

}  // namespace exitance
