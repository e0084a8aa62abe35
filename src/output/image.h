#pragma once
// A picture of the elements, as a camera sees them.

#include <cstdint>
#include <filesystem>
#include <span>

#include "src/output/faces.h"
#include "src/output/shading.h"
#include "src/scene/scene.h"

namespace exitance {

struct ImageOptions {
  std::uint32_t width = 800, height = 800;  ///< pixels, ≥ 1
  Shading shading = Shading::smooth;
};

/// 8-bit sRGB, row by row from the top left.
struct Image {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  ///< width × height × 3
};

/// Perspective view. Only fronts show: a wall seen from behind is looked through, as into a doll's house, and so is the
/// inside of a solid. Exposure is set by the pixels of whatever does not emit; light sources come out white
/// (tone_map.h), and what shows nothing black. Smooth shading is bilinear in quadrilaterals and linear in triangles.
/// Rays are cast in float around the middle of the scene: it is a picture, nothing is measured with them. The same bits
/// for any number of threads. Throws std::invalid_argument for a camera that looks nowhere (eye at target, up along the
/// view, angle outside (0, 180)) or a picture without pixels.
Image render(const Faces& faces, const Appearance& appearance, const Camera& camera, const ImageOptions& options = {});

/// As PNG. Throws InputError when the file cannot be written.
void write_png(const std::filesystem::path& path, const Image& image);

/// A view of everything for a scene that brings no camera, z up. A closed scene is seen from inside, near one of its
/// upright edges, any other from outside, a little from above.
Camera default_camera(std::span<const Vec3> points, bool closed);

}  // namespace exitance
