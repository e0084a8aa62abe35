#pragma once
// How a solution of a version of a scene looks.

#include <span>

#include "src/dynamic/dynamic_radiosity.h"
#include "src/output/faces.h"
#include "src/output/image.h"

namespace exitance {

/// Faces of the elements that are there.
Faces faces_of(const SceneVersion& version);

/// B: by element and band, as element_B() of the state or a reference of it.
Image picture(const DynamicRadiosity& state, std::span<const double> B, const Camera& camera,
              const ImageOptions& options = {});

}  // namespace exitance
