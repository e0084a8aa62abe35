#include "src/dynamic/picture.h"

#include "src/output/mesh_faces.h"

namespace exitance {

Faces faces_of(const SceneVersion& version) {
  return faces_of(version.mesh(), version.soup());
}

Image picture(const DynamicRadiosity& state, std::span<const double> B, const Camera& camera,
              const ImageOptions& options) {
  const SceneVersion& version = state.version();
  const Discretisation d = state.discretisation();
  std::vector<std::uint8_t> emits(version.elements());
  for (std::uint32_t e = 0; e < emits.size(); ++e) {
    for (std::uint32_t b = 0; b < d.bands; ++b)
      emits[e] = emits[e] != 0 || d.E[std::size_t{version.mesh().elements[e].patch} * d.bands + b] > 0;
  }
  return render(faces_of(version), {d.bands, B, emits, {}}, camera, options);
}

}  // namespace exitance
