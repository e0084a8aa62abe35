#include "src/cli/case_reader.h"

#include <algorithm>
#include <cmath>

#include "src/scene/material_check.h"

namespace exitance {
namespace {

/// A value with the way to it, for messages.
class Field {
 public:
  Field(const nlohmann::json& value, std::string path) : value_(&value), path_(std::move(path)) {}

  [[noreturn]] void refuse(const std::string& what) const {
    throw InvalidCase((path_.empty() ? "" : path_ + ": ") + what);
  }

  bool has(const char* key) const { return value_->is_object() && value_->contains(key); }
  bool is_array() const { return value_->is_array(); }

  Field at(const char* key) const {
    if (!value_->is_object()) refuse("must be an object");
    const auto found = value_->find(key);
    if (found == value_->end()) refuse(std::string("the key \"") + key + "\" is missing");
    return {*found, path_.empty() ? key : path_ + "." + key};
  }
  std::vector<Field> items() const {
    if (!is_array()) refuse("must be a list");
    std::vector<Field> fields;
    for (std::size_t i = 0; i < value_->size(); ++i) {
      fields.emplace_back((*value_)[i], path_ + "[" + std::to_string(i) + "]");
    }
    return fields;
  }
  double number() const {
    if (!value_->is_number()) refuse("must be a number");
    const auto number = value_->get<double>();
    if (!std::isfinite(number)) refuse("is not a finite number");
    return number;
  }
  bool flag() const {
    if (!value_->is_boolean()) refuse("must be true or false");
    return value_->get<bool>();
  }

 private:
  const nlohmann::json* value_;
  std::string path_;
};

Vec3 read_vector(const Field& field) {
  const auto items = field.items();
  if (items.size() != 3) field.refuse("must have three coordinates");
  return {items[0].number(), items[1].number(), items[2].number()};
}

std::vector<Vec3> read_loop(const Field& field) {
  std::vector<Vec3> loop;
  for (const Field& point : field.items()) loop.push_back(read_vector(point));
  return loop;
}

/// Fewer than three points have no area: a polygon that counts for nothing, or is refused for that.
std::vector<Vec3> read_outer(const Field& field) {
  std::vector<Vec3> loop = read_loop(field);
  while (loop.size() < 3) loop.push_back(loop.empty() ? Vec3{} : loop.back());
  return loop;
}

Polygon read_polygon(const Field& field) {
  Polygon polygon{read_outer(field.at("polygon")), {}};
  if (field.has("holes")) {
    for (const Field& hole : field.at("holes").items()) polygon.holes.push_back(read_loop(hole));
  }
  return polygon;
}

std::vector<Obstacle> read_occluders(const Field& what) {
  std::vector<Obstacle> occluders;
  if (!what.has("occluders")) return occluders;
  for (const Field& field : what.at("occluders").items()) {
    Obstacle obstacle;
    if (field.has("polyhedron")) {
      obstacle.solid = true;
      for (const Field& face : field.at("polyhedron").items()) obstacle.faces.push_back({read_outer(face), {}});
    } else if (field.has("polygon")) {
      obstacle.faces.push_back(read_polygon(field));
    } else {
      field.refuse("the key \"polygon\" or \"polyhedron\" is missing");
    }
    occluders.push_back(std::move(obstacle));
  }
  return occluders;
}

std::vector<double> read_bands(const Field& field) {
  if (!field.is_array()) return {field.number()};
  std::vector<double> bands;
  for (const Field& band : field.items()) bands.push_back(band.number());
  if (bands.empty()) field.refuse("must have at least one band");
  return bands;
}

}  // namespace

PointQuestion read_point_question(const nlohmann::json& what) {
  const Field question(what, "");
  const Field receiver = question.at("receiver");
  return {read_vector(receiver.at("point")), read_vector(receiver.at("normal")), read_polygon(question.at("source")),
          read_occluders(question)};
}

PolygonQuestion read_polygon_question(const nlohmann::json& what) {
  const Field question(what, "");
  return {read_polygon(question.at("receiver")), read_polygon(question.at("source")), read_occluders(question)};
}

void CasePatches::repeat_for(std::size_t count) {
  bands = count;
  for (CasePatch& patch : patches) {
    for (std::vector<double>* values : {&patch.E, &patch.rho}) {
      if (values->size() == 1) values->resize(count, values->front());
    }
  }
}

CasePatches read_patches(const nlohmann::json& what, const std::string& path, bool with_materials) {
  CasePatches result;
  std::vector<Field> lists;
  for (const Field& field : Field(what, path).at("patches").items()) {
    CasePatch patch;
    if (field.has("absent")) patch.absent = field.at("absent").flag();
    const auto is_needed = [&](const char* key) { return !patch.absent || field.has(key); };
    if (is_needed("polygon")) patch.polygon = read_polygon(field);
    if (with_materials) {
      patch.E = is_needed("E") ? read_bands(field.at("E")) : std::vector<double>{0};
      patch.rho = is_needed("rho") ? read_bands(field.at("rho")) : std::vector<double>{0};
      for (const double E : patch.E) {
        if (!is_emission(std::fabs(E))) {
          field.at("E").refuse("must be 0 or of a size from 1e-250 to 1e100, not " + nlohmann::json(E).dump());
        }
      }
      for (const double rho : patch.rho) {
        if (!(rho >= 0 && rho < 1)) field.at("rho").refuse("must lie in [0, 1), not " + nlohmann::json(rho).dump());
      }
      for (const char* key : {"E", "rho"}) {
        if (field.has(key) && field.at(key).is_array()) lists.push_back(field.at(key));
      }
    }
    result.patches.push_back(std::move(patch));
  }
  if (!lists.empty()) {
    result.bands_in_lists = true;
    result.bands = lists.front().items().size();
    for (const Field& list : lists) {
      if (list.items().size() != result.bands) list.refuse("must have as many bands as the others");
    }
  }
  if (with_materials) result.repeat_for(result.bands);
  return result;
}

}  // namespace exitance
