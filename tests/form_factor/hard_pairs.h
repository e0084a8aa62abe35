#pragma once
// Sequences of obstructed pairs, from friendly to degenerate, on which error figures are measured.

#include <array>
#include <string_view>

#include "tests/form_factor/exchange_scenes.h"

namespace exitance {

/// plates: rectangles opposite or at a right angle, past one to four rectangles, all on a lattice of 1/16, so that much
/// touches and lies in one plane. boxes: past one to three closed boxes on a lattice of 1/8, which stand on the plates,
/// touch, overlap or pierce. hinged: plates that share an edge at any angle, past boxes that stand on one of them, and
/// on each other. standing: opposite plates, past turned boxes that stand on the one and may pierce the other, and on
/// each other. thin: plates of 2^-13, turned. slivers: triangles and plates of aspect up to 1e4. rooms: walls
/// of a cube or halves of them, past boxes, rectangles and triangles on a lattice of 1/4, so that nearly all is in
/// contact. sheets: like random_pair, by other seeds.
inline constexpr std::array<std::string_view, 8> kHardFamilies{"plates", "boxes",   "hinged", "standing",
                                                               "thin",   "slivers", "rooms",  "sheets"};

/// The number-th pair of a family; odd ones are turned, by a rotation of their own, and their coordinates rounded. Many
/// are open, blocked or face away. Bodies of several faces are closed. Throws std::invalid_argument for any other name.
KnownPair hard_pair(std::string_view family, int number);

}  // namespace exitance
