#pragma once
// Files that are either written whole or not at all.

#include <filesystem>
#include <functional>
#include <ostream>

namespace exitance {

/// Has `write` fill a new file beside `path` (binary mode) and renames it to `path` when all of it is on the
/// disk, so that an earlier file of that name stays as it was until then, and for good if anything fails. Links are
/// followed; FIFOs, devices and /dev/stdout are written to directly (draft.h). Throws InputError naming the path when
/// it cannot be written; what `write` throws passes through. Either way nothing new is left behind.
void write_whole_file(const std::filesystem::path& path, const std::function<void(std::ostream&)>& write);

}  // namespace exitance
