#pragma once
// Rows of form factors in a checkpoint, bit for bit.

#include <vector>

#include "src/form_factor/pair_rows.h"
#include "src/form_factor/point_rows.h"
#include "src/output/checkpoint.h"

namespace exitance {

/// Saves rows of pairs that were not kept before. Throws std::invalid_argument when the sizes do not fit, and what the
/// checkpoint does.
void keep_pairs(Checkpoint& checkpoint, const PairRows& rows);

/// All of them, in the order in which they were kept. A part that is damaged or holds a row that is there already is
/// forgotten where the checkpoint forgets; otherwise throws DamagedFile, and what the checkpoint does.
std::vector<PairRows> kept_pairs(Checkpoint& checkpoint);

/// Saves the rows from `first` on of those that sample points see, and the statistics of all of them. Those before were
/// kept.
void keep_points(Checkpoint& checkpoint, const PointRows& rows, std::size_t first);

/// The first rows of so many columns that were kept: up to the first part that is damaged or does not go on where the
/// one before ends, which is forgotten with those behind it. Throws what else the checkpoint does.
PointRows kept_points(Checkpoint& checkpoint, std::uint32_t columns);

}  // namespace exitance
