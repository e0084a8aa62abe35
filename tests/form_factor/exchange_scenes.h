#pragma once
// Scenes whose form factors are known from exchange_truth.h: what stands in them are convex bodies in a convex room.

#include <cstdint>
#include <string_view>
#include <vector>

#include "src/scene/patch_mesh.h"
#include "src/scene/scene.h"
#include "src/stress/exchange_truth.h"

namespace exitance {

struct KnownScene {
  Scene scene;
  double patch_size = 0;           ///< 0: every surface is a patch
  std::vector<ConvexBody> bodies;  ///< all that hides anything
};

/// box_room: data/box_on_floor.toml in squares of 1/3. box_on_uncut_floor: the same, the floor whole under the box, all
/// in squares of 3/4, so that patches lie partly under it. turned_cubes: twenty in a room, as triangles, by rational
/// rotations whose coordinates are rounded. thin_plates: twenty of 1/10000, turned. sliver_fan: a floor of 200
/// triangles about its middle, a box above. Throws std::invalid_argument for any other name.
KnownScene known_scene(std::string_view name);

struct KnownPair {
  std::vector<Vec3> receiver, source;
  std::vector<ConvexBody> occluders;
};

/// Receiver and source as patches 0 and 1; bodies of several faces are closed.
PolygonSoup soup_of(const KnownPair& pair);

/// The number-th of a sequence: triangles and parallelograms, slivers among them, past one to six such sheets, some of
/// which pierce the plates' planes, each other or the plates. Coordinates are exact. Many are open or face away.
KnownPair random_pair(int number);

/// A_i F_ij of two patches, all their pieces.
ExchangeTruth patch_truth(const KnownScene& known, const PolygonSoup& soup, const PatchMesh& mesh, std::uint32_t i,
                          std::uint32_t j, const TruthOptions& options = {});

}  // namespace exitance
