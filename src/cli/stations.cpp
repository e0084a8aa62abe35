#include "src/cli/stations.h"

#include <fmt/format.h>

namespace exitance {

std::vector<Station> stations_of(const std::vector<Event>& events) {
  std::vector<Station> stations(1);
  for (std::size_t next = 0; next < events.size();) {
    Station station{events[next].time, next, next, false};
    while (station.last < events.size() && events[station.last].time == station.time) ++station.last;
    stations.push_back(station);
    next = station.last;
  }
  return stations;
}

Station working_off(const Station& last) {
  return {last.time, last.last, last.last, true};
}

std::vector<std::string> names_of_edits(const DynamicScene& scene, const Station& station) {
  if (station.works_off) return {"work off"};
  std::vector<std::string> names;
  for (std::size_t k = station.first; k < station.last; ++k) {
    const Edit& edit = scene.events[k].edit;
    names.push_back(fmt::format("{} {}", name_of(edit.operation), scene.scene.objects[edit.object].name));
  }
  return names;
}

std::map<std::uint32_t, std::uint32_t> lines_of_edits(const DynamicScene& scene, const Station& station) {
  std::map<std::uint32_t, std::uint32_t> lines;
  for (std::size_t k = station.first; k < station.last; ++k) lines[scene.events[k].edit.object] = scene.events[k].line;
  return lines;
}

}  // namespace exitance
