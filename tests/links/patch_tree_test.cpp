#include "src/links/patch_tree.h"

#include <gtest/gtest.h>

#include "src/links/link_sight.h"
#include "tests/links/cluttered_room.h"

namespace exitance {
namespace {

// From points of the receiver, as if nothing stood between.
TEST(PatchTree, NoFormFactorIsAboveItsBound) {
  std::mt19937_64 random(4);
  const EditedScene scene(cluttered_room(random, false, 30));
  const Obstacles obstacles(scene);
  const PolygonSoup& soup = obstacles.soup();
  const PatchTree tree(scene, soup, {{}, 0.01});
  Viewpoint view(soup);
  std::size_t near = 0;
  for (int k = 0; k < 20'000; ++k) {
    const Node& to = tree.node(static_cast<std::uint32_t>(random() % tree.nodes().size()));
    const Node& from = tree.node(static_cast<std::uint32_t>(random() % tree.nodes().size()));
    if (to.root == from.root) continue;
    const double bound = most_form_factor(to, from, soup);
    ASSERT_LE(bound, 1);
    view.look_from({point_of(to, random), soup.facets()[to.facet].plane.normal, to.facet});
    const PointFormFactor f = view.form_factor(source_of(from), {}, 1e-13);
    if (f.side != Side::front || f.F == 0) continue;
    ASSERT_LE(f.F, bound * (1 + 1e-12));
    near += bound < 2 * f.F;
  }
  EXPECT_GT(near, 1000u);
}

}  // namespace
}  // namespace exitance
