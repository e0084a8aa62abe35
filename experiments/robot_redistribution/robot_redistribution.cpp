// Figure 7 of George, Sillion and Greenberg (1990): a robot comes into a furnished room.

#include "experiments/redistribution_race.h"
#include "tests/places.h"

namespace exitance {
namespace {

Race race(bool reduced) {
  Race race{"Robot", read_dynamic_scene(source_file("data/robot.toml"), Emission::exitance), {}};
  race.tolerance = 3e-4;
  race.column_memory = std::uint64_t{3} << 30;
  race.pictured = {5, 100};
  const MeshDefaults& mesh = race.scene.scene.mesh;
  race.mesh = {mesh.patch_size, mesh.elements_per_edge, mesh.small_patch};
  race.until = 0.01;
  race.most_seconds = 1200;
  if (reduced) {  // the robot in the room of the Cube
    DynamicScene cube = read_dynamic_scene(source_file("data/cube.toml"), Emission::exitance);
    race.mesh = {1.0, 1};
    race.tolerance = 1e-6;
    Scene& into = cube.scene;
    const auto material = static_cast<std::uint32_t>(into.materials.size());
    into.materials.insert(into.materials.end(), race.scene.scene.materials.begin(), race.scene.scene.materials.end());
    std::erase_if(into.absent, [](const Surface&) { return true; });
    const auto robot = race.scene.events.front().edit.object;
    for (Surface surface : race.scene.scene.absent) {
      if (surface.object != robot) continue;
      surface.object = static_cast<std::uint32_t>(into.objects.size());
      surface.material += material;
      into.absent.push_back(surface);
    }
    into.objects.push_back({"robot", ""});
    Edit edit = race.scene.events.front().edit;
    edit.object = static_cast<std::uint32_t>(into.objects.size() - 1);
    edit.placement->translation = {0.8, 1.0, 0};
    cube.events = {{1, edit, 0}};
    race.scene = std::move(cube);
  }
  return race;
}

}  // namespace
}  // namespace exitance

int main(int argc, char** argv) {
  return exitance::run_race(argc, argv, "Robot: after the robot has come", exitance::race);
}
