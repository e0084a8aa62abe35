#pragma once
// The frames of a scene's events by hierarchical links.

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "src/cli/frame_files.h"
#include "src/links/linked_radiosity.h"
#include "src/scene/scene_file.h"

namespace exitance {

/// rebuild, direct, hvt, hvt-peu; none where there is none of that name.
std::optional<LinkMethod> link_method_named(const std::string& name);

struct LinkFrameOptions : FrameOptions {
  LinkOptions links;
  LinkMethod method = LinkMethod::hvt;
  std::function<bool()> abandon;  ///< asked as `stop`; the frame that is being made is dropped then, or only its error
};

enum class LinksEnd : std::uint8_t {
  finished,
  unfinished  ///< building ended before all links were refined, updates left something that no budget said, or the
              ///< last, or the search for its error, was abandoned
};

/// Follows the scene through its events; frame 0 is built before the first. Warns of objects that pass through others
/// or have left the scene. Writes frame_*.png and frame_*.vtp into the folder. Errors are eq. 7 of George et al. (1990)
/// against the converged solution on the same links.
LinksEnd follow_links(const DynamicScene& given, const LinkFrameOptions& options, const std::filesystem::path& folder);

}  // namespace exitance
