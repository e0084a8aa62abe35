#pragma once
// How elements look: their exitance as linear RGB, constant or smooth.

#include <cstdint>
#include <span>
#include <vector>

#include "src/output/faces.h"
#include "src/output/tone_map.h"

namespace exitance {

enum class Shading : std::uint8_t {
  constant,  ///< each element in its own colour
  smooth     ///< interpolated between the means over the elements of a surface that meet in a point
};

/// What is known of the elements.
struct Appearance {
  std::uint32_t bands = 3;
  std::span<const double> B;              ///< elements × bands
  std::span<const std::uint8_t> emits;    ///< not 0 for a light source, which does not set the exposure; may be empty
  std::span<const std::uint8_t> covered;  ///< not 0 for an element in contact, left out of means; may be empty
};

/// Linear RGB of every element.
std::vector<Rgb> element_colours(const Appearance& appearance);

/// Linear RGB of every point, smooth.
std::vector<Rgb> point_colours(const Faces& faces, const Appearance& appearance);

}  // namespace exitance
