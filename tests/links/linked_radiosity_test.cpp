#include "src/links/linked_radiosity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "src/solve/scene_solution.h"
#include "tests/links/rooms.h"

namespace exitance {
namespace {

double worst_of(const LinkedRadiosity& links, double B) {
  double worst = 0;
  for (const std::uint32_t n : links.elements()) worst = std::max(worst, std::fabs(links.radiosity().B()[n] - B));
  return worst;
}

TEST(LinkedRadiosity, FurnaceComesNearTheTruthAsThresholdsFall) {
  Scene scene = empty_room();
  for (Surface& s : scene.surfaces) s.material = 1;
  double before = 0.2;  // of B = 2
  for (const double eps : {0.03, 0.01, 0.003}) {
    LinkOptions options;
    options.eps2 = eps;
    options.eps1 = eps / 2;
    options.smallest_area = 0.036;
    options.tolerance = 1e-12;
    LinkedRadiosity links(scene, options);
    const LinkUpdate update = links.build();
    EXPECT_TRUE(update.exchange.converged);
    EXPECT_LE(update.exchange.error_bound, 1e-12);
    const double worst = worst_of(links, 2);
    EXPECT_LT(worst, before);
    before = worst / 2;
  }
}

bool same_bits(const LinkIndex& a, const LinkIndex& b) {
  if (a.roots() != b.roots()) return false;
  for (std::uint32_t r = 0; r < a.roots(); ++r) {
    const auto x = a.of_receiver(r), y = b.of_receiver(r);
    if (x.size() != y.size()) return false;
    for (std::size_t k = 0; k < x.size(); ++k) {
      const Link &l = x[k], &m = y[k];
      if (l.code != m.code || l.source != m.source || l.destination != m.destination || l.next != m.next ||
          l.ghost != m.ghost || l.open != m.open || l.blocked != m.blocked || l.stale != m.stale ||
          std::memcmp(&l.form_factor, &m.form_factor, sizeof(double)) != 0 ||
          std::memcmp(&l.visibility, &m.visibility, sizeof(double)) != 0 ||
          std::memcmp(&l.energy, &m.energy, sizeof(double)) != 0) {
        return false;
      }
    }
  }
  return true;
}

TEST(LinkedRadiosity, HvtLeavesWhatDirectLeavesBitForBit) {
  std::mt19937_64 random(1);
  for (int k = 0; k < 10; ++k) {
    Scene scene = empty_room();
    const int things = 2 + static_cast<int>(random() % 3);
    for (int t = 0; t < things; ++t) {
      const Vec3 low{uniform(random, 0.2, 2), uniform(random, 0.2, 2), t % 2 ? 0 : uniform(random, 0.3, 1.5)};
      const Vec3 size{uniform(random, 0.2, 0.8), uniform(random, 0.2, 0.8), uniform(random, 0.2, 0.8)};
      add(scene, "thing", box_faces(low, low + size, t == 1 ? 3 : 2, 0));
    }
    LinkOptions options;
    options.eps2 = 0.02;
    options.eps1 = 0.012;
    options.smallest_area = 0.02;
    LinkedRadiosity direct(scene, options), hvt(scene, options);
    direct.build();
    hvt.build();
    ASSERT_TRUE(same_bits(direct.links(), hvt.links()));
    for (int e = 0; e < 4; ++e) {
      std::vector<Edit> edits;
      const int n = 1 + static_cast<int>(random() % 2);
      for (int i = 0; i < n; ++i) {
        edits.push_back(move_to(1 + static_cast<std::uint32_t>(i),
                                {uniform(random, -0.2, 0.2), uniform(random, -0.2, 0.2), 0},
                                e % 2 ? 0 : 90.0 * (e / 2)));
      }
      const LinkUpdate d = direct.update(edits, LinkMethod::direct), h = hvt.update(edits, LinkMethod::hvt);
      EXPECT_LT(h.work.links_updated, d.work.links_updated);
      ASSERT_TRUE(same_bits(direct.links(), hvt.links())) << k << ", " << e;
      EXPECT_EQ(
          std::memcmp(direct.radiosity().B().data(), hvt.radiosity().B().data(), direct.radiosity().B().size_bytes()),
          0);
    }
  }
}

}  // namespace
}  // namespace exitance
