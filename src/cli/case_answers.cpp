#include "src/cli/case_answers.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "src/cli/case_reader.h"
#include "src/cli/patch_radiosity.h"
#include "src/form_factor/area_form_factors.h"
#include "src/scene/scene_extent.h"

namespace exitance {
namespace {

constexpr double kUnitRoundoff = 0x1p-53;

using Json = nlohmann::ordered_json;

/// Points that each integral of so many pairs may take, so that the whole of it ends within a minute.
std::uint64_t points_per_integral(std::uint64_t pairs) {
  return std::clamp<std::uint64_t>(5'000'000 / std::max<std::uint64_t>(1, pairs), 2'000, 200'000);
}

void answer_point_polygon(const nlohmann::json& question, double tolerance, Json& result) {
  const PointAnswer a = answer(read_point_question(question), tolerance);
  result["F"] = a.F;
  result["F_error"] = a.F_error;
  result["reached"] = a.F_error <= tolerance;
}

/// Takes a polygon that exchanges, divided by 2^exponent. Returns whether it was taken: not where it has no area.
/// Throws InvalidCase where its area is lost beside the largest coordinate (`largest`, divided likewise).
bool add_patch(QuestionScene& scene, const Polygon& polygon, int exponent, double largest, const std::string& name) {
  const Polygon scaled = ExactScale::scaled(polygon, exponent);
  if (!scene.add(scaled, Role::patch, name)) return false;
  if (!find_bad_extent(scaled, largest).empty()) {
    throw InvalidCase(name +
                      ": its area is nothing beside the square of the largest coordinate, less than a part in 1e50");
  }
  return true;
}

void answer_polygon_polygon(const nlohmann::json& what, double tolerance, Json& result) {
  const PolygonQuestion question = read_polygon_question(what);
  ExactScale scale;
  double largest = 0;
  const auto include = [&](const Polygon& polygon) {
    scale.include(polygon);
    largest = std::max(largest, extent(polygon));
  };
  include(question.receiver);
  include(question.source);
  for (const Obstacle& o : question.occluders) std::ranges::for_each(o.faces, include);
  const int exponent = scale.exponent();
  largest = std::ldexp(largest, -exponent);
  QuestionScene scene;
  if (!add_patch(scene, question.receiver, exponent, largest, "receiver")) {
    throw InvalidCase("receiver: it has no area");
  }
  const bool has_source = add_patch(scene, question.source, exponent, largest, "source");
  scene.add(question.occluders, exponent);
  PairFormFactor f;
  if (has_source) {
    const PolygonSoup soup(scene.polygons, scene.roles);
    const ExchangeScene exchange(soup);
    PairOptions options;
    options.tolerance = tolerance;
    options.both_ways = true;
    f = PairIntegrator(exchange).form_factor(0, 1, options);
  }
  result["F"] = f.F;
  result["F_error"] = f.F_error;
  result["F_reverse"] = f.F_reverse;
  result["F_reverse_error"] = f.F_reverse_error;
  result["reached"] = f.reached;
}

/// The patches that are there, and their form factors; areas in units of 2^(2 · exponent).
struct Enclosure {
  std::vector<std::size_t> present;  ///< ascending
  AreaFormFactors form_factors;      ///< of those
  int exponent = 0;
};

Enclosure enclose(const CasePatches& given, const std::string& path, double tolerance) {
  Enclosure result;
  ExactScale scale;
  double largest = 0;
  for (const CasePatch& patch : given.patches) {
    if (patch.absent) continue;
    scale.include(patch.polygon);
    largest = std::max(largest, extent(patch.polygon));
  }
  result.exponent = scale.exponent();
  largest = std::ldexp(largest, -result.exponent);
  QuestionScene scene;
  for (std::size_t p = 0; p < given.patches.size(); ++p) {
    if (given.patches[p].absent) continue;
    const std::string name = path + "patches[" + std::to_string(p) + "]";
    if (!add_patch(scene, given.patches[p].polygon, result.exponent, largest, name)) {
      throw InvalidCase(name + ": it has no area");
    }
    result.present.push_back(p);
  }
  const PolygonSoup soup(scene.polygons, scene.roles);
  PairOptions options;
  options.tolerance = tolerance;
  options.both_ways = true;
  options.points = points_per_integral(scene.polygons.size() * (scene.polygons.size() - 1) / 2);
  result.form_factors = area_form_factors(ExchangeScene(soup), options);
  return result;
}

void answer_enclosure(const nlohmann::json& question, double tolerance, Json& result) {
  const CasePatches given = read_patches(question, "", false);
  const Enclosure enclosure = enclose(given, "", tolerance);
  const AreaFormFactors& f = enclosure.form_factors;
  const std::size_t n = given.patches.size();
  std::vector<std::vector<double>> F(n, std::vector<double>(n)), F_error = F;
  std::vector<double> A(n);
  for (std::size_t i = 0; i < f.n; ++i) {
    const std::size_t p = enclosure.present[i];
    A[p] = std::ldexp(f.area[i], 2 * enclosure.exponent);
    if (!std::isnormal(A[p])) {
      throw InvalidCase("patches[" + std::to_string(p) +
                        "]: its area is out of the range of a double (1e-307 to 1e308 m^2); scale the coordinates");
    }
    for (std::size_t j = 0; j < f.n; ++j) {
      F[p][enclosure.present[j]] = f.F[i * f.n + j];
      F_error[p][enclosure.present[j]] = f.F_error[i * f.n + j];
    }
  }
  result["F"] = F;
  result["F_error"] = F_error;
  result["A"] = A;
  result["reached"] = f.reached;
}

/// Solution of an enclosure, for all patches given, absent ones with zeros.
struct SolvedEnclosure {
  Enclosure enclosure;
  PatchRadiosity values;
};

SolvedEnclosure solve(const CasePatches& given, const std::string& path, double tolerance) {
  SolvedEnclosure solved{enclose(given, path, tolerance), {}};
  std::vector<double> E, rho;
  for (const std::size_t p : solved.enclosure.present) {
    E.insert(E.end(), given.patches[p].E.begin(), given.patches[p].E.end());
    rho.insert(rho.end(), given.patches[p].rho.begin(), given.patches[p].rho.end());
  }
  const PatchRadiosity found = patch_radiosity(solved.enclosure.form_factors, E, rho, given.bands);
  const auto spread = [&](const std::vector<double>& values) {
    std::vector<double> all(given.patches.size() * given.bands);
    for (std::size_t i = 0; i < values.size(); ++i) {
      all[solved.enclosure.present[i / given.bands] * given.bands + i % given.bands] = values[i];
    }
    return all;
  };
  solved.values = {spread(found.B), spread(found.H), spread(found.B_error)};
  return solved;
}

/// One number a patch, or one list of bands.
Json by_patch(const std::vector<double>& values, const CasePatches& given) {
  if (!given.bands_in_lists) return values;
  Json rows = Json::array();
  for (std::size_t p = 0; p < given.patches.size(); ++p) {
    const auto first = values.begin() + static_cast<std::ptrdiff_t>(p * given.bands);
    rows.push_back(std::vector<double>(first, first + static_cast<std::ptrdiff_t>(given.bands)));
  }
  return rows;
}

void answer_radiosity(const nlohmann::json& question, double tolerance, Json& result) {
  const CasePatches given = read_patches(question, "", true);
  const SolvedEnclosure solved = solve(given, "", tolerance);
  result["B"] = by_patch(solved.values.B, given);
  result["H"] = by_patch(solved.values.H, given);
  result["B_error"] = by_patch(solved.values.B_error, given);
  result["reached"] = solved.enclosure.form_factors.reached;
}

/// What every patch receives of B before, by form factors before (sign −1) or after (+1), with the error of that sum.
void add_irradiance(const SolvedEnclosure& solved, double sign, const std::vector<double>& B, std::size_t bands,
                    std::vector<double>& H, std::vector<double>& H_error) {
  const auto& [present, f, exponent] = solved.enclosure;
  for (std::size_t i = 0; i < f.n; ++i) {
    for (std::size_t j = 0; j < f.n; ++j) {
      for (std::size_t b = 0; b < bands; ++b) {
        const double Bj = B[present[j] * bands + b];
        H[present[i] * bands + b] += sign * f.F[i * f.n + j] * Bj;
        H_error[present[i] * bands + b] += f.F_error[i * f.n + j] * std::fabs(Bj);
      }
    }
  }
}

/// The change of form factors of a pair is at most what both sides have of it: Σ_j |ΔF_ij| δB_j.
void add_uncertain_source(const SolvedEnclosure& before, const SolvedEnclosure& after, std::size_t bands,
                          std::vector<double>& H_error) {
  const std::size_t n = before.values.B.size() / bands;
  std::vector<double> change(n * n);
  for (const auto& [solved, sign] : {std::pair{&before, -1.0}, std::pair{&after, 1.0}}) {
    const auto& [present, f, exponent] = solved->enclosure;
    for (std::size_t i = 0; i < f.n; ++i) {
      for (std::size_t j = 0; j < f.n; ++j) change[present[i] * n + present[j]] += sign * f.F[i * f.n + j];
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      for (std::size_t b = 0; b < bands; ++b) {
        H_error[i * bands + b] += std::fabs(change[i * n + j]) * before.values.B_error[j * bands + b];
      }
    }
  }
}

struct Change {
  std::vector<double> dB, dB_error;
};

/// ΔB = R + ΔE + Δρ H_before + ρ F_after ΔB (eq. 6, with what changes of the patches themselves), solved for the
/// patches that are there after; a patch that is not loses all that it had. Errors: those of the right side may all add
/// up.
Change solve_change(const SolvedEnclosure& before, const SolvedEnclosure& after, const CasePatches& given_before,
                    const CasePatches& given_after, const std::vector<double>& R, const std::vector<double>& R_error) {
  const std::size_t bands = given_before.bands;
  Change change{std::vector<double>(R.size()), std::vector<double>(R.size())};
  for (std::size_t i = 0; i < R.size(); ++i) {
    change.dB[i] = -before.values.B[i];
    change.dB_error[i] = before.values.B_error[i];
  }
  std::vector<double> H(R.size()), H_error(R.size());
  add_irradiance(before, 1, before.values.B, bands, H, H_error);
  double B_error = 0;
  for (const double error : before.values.B_error) B_error = std::max(B_error, error);
  std::vector<bool> was(given_before.patches.size());
  for (const std::size_t p : before.enclosure.present) was[p] = true;
  std::vector<double> source, rho;
  std::vector<double> worst(bands), max_rho(bands);
  for (const std::size_t p : after.enclosure.present) {
    for (std::size_t b = 0; b < bands; ++b) {
      const std::size_t i = p * bands + b;
      const double drho = was[p] ? given_after.patches[p].rho[b] - given_before.patches[p].rho[b] : 0;
      const double E_before = was[p] ? given_before.patches[p].E[b] : 0;
      source.push_back(R[i] + (given_after.patches[p].E[b] - E_before) + drho * before.values.H[i]);
      rho.push_back(given_after.patches[p].rho[b]);
      worst[b] = std::max(worst[b], R_error[i] + std::fabs(drho) * (H_error[i] + B_error) +
                                        4 * kUnitRoundoff * std::fabs(source.back()));
      max_rho[b] = std::max(max_rho[b], rho.back());
    }
  }
  const PatchRadiosity found = patch_radiosity(after.enclosure.form_factors, source, rho, bands);
  for (std::size_t k = 0; k < found.B.size(); ++k) {
    const std::size_t b = k % bands, i = after.enclosure.present[k / bands] * bands + b;
    change.dB[i] = found.B[k];
    change.dB_error[i] = found.B_error[k] + worst[b] / (1 - max_rho[b]) * (1 + 1e-12);
  }
  return change;
}

/// R of George, Sillion and Greenberg 1990, eq. 5, with ρ_i as the equation needs it, and ΔB, the solution of eq. 6.
void answer_dynamic(const nlohmann::json& question, double tolerance, Json& result) {
  for (const char* side : {"before", "after"}) {
    if (!question.contains(side)) throw InvalidCase(std::string("the key \"") + side + "\" is missing");
  }
  CasePatches given_before = read_patches(question["before"], "before", true);
  CasePatches given_after = read_patches(question["after"], "after", true);
  if (!given_before.bands_in_lists) given_before.repeat_for(given_after.bands);
  if (!given_after.bands_in_lists) given_after.repeat_for(given_before.bands);
  if (given_before.patches.size() != given_after.patches.size()) {
    throw InvalidCase("after.patches: must list the same patches as before.patches, in the same order");
  }
  if (given_before.bands != given_after.bands) throw InvalidCase("after.patches: must have as many bands as before");
  const std::size_t bands = given_before.bands;
  const SolvedEnclosure before = solve(given_before, "before.", tolerance);
  const SolvedEnclosure after = solve(given_after, "after.", tolerance);

  const std::size_t size = before.values.B.size();
  std::vector<double> R(size), R_error(size);
  add_irradiance(before, -1, before.values.B, bands, R, R_error);
  add_irradiance(after, 1, before.values.B, bands, R, R_error);
  add_uncertain_source(before, after, bands, R_error);
  for (std::size_t i = 0; i < size; ++i) {
    const double rho = given_after.patches[i / bands].rho[i % bands];
    R[i] *= rho;
    R_error[i] *= rho;
  }
  const Change change = solve_change(before, after, given_before, given_after, R, R_error);
  CasePatches shape = given_before;
  shape.bands_in_lists = given_before.bands_in_lists || given_after.bands_in_lists;
  result["R"] = by_patch(R, shape);
  result["R_error"] = by_patch(R_error, shape);
  result["dB"] = by_patch(change.dB, shape);
  result["dB_error"] = by_patch(change.dB_error, shape);
  result["B_before"] = by_patch(before.values.B, shape);
  result["B_after"] = by_patch(after.values.B, shape);
  result["reached"] = before.enclosure.form_factors.reached && after.enclosure.form_factors.reached;
}

/// JSON has no word for what overflowed.
void refuse_non_finite(const Json& value, const std::string& key) {
  if (value.is_number_float() && !std::isfinite(value.get<double>()))
    throw InvalidCase(key + ": a result is out of the range of a double; scale the numbers of the question");
  if (value.is_array()) std::ranges::for_each(value, [&](const Json& item) { refuse_non_finite(item, key); });
}

void answer_kind(const nlohmann::json& question, double tolerance, Json& result) {
  if (!question.is_object()) throw InvalidCase("a case must be an object");
  if (!question.contains("kind")) throw InvalidCase("the key \"kind\" is missing");
  if (!question["kind"].is_string()) throw InvalidCase("kind: must be a string");
  const auto kind = question["kind"].get<std::string>();
  if (kind == "point_polygon") return answer_point_polygon(question, tolerance, result);
  if (kind == "polygon_polygon") return answer_polygon_polygon(question, tolerance, result);
  if (kind == "enclosure") return answer_enclosure(question, tolerance, result);
  if (kind == "radiosity") return answer_radiosity(question, tolerance, result);
  if (kind == "dynamic") return answer_dynamic(question, tolerance, result);
  throw InvalidCase("kind: \"" + kind +
                    "\" is not known; there are point_polygon, polygon_polygon, enclosure, radiosity and dynamic");
}

}  // namespace

Json answer_to(const nlohmann::json& question, double tolerance) {
  Json result = Json::object();
  try {
    answer_kind(question, tolerance, result);
  } catch (const std::invalid_argument& refused) {  // by the library (point_question.h)
    throw InvalidCase(refused.what());
  }
  for (const auto& [key, value] : result.items()) refuse_non_finite(value, key);
  return result;
}

Json answer_case(const nlohmann::json& question, double tolerance) {
  const Json id = question.is_object() && question.contains("id") ? Json(question["id"]) : Json(nullptr);
  try {
    Json answered{{"id", id}, {"status", "ok"}};
    answered.update(answer_to(question, tolerance));
    return answered;
  } catch (const std::exception& wrong) {
    return {{"id", id}, {"status", "error"}, {"message", wrong.what()}};
  }
}

}  // namespace exitance
