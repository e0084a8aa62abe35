#pragma once
// What the frames of a dynamic scene follow, whatever follows them.

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "src/scene/scene_file.h"

namespace exitance {

/// All events of one time; none of frame 0, and where what was left is worked off.
struct Station {
  double time = 0;
  std::size_t first = 0, last = 0;  ///< of the scene's events
  bool works_off = false;
};

/// By frame; the first stands before all events.
std::vector<Station> stations_of(const std::vector<Event>& events);

/// One more, behind the last, where what was left is worked off.
Station working_off(const Station& last);

/// What is done there, as frames.json tells it.
std::vector<std::string> names_of_edits(const DynamicScene& scene, const Station& station);

/// Objects that are edited there, and in which line of the scene file last.
std::map<std::uint32_t, std::uint32_t> lines_of_edits(const DynamicScene& scene, const Station& station);

}  // namespace exitance
