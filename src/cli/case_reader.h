#pragma once
// Single questions as they stand in a JSON file.

#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "src/form_factor/point_question.h"

namespace exitance {

/// Something of a case is missing or is not what it must be: "patches[2].rho: must lie in [0, 1), not 1.5".
class InvalidCase : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

struct PolygonQuestion {
  Polygon receiver, source;
  std::vector<Obstacle> occluders;
};

struct CasePatch {
  Polygon polygon;             ///< may be empty where absent
  std::vector<double> E, rho;  ///< one a band; only of patches with materials; 0 where absent and not given
  bool absent = false;
};

struct CasePatches {
  std::vector<CasePatch> patches;
  std::size_t bands = 1;
  bool bands_in_lists = false;  ///< whether bands were given as lists, so that answers are lists too

  /// Repeats numbers for so many bands; lists stay as they are.
  void repeat_for(std::size_t count);
};

/// `what` is the case, or the part of it that holds patches. All throw InvalidCase.
PointQuestion read_point_question(const nlohmann::json& what);
PolygonQuestion read_polygon_question(const nlohmann::json& what);
/// with_materials: every patch must have E and rho, each a number or a list of bands; a number counts for all bands. A
/// patch that is absent needs neither these nor a polygon.
CasePatches read_patches(const nlohmann::json& what, const std::string& path, bool with_materials);

}  // namespace exitance
