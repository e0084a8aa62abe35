#pragma once
// Codes of links: how both ends of a link were reached by subdividing two patches.

#include <compare>
#include <cstdint>

namespace exitance {

/// The path from a pair of whole patches to a pair of their sub-patches. Each step goes to one of the four children of
/// one end. The steps of one end alone are that sub-patch's path in its patch's quadtree, so that the code encodes both
/// paths. Codes of one pair of patches are in depth-first order: a link stands before its descendants, and these come
/// before all that is greater than it and not among them (Feng et al., section 4 and Figure 6).
class LinkCode {
 public:
  enum class End : std::uint8_t { receiver, source };
  static constexpr unsigned kMostSteps = 19;

  /// Of a pair of whole patches.
  constexpr LinkCode() = default;

  constexpr unsigned steps() const { return static_cast<unsigned>(bits_ & kLengthMask); }
  /// Which end step k divided, and to which child it went, 0 … 3. REQUIRES: k < steps().
  constexpr End end(unsigned k) const { return static_cast<End>(bits_ >> (shift(k) + 2) & 1); }
  constexpr unsigned child(unsigned k) const { return static_cast<unsigned>(bits_ >> shift(k) & 3); }

  /// REQUIRES: steps() < kMostSteps, child < 4.
  constexpr LinkCode descend(End divided, unsigned child) const {
    const std::uint64_t step = std::uint64_t{static_cast<std::uint8_t>(divided)} << 2 | child;
    return LinkCode((bits_ | step << shift(steps())) + 1);
  }

  /// Whether `other` is this link or one of its descendants.
  constexpr bool holds(LinkCode other) const {
    return steps() == 0 || (steps() <= other.steps() && (bits_ ^ other.bits_) >> shift(steps() - 1) == 0);
  }

  friend constexpr auto operator<=>(LinkCode, LinkCode) = default;

 private:
  // Three bits a step, the first one highest, and the number of steps in the lowest bits: zeros after a link's last
  // step equal those of its first child's, and its number of steps is less.
  static constexpr std::uint64_t kLengthMask = 31;
  static constexpr unsigned shift(unsigned k) { return 61 - 3 * k; }
  constexpr explicit LinkCode(std::uint64_t bits) : bits_(bits) {}

  std::uint64_t bits_ = 0;
};

}  // namespace exitance
