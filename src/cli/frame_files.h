#pragma once
// Frames of a dynamic scene: what is told of them, the picture and the VTP file of one.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "src/output/faces.h"
#include "src/output/image.h"
#include "src/scene/scene_file.h"

namespace exitance {

struct FrameList {
  nlohmann::ordered_json frames = nlohmann::ordered_json::array();  ///< as frames.json
  std::string summary;                                              ///< a line a frame
};

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
