#include "src/form_factor/point_question.h"

#include <algorithm>
#include <stdexcept>

namespace exitance {
namespace {

void require_finite(const Vec3& v, const char* name) {
  if (!is_finite(v)) throw std::invalid_argument(std::string(name) + ": a coordinate is not a finite number");
}

}  // namespace

bool QuestionScene::add(const Polygon& polygon, Role role, const std::string& name) {
  const PolygonDefect defect = find_defect(polygon);
  if (defect == PolygonDefect::zero_area) return false;
  if (defect != PolygonDefect::none) throw std::invalid_argument(name + ": " + std::string(describe(defect)));
  polygons.push_back(polygon);
  roles.push_back(role);
  return true;
}

void QuestionScene::add(const std::vector<Obstacle>& obstacles, int exponent) {
  for (std::size_t k = 0; k < obstacles.size(); ++k) {
    const Obstacle& obstacle = obstacles[k];
    for (std::size_t f = 0; f < obstacle.faces.size(); ++f) {
      std::string name = "occluders[" + std::to_string(k) + "]";
      if (obstacle.solid) name += ".polyhedron[" + std::to_string(f) + "]";
      add(ExactScale::scaled(obstacle.faces[f], exponent), obstacle.solid ? Role::solid_face : Role::sheet, name);
    }
  }
}

ScaledQuestion scaled_near_one(PointQuestion question) {
  ExactScale scale, normal_scale;
  scale.include(question.point);
  scale.include(question.source);
  for (const Obstacle& o : question.occluders) {
    for (const Polygon& face : o.faces) scale.include(face);
  }
  normal_scale.include(question.normal);
  const int exponent = scale.exponent();
  question.point = ExactScale::scaled(question.point, exponent);
  question.normal = ExactScale::scaled(question.normal, normal_scale.exponent());
  question.source = ExactScale::scaled(std::move(question.source), exponent);
  for (Obstacle& o : question.occluders) {
    for (Polygon& face : o.faces) face = ExactScale::scaled(std::move(face), exponent);
  }
  return {std::move(question), exponent};
}

PointAnswer answer(const PointQuestion& question, double tolerance) {
  require_finite(question.point, "receiver.point");
  require_finite(question.normal, "receiver.normal");
  if (question.normal == Vec3{}) throw std::invalid_argument("receiver.normal: zero, so it has no direction");

  const PointQuestion scaled = scaled_near_one(question).question;
  QuestionScene scene;
  const bool has_source = scene.add(scaled.source, Role::unoccluding, "source");
  scene.add(scaled.occluders);
  if (!has_source) return {};

  const PolygonSoup soup(scene.polygons, scene.roles);
  Viewpoint view(soup);
  view.look_from({scaled.point, scaled.normal});
  PointAnswer sum;
  for (std::uint32_t f = soup.first_facet(0); f < soup.first_facet(1); ++f) {
    const PointFormFactor part = view.form_factor({f, {}}, tolerance);
    if (part.side != Side::front || part.visibility == Visibility::away) continue;
    const double total = sum.F + part.F;
    // Each addition rounds by at most half an ulp of its result.
    sum.F_error += part.error + (sum.F > 0 ? kRoundoff * total : 0);
    sum.F = total;
    const bool is_first = sum.visibility == Visibility::away;
    sum.visibility = is_first || sum.visibility == part.visibility ? part.visibility : Visibility::partial;
  }
  sum.stages = view.stage_counts();
  sum.extended = view.extended_count();
  return sum;
}

}  // namespace exitance
