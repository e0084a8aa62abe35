#pragma once
// The picture and the VTP file of one frame of a dynamic scene.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>

#include "src/output/faces.h"
#include "src/output/image.h"
#include "src/scene/scene_file.h"

namespace exitance {

struct Frame {
  std::size_t number = 0;
  double time = 0;
  const Faces& faces;
  std::uint32_t bands = 1;
  std::span<const double> B;  ///< by element and band
};

/// Writes frame_NNN.png, as `picture` draws it by the scene's camera path, its camera or one that shows all of it, and
/// frame_NNN.vtp with B. Throws what write_png and write_vtp throw.
void write_frame(const std::filesystem::path& folder, const DynamicScene& scene, const Frame& frame,
                 const std::function<Image(const Camera&)>& picture);

}  // namespace exitance
