#pragma once
// Questions of a family, moved and put into space at random.

#include <span>
#include <string>

#include "src/stress/question.h"
#include "src/stress/question_family.h"

namespace exitance {

/// How far from the degenerate position things are moved before they are put into space.
struct Departure {
  std::string name;
  double size = 0;         ///< of the stage's unit; most of its lengths are 1 to 16
  bool by_an_ulp = false;  ///< every coordinate, once it stands in space, by one ulp at most
};

/// None, an ulp, and 1e-12 to 1e-3.
std::span<const Departure> departures();

struct DrawnQuestion {
  std::string placement;  ///< how it was put into space
  Question question;      ///< without defects other than zero area
};

/// A question of the family: set up, moved, and put into space: on the lattice, on a tilted one, or rotated at random
/// (rounded), near the origin or as far as 1e9, from 1e-12 to 1e12 in size, or down among the denormals. Solids stay
/// closed. The same numbers give the same question.
DrawnQuestion draw_question(const QuestionFamily& family, const Departure& departure, Random& random);

/// The same with a receiver about the point, drawn from numbers of its own: a rectangle, triangle or L of the lattice
/// of its plane, of which the point is an inner point, or on an edge, or a corner; narrow; far larger than all else; or
/// a wall that shares an edge with the source.
DrawnQuestion draw_area_question(const QuestionFamily& family, const Departure& departure, Random& random,
                                 Random& of_receiver);

}  // namespace exitance
