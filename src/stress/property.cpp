#include "src/stress/property.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "src/stress/stage.h"

namespace exitance {
namespace {

PropertyTrial same(const Opinion& opinion, std::span<const Opinion> of_forms) {
  return {std::fabs(opinion.F - of_forms[0].F), opinion.margin + of_forms[0].margin};
}

PropertyTrial same_bits(const Opinion& opinion, std::span<const Opinion> of_forms) {
  return {std::fabs(opinion.F - of_forms[0].F) + std::fabs(opinion.margin - of_forms[0].margin), 0};
}

PropertyTrial not_more(const Opinion& opinion, std::span<const Opinion> of_forms) {
  const double more = of_forms[0].F - opinion.F;
  return {more < 0 ? 0 : more, opinion.margin + of_forms[0].margin};  // no number: broken
}

PropertyTrial sum(const Opinion& opinion, std::span<const Opinion> of_forms) {
  double total = 0, margins = opinion.margin;
  for (const Opinion& part : of_forms) {
    total += part.F;
    margins += part.margin + kRoundoff * total;
  }
  return {std::fabs(opinion.F - total), margins};
}

PropertyTrial same_class(const Opinion& opinion, std::span<const Opinion> of_forms) {
  return {static_cast<double>(opinion.visibility != of_forms[0].visibility), 0};
}

/// What several things block together, none of them blocks.
PropertyTrial as_open(const Opinion& opinion, std::span<const Opinion> of_forms) {
  const bool one = opinion.visibility == Visibility::open, other = of_forms[0].visibility == Visibility::open;
  return {static_cast<double>(one != other), 0};
}

/// What is added may join a solid, which then no longer blocks as a whole.
PropertyTrial not_opened(const Opinion& opinion, std::span<const Opinion> of_forms) {
  const bool was_open = opinion.visibility == Visibility::open, is_open = of_forms[0].visibility == Visibility::open;
  return {static_cast<double>(is_open && !was_open), 0};
}

PropertyTrial same_classes(const Opinion& opinion, std::span<const Opinion> of_forms) {
  return {static_cast<double>(opinion.classes != of_forms[0].classes), 0};
}

PropertyTrial same_exchange(const Opinion& opinion, std::span<const Opinion> of_forms) {
  const Opinion& back = of_forms[0];
  const PropertyTrial there{std::fabs(opinion.F - back.F_reverse), opinion.margin + back.reverse_margin},
      other{std::fabs(opinion.F_reverse - back.F), opinion.reverse_margin + back.margin};
  return there.holds() ? other : there;
}

/// Where the shafts of all facets are looked at.
Forms swapped_whole(const Question& question, Random& random) {
  const std::size_t shafts = cut_into_facets(question.receiver).size() * cut_into_facets(question.source).size();
  return shafts <= AreaScene::kMostEnds ? swapped(question, random) : Forms{};
}

constexpr const char *kPermuted = "occluders in another order", *kSplit = "a sheet cut in two",
                     *kDuplicated = "an occluder twice", *kReversed = "all sheets turned over",
                     *kTriangulated = "all occluders as triangles", *kAsSheets = "the faces of solids by themselves",
                     *kScaled = "scaled by a power of two: the same bits", *kTranslated = "moved without rounding",
                     *kRenumbered = "polygons from another vertex on", *kAdded = "one more occluder never shows more",
                     *kPieces = "triangles of the source sum to the whole", *kSwapped = "receiver and source exchanged";

}  // namespace

std::span<const Property> point_properties() {
  static const std::array kProperties{Property{"permuted", kPermuted, permuted, same},
                                      Property{"split", kSplit, split, same},
                                      Property{"duplicated", kDuplicated, duplicated, same},
                                      Property{"reversed", kReversed, reversed_sheets, same},
                                      Property{"triangulated", kTriangulated, triangulated, same},
                                      Property{"as_sheets", kAsSheets, as_sheets, same},
                                      Property{"scaled", kScaled, scaled, same_bits},
                                      Property{"translated", kTranslated, translated, same},
                                      Property{"renumbered", kRenumbered, renumbered, same},
                                      Property{"added", kAdded, added, not_more},
                                      Property{"pieces", kPieces, pieces, sum}};
  return kProperties;
}

std::span<const Property> pair_properties() {
  static const std::vector<Property> kProperties = [] {
    std::vector<Property> all(point_properties().begin(), point_properties().end());
    all.push_back({"swapped", kSwapped, swapped, same_exchange});
    return all;
  }();
  return kProperties;
}

std::span<const Property> shaft_properties() {
  static const std::array kProperties{Property{"permuted", kPermuted, permuted, same_class},
                                      Property{"split", kSplit, split, as_open},
                                      Property{"duplicated", kDuplicated, duplicated, as_open},
                                      Property{"reversed", kReversed, reversed_sheets, as_open},
                                      Property{"triangulated", kTriangulated, triangulated, as_open},
                                      Property{"as_sheets", kAsSheets, as_sheets, as_open},
                                      Property{"scaled", kScaled, scaled, same_classes},
                                      Property{"translated", kTranslated, translated, same_class},
                                      Property{"added", kAdded, added, not_opened},
                                      Property{"swapped", kSwapped, swapped_whole, same_class}};
  return kProperties;
}

std::span<const Property> shadow_properties() {
  static const std::array kProperties{Property{"reversed", kReversed, reversed_sheets, as_open},
                                      Property{"triangulated", kTriangulated, triangulated, as_open},
                                      Property{"scaled", kScaled, scaled, same_classes},
                                      Property{"translated", kTranslated, translated, as_open}};
  return kProperties;
}

std::optional<PropertyTrial> try_property(const Property& property, const Question& question, const Opinion& opinion,
                                          const Ask& ask, Random& random) {
  const Forms forms = property.forms(question, random);
  if (forms.empty()) return std::nullopt;
  std::vector<Opinion> opinions;
  for (const Question& form : forms) opinions.push_back(ask(form));
  PropertyTrial trial = property.judge(opinion, opinions);
  if (std::isnan(trial.defect)) trial.defect = INFINITY;
  return trial;
}

PropertyTrial try_closure(const PointQuestion& question) {
  Question scene{scaled_near_one(question).question, {}};
  Vec3 low = scene.point, high = low;
  change_points(scene, [&](const Vec3& v) {
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::fmin(low[axis], v[axis]);
      high[axis] = std::fmax(high[axis], v[axis]);
    }
  });
  const double room = 0.125 * std::max({high.x - low.x, high.y - low.y, high.z - low.z});
  for (int axis = 0; axis < 3; ++axis) {
    low[axis] -= room;
    high[axis] += room;
  }
  QuestionScene patches;
  for (Polygon wall : box(low, high).faces) {
    std::ranges::reverse(wall.outer);
    patches.add(wall, Role::patch, "room");
  }
  patches.add(scene.source, Role::patch, "source");
  for (const Obstacle& obstacle : scene.occluders) {
    for (const Polygon& face : obstacle.faces) patches.add(face, Role::patch, "occluder");
  }
  const PolygonSoup soup(patches.polygons, patches.roles);
  Viewpoint view(soup);
  view.look_from({scene.point, scene.normal});
  double sum = 0;
  PropertyTrial trial;
  for (std::uint32_t f = 0; f < soup.facets().size(); ++f) {
    const PointFormFactor part = view.form_factor({f, {}});
    sum += part.F;
    trial.allowed += part.error + kRoundoff * sum;
  }
  trial.defect = std::fabs(sum - 1);
  return trial;
}

}  // namespace exitance
