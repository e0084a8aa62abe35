#pragma once
// What programs that were killed have left beside their results.

#include <filesystem>
#include <string_view>

namespace exitance {

/// Removes the files and folders of `folder` whose names are `before`, the number of a process that is no more, and
/// `after`. Those of living processes stay, and what cannot be removed does.
void remove_leftovers(const std::filesystem::path& folder, std::string_view before, std::string_view after);

}  // namespace exitance
