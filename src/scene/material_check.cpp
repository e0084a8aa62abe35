#include "src/scene/material_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "src/scene/input_error.h"

namespace exitance {
namespace {

constexpr double kDefaultReflectance = 0.5;

std::string place(const Material& m) {
  return m.line > 0 ? fmt::format("{}:{}: ", m.file, m.line) : m.file.empty() ? "" : m.file + ": ";
}

void drop_unused(Scene& scene) {
  std::vector<std::uint32_t> uses(scene.materials.size(), 0);
  for (const Surface& s : scene.surfaces) ++uses[s.material];
  for (const Surface& s : scene.absent) ++uses[s.material];
  std::vector<std::uint32_t> renumbered(scene.materials.size(), 0);
  std::vector<Material> kept;
  for (std::size_t i = 0; i < uses.size(); ++i) {
    renumbered[i] = static_cast<std::uint32_t>(kept.size());
    if (uses[i] > 0) kept.push_back(std::move(scene.materials[i]));
  }
  scene.materials = std::move(kept);
  for (Surface& s : scene.surfaces) s.material = renumbered[s.material];
  for (Surface& s : scene.absent) s.material = renumbered[s.material];
}

void define(Material& m, std::vector<std::string>& warnings) {
  if (m.rho.empty()) {
    const std::string what =
        m.name.empty() ? "faces without a material" : fmt::format("material '{}' has no reflectance:", m.name);
    warnings.push_back(
        fmt::format("{}{} get rho {} and emit nothing unless it says so", place(m), what, kDefaultReflectance));
    if (m.name.empty()) m.name = "default";
    m.rho = {kDefaultReflectance};
  }
  if (m.E.empty()) m.E = {0};
}

void refuse_out_of_range(const Material& m) {
  for (const double rho : m.rho) {
    if (rho >= 0 && rho < 1) continue;
    throw InputError(
        m.file, m.line,
        fmt::format("material '{}' has reflectance {}, which must be at least 0 and below 1; lower it", m.name, rho));
  }
  for (const double E : m.E) {
    if (is_emission(E)) continue;
    throw InputError(m.file, m.line,
                     fmt::format("material '{}' has emission {}, which must be 0 or from {:.0e} to {:.0e}; correct it",
                                 m.name, E, kSmallestEmission, kLargestEmission));
  }
}

void broadcast(std::vector<double>& values, std::uint32_t bands, const Material& m) {
  if (values.size() == 1) values.resize(bands, values[0]);
  if (values.size() == bands) return;
  throw InputError(
      m.file, m.line,
      fmt::format("material '{}' has {} bands where others have {}; give all of them one number or the same "
                  "number of bands",
                  m.name, values.size(), bands));
}

}  // namespace

bool is_emission(double E) {
  return E == 0 || (E >= kSmallestEmission && E <= kLargestEmission);
}

double to_exitance(double emission, Emission meaning) {
  return meaning == Emission::radiance ? std::numbers::pi * emission : emission;
}

void settle_materials(Scene& scene, std::uint32_t bands, bool keep_faults) {
  drop_unused(scene);
  std::size_t longest = bands;
  for (Material& m : scene.materials) {
    define(m, scene.warnings);
    if (!keep_faults) refuse_out_of_range(m);
    longest = std::max({longest, m.rho.size(), m.E.size()});
  }
  scene.bands = static_cast<std::uint32_t>(longest);
  for (Material& m : scene.materials) {
    broadcast(m.rho, scene.bands, m);
    broadcast(m.E, scene.bands, m);
  }
}

}  // namespace exitance
