#include "src/stress/question.h"

#include <algorithm>

namespace exitance {
namespace {

PolygonSoup soup_of(const Question& question) {
  QuestionScene occluders;
  occluders.add(question.occluders);
  std::vector<Polygon> polygons{question.receiver, question.source};
  std::vector<Role> roles{Role::patch, Role::patch};
  polygons.insert(polygons.end(), occluders.polygons.begin(), occluders.polygons.end());
  roles.insert(roles.end(), occluders.roles.begin(), occluders.roles.end());
  return PolygonSoup(polygons, roles);
}

}  // namespace

bool has_sound_polygons(const Question& question) {
  const auto is_sound = [](const Polygon& polygon) {
    const PolygonDefect defect = find_defect(polygon);
    return defect == PolygonDefect::none || defect == PolygonDefect::zero_area;
  };
  return (question.receiver.outer.empty() || is_sound(question.receiver)) && is_sound(question.source) &&
         std::ranges::all_of(question.occluders,
                             [&](const Obstacle& o) { return std::ranges::all_of(o.faces, is_sound); });
}

Question near_one(const Question& question) {
  ExactScale scale;
  scale.include(question.point);
  scale.include(question.receiver);
  scale.include(question.source);
  for (const Obstacle& o : question.occluders) {
    for (const Polygon& face : o.faces) scale.include(face);
  }
  const int exponent = scale.exponent();
  Question scaled = question;
  scaled.point = ExactScale::scaled(question.point, exponent);
  scaled.receiver = ExactScale::scaled(question.receiver, exponent);
  scaled.source = ExactScale::scaled(question.source, exponent);
  for (Obstacle& o : scaled.occluders) {
    for (Polygon& face : o.faces) face = ExactScale::scaled(std::move(face), exponent);
  }
  return scaled;
}

AreaScene::AreaScene(const Question& given) : question(near_one(given)), soup(soup_of(question)) {
  QuestionScene object;
  object.add(
      {question.occluders.begin(), question.occluders.begin() + static_cast<std::ptrdiff_t>(object_size(question))});
  last_of_object += static_cast<std::uint32_t>(object.polygons.size());
}

std::vector<AreaScene::Ends> AreaScene::ends() const {
  std::vector<Ends> all;
  for (std::uint32_t r = soup.first_facet(0); r < soup.first_facet(1); ++r) {
    for (std::uint32_t s = soup.first_facet(1); s < soup.first_facet(2); ++s) all.push_back({r, s});
  }
  if (all.size() <= kMostEnds) return all;
  std::vector<Ends> some;
  for (std::size_t k = 0; k < kMostEnds; ++k) some.push_back(all[k * all.size() / kMostEnds]);
  return some;
}

}  // namespace exitance
