#include "geometry/near_pairs.h"

#include <CGAL/Bbox_3.h>
#include <CGAL/Box_intersection_d/Box_with_info_d.h>
#include <CGAL/box_intersection_d.h>

#include <algorithm>
#include <vector>

namespace exitance {
namespace {

using NumberedBox = CGAL::Box_intersection_d::Box_with_info_d<double, 3, std::uint32_t>;

std::vector<NumberedBox> numbered(std::span<const Box> boxes) {
  std::vector<NumberedBox> result;
  result.reserve(boxes.size());
  for (std::uint32_t i = 0; i < boxes.size(); ++i) {
    const auto& [lower, upper] = boxes[i];
    result.emplace_back(CGAL::Bbox_3(lower.x, lower.y, lower.z, upper.x, upper.y, upper.z), i);
  }
  return result;
}

}  // namespace

void for_each_near_pair(std::span<const Box> a, std::span<const Box> b, const PairVisitor& visit) {
  std::vector<NumberedBox> first = numbered(a), second = numbered(b);
  CGAL::box_intersection_d(first.begin(), first.end(), second.begin(), second.end(),
                           [&](const NumberedBox& p, const NumberedBox& q) { visit(p.info(), q.info()); });
}

void for_each_near_pair(std::span<const Box> boxes, const PairVisitor& visit) {
  std::vector<NumberedBox> all = numbered(boxes);
  CGAL::box_self_intersection_d(all.begin(), all.end(), [&](const NumberedBox& p, const NumberedBox& q) {
    visit(std::min(p.info(), q.info()), std::max(p.info(), q.info()));
  });
}

}  // namespace exitance
