#pragma once
// Ways to answer questions, behind one interface.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "src/stress/question.h"

namespace exitance {

/// What a way says of one question.
struct Opinion {
  double F = 0;
  double margin = 0;  ///< by how much F may differ from the truth: the proven bound; of rays, what their number allows
  /// How much of the source is seen; `partial` commits to nothing.
  Visibility visibility = Visibility::partial;
  StageCounts stages;                        ///< how its predicates were decided, if it counts them
  std::uint64_t extended = 0;                ///< facets that took more than double precision
  double F_reverse = 0, reverse_margin = 0;  ///< of pairs: from the source to the receiver
  std::vector<std::uint8_t> classes = {};    ///< of shafts and shadows: what is said of one thing after the other
};

struct Contender {
  std::string name;
  /// The same question and seed give the same opinion. Any number of threads may ask.
  std::function<Opinion(const Question&, std::uint64_t seed)> ask;
  /// Whether the margin is meant to hold always: then it must be small, too.
  bool is_proven = false;
  /// Whether properties are asked of it: not of rays, whose answers to two forms of one question differ by chance, and
  /// not of the oracle, which is slow.
  bool has_properties = false;
};

}  // namespace exitance
