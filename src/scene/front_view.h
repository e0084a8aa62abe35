#pragma once
// Scenes in which nothing but fronts can be seen.

#include "src/scene/scene.h"

namespace exitance {

/// Whether patches see fronts of patches only, wherever they look from: the scene is closed (is_closed), every
/// connected piece of its surface is by itself, rooms look in and solids within them look out, no two surfaces share
/// area of a plane (but for rounding, too), and none only obstructs. Rows of form factors then sum to 1. Surfaces that
/// pierce each other are not noticed. REQUIRES: polygons without defects but zero area, as read_scene returns them.
bool sees_only_fronts(const Scene& scene);

}  // namespace exitance
