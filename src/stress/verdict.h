#pragma once
// Whether an opinion is right.

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "src/stress/contender.h"
#include "src/stress/visibility_oracle.h"

namespace exitance {

struct Verdict {
  bool is_wrong = false;
  double error = 0;           ///< of F; infinite where it is no number
  double relative_error = 0;  ///< where the true F is at least 1e-15, else 0
};

/// Of a true F, and an error of what is said of it; one that is no number counts as infinite.
Verdict verdict_of(bool is_wrong, long double error, long double true_F);

/// What an oracle says of one question.
struct Truth {
  enum class Seen : std::uint8_t { none, some, all } seen = Seen::some;  ///< how much of the source
  std::optional<double> F;
  std::function<Verdict(const Opinion&)> judge;
};

/// Of points. Wrong: further from the truth than the margin, or no number, or without a margin that is one; or, where
/// the contender commits itself, blocked though some area is seen, open though some is hidden, away though some is
/// above the horizon and faces the point.
Verdict judge(const Opinion& opinion, const OracleAnswer& truth);

/// A set of classes, by their bits.
using Classes = std::uint8_t;
template <class... Class>
constexpr Classes bits(Class... classes) {
  return static_cast<Classes>(((1u << static_cast<unsigned>(classes)) | ...));
}

/// Of Opinion::classes. Wrong: not as many as are allowed, or one is none of those allowed in its place.
Verdict judge(const Opinion& opinion, const std::vector<Classes>& allowed);

}  // namespace exitance
