#pragma once
// Materials as a scene needs them: defined, within range, with the same number of bands.

#include "src/scene/scene.h"

namespace exitance {

/// How a file's emission (MTL Ke, TOML E) is meant.
enum class Emission {
  exitance,  ///< E, all that leaves a square metre [W/m²]
  radiance   ///< L [W/(m² sr)]: E = π L for a diffuse emitter
};

/// Emissions other than 0 that can be computed with [W/m²]: no radiosity and no power overflows or loses its digits.
inline constexpr double kSmallestEmission = 1e-250, kLargestEmission = 1e100;

bool is_emission(double E);

double to_exitance(double emission, Emission meaning);

/// Drops materials that no surface uses, present or absent; gives those without rho 0.5 and those without E 0, each time with a warning
/// where that was not said on purpose; sets scene.bands to the longest list of any material (at least `bands`) and
/// repeats single numbers for all bands. Throws InputError for rho outside [0, 1) and E that is_emission does not hold
/// for (unless keep_faults), and for lists of different lengths.
void settle_materials(Scene& scene, std::uint32_t bands, bool keep_faults);

}  // namespace exitance
