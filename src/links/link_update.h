#pragma once
// Links brought up to date when a scene changes, in order of importance.

#include <span>
#include <vector>

#include "src/links/link_index.h"
#include "src/links/link_task.h"
#include "src/links/push_pull.h"

namespace exitance {

/// Two patches whose links are to be looked at.
struct PendingPair {
  PatchPair pair;
  /// What the links could bring at most, B F A of the receiver in luminance [W or what the scene has]; infinite where
  /// links are to go.
  double stake = 0;
};

/// Brings the links up to date, in parallel; the same bits for any number of threads. What a task leaves of a pair of
/// patches depends on these, the scene, the links that they had, and the luminances (PairUpdate): `all` and
/// `hierarchical` leave the same. With `differences`, what links bring more than before is handed to it
/// (NodeRadiosity::receive). Throws LimitError when there are more links than the task allows, and Abandoned; some are
/// then done.
///
/// With `pending`, a task can be interrupted (LinkTask::stop): it works on pairs in its order, 32 at a time or those of
/// a patch, and on all that has to go, and leaves in `pending` those that it did not come to. Called again with these,
/// the same task goes on where it ended: together both leave what one call would have left.
LinkWork update_links(const LinkTask& task, LinkIndex& links, NodeRadiosity* differences = nullptr,
                      std::vector<PendingPair>* pending = nullptr);

}  // namespace exitance
