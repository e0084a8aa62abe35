#pragma once
// Frames of a dynamic scene: how they are followed, what is told of them, the picture and the VTP file of one.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>

#include "src/output/faces.h"
#include "src/output/image.h"
#include "src/scene/scene_file.h"
#include "src/scene/trespass.h"
#include "src/solve/convergence_error.h"

namespace exitance {

struct FrameList {
  nlohmann::ordered_json frames = nlohmann::ordered_json::array();  ///< as frames.json
  std::string summary;                                              ///< a line a frame
};

/// How frames are followed, by whatever method.
struct FrameOptions {
  std::string path;                                ///< of the scene file, for warnings
  std::optional<double> budget;                    ///< [s] after which the work on a frame ends, but for frame 0
  bool work_off = false;                           ///< whether one more frame works off what was left
  bool references = true;                          ///< whether errors are found
  bool images = true;                              ///< whether pictures and VTP files are written
  std::uint32_t image_size = 800;                  ///< of the pictures, in pixels
  std::function<bool()> stop;                      ///< asked between frames and within them, by any thread
  std::function<void(const FrameList&)> finished;  ///< told after each frame what there is so far
};

struct Frame {
  std::size_t number = 0;
  double time = 0;
  const Faces& faces;
  std::uint32_t bands = 1;
  std::span<const double> B;  ///< by element and band
};

/// Warns of objects that pass through others or have left the scene (find_trespass). lines: of the scene file, by
/// object.
void warn_of_trespass(const std::string& path, const std::map<std::uint32_t, std::uint32_t>& lines,
                      const EditedScene& scene, const PolygonSoup& soup, std::span<const FacetRange> facets);

/// "error 0.01  of the 1 % 0.2", for a summary; a dash where there is none: no reference, or one that is dark
/// throughout.
std::string in_words(const std::optional<ConvergenceError>& error);

/// Writes frame_NNN.png, as `picture` draws it by the scene's camera path, its camera or one that shows all of it, and
/// frame_NNN.vtp with B. Throws what write_png and write_vtp throw.
void write_frame(const std::filesystem::path& folder, const DynamicScene& scene, const Frame& frame,
                 const std::function<Image(const Camera&)>& picture);

}  // namespace exitance
