// Figure 6 of George, Sillion and Greenberg (1990): a cube comes into a simple room.

#include "experiments/redistribution_race.h"
#include "tests/places.h"

namespace exitance {
namespace {

Race race(bool reduced) {
  Race race{"Cube", read_dynamic_scene(source_file("data/cube.toml"), Emission::exitance), {}};
  race.pictured = {2, 50};
  const MeshDefaults& mesh = race.scene.scene.mesh;
  race.mesh = {mesh.patch_size, mesh.elements_per_edge, mesh.small_patch};
  if (reduced) race.mesh = {1.0, 1};
  return race;
}

}  // namespace
}  // namespace exitance

int main(int argc, char** argv) {
  return exitance::run_race(argc, argv, "Cube: after the cube has come", exitance::race);
}
