#pragma once
// What programs that were killed have left beside their results.

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <string_view>

namespace exitance {

/// "<host>-<process namespace>-<number>": a name for drafts of a process of this host and namespace (container), as
/// numbers mean nothing in others.
std::string name_of_process(pid_t process);

/// Removes the files and folders of `folder` whose names are `before`, the name of a process that is no more, and
/// `after`. Those of living processes stay, and what cannot be removed does. So do those of other hosts and containers,
/// even of ended ones: nothing here tells whether their processes live.
void remove_leftovers(const std::filesystem::path& folder, std::string_view before, std::string_view after);

}  // namespace exitance
