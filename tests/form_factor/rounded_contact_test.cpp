#include "src/form_factor/rounded_contact.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "tests/geometry/solids.h"

namespace exitance {
namespace {

/// Floor and ceiling of a room of edges of length 8, and between them a post on the floor.
class Post {
 public:
  Post(int top, bool turn) : turn_(turn) {
    std::vector<Polygon> polygons{{{{0, 0, 0}, {8, 0, 0}, {8, 8, 0}, {0, 8, 0}}, {}},
                                  {{{0, 0, 8}, {0, 8, 8}, {8, 8, 8}, {8, 0, 8}}, {}}};
    for (const Polygon& face : prism({{2, 2}, {5, 2}, {5, 5}, {2, 5}}, 0, top)) polygons.push_back(face);
    if (turn) {
      for (Polygon& p : polygons) std::ranges::transform(p.outer, p.outer.begin(), turned);
    }
    soup_.emplace(polygons);
    items_.resize(soup_->facets().size() + soup_->shells().size());
    std::iota(items_.begin(), items_.end(), 0u);
  }
  Source facet(std::uint32_t polygon) const { return {soup_->first_facet(polygon), {}}; }
  RoundedContact contact(std::uint32_t receiver, std::uint32_t source) const {
    return {*soup_, facet(receiver), facet(source), items_};
  }
  Vec3 at(const Vec3& p) const { return turn_ ? turned(p) : p; }

 private:
  bool turn_;
  std::optional<PolygonSoup> soup_;
  std::vector<std::uint32_t> items_;
};

TEST(RoundedContact, ExactOnesAreNone) {
  const Post post(4, false);
  EXPECT_TRUE(post.contact(0, 1).faces().empty());
  EXPECT_FALSE(post.contact(0, 1).buries({3, 3, 0}));
}

TEST(RoundedContact, BuriesWhatTheFootCovers) {
  const Post post(4, true);
  const RoundedContact contact = post.contact(0, 1);
  EXPECT_FALSE(contact.faces().empty());
  for (const auto& [x, y] : {std::pair{3.0, 3.0}, {2.1, 4.9}, {4.9, 2.1}})
    EXPECT_TRUE(contact.buries(post.at({x, y, 0})));
  for (const auto& [x, y] : {std::pair{1.0, 3.0}, {5.1, 4.0}, {3.0, 7.0}})
    EXPECT_FALSE(contact.buries(post.at({x, y, 0})));
}

TEST(RoundedContact, ASolidOnTheSourceBuriesWhereItPiercesTheReceiver) {
  const Post through(9, true), below(4, true);
  EXPECT_TRUE(through.contact(1, 0).buries(through.at({3, 3, 8})));
  EXPECT_FALSE(through.contact(1, 0).buries(through.at({1, 3, 8})));
  EXPECT_FALSE(below.contact(1, 0).buries(below.at({3, 3, 8})));
}

/// A solid that stands on the source does not bury what lies on its own sides: those points see the floor beside it.
TEST(RoundedContact, ASolidDoesNotBuryItsOwnSides) {
  const Post post(4, true);
  const std::array<Vec3, 4> middle{{{3.5, 2, 2}, {5, 3.5, 2}, {3.5, 5, 2}, {2, 3.5, 2}}};
  for (std::uint32_t side = 0; side < 4; ++side) {
    for (const double share : {-0.4, 0.0, 0.4}) {
      const Vec3 x = middle[side] + share * (middle[(side + 1) % 4] - middle[(side + 3) % 4]) + Vec3{0, 0, share};
      EXPECT_FALSE(post.contact(4 + side, 0).buries(post.at(x))) << side << ' ' << share;
    }
  }
}

}  // namespace
}  // namespace exitance
