#pragma once
// A scene: polygons with materials.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "geometry/polygon.h"

namespace exitance {

/// Diffuse material; one number a band (three: linear RGB).
struct Material {
  std::string name;
  std::vector<double> rho;  ///< reflectance, each in [0, 1)
  std::vector<double> E;    ///< self-emitted exitance [W/m²], each ≥ 0
  std::string file = {};    ///< where it is defined; empty when in no file
  std::uint32_t line = 0;   ///< and in which line; 0 when unknown
};

/// The group of a surface that stands for itself.
inline constexpr std::uint32_t kNoGroup = 0xffffffffu;

/// One input polygon: the unit that occludes. Its front is where its outer loop runs counter-clockwise.
struct Surface {
  Polygon polygon = {};
  std::uint32_t material = 0;
  std::uint32_t object = 0;
  bool obstruction_only = false;  ///< a pure occluder: hides, but neither emits nor receives
  std::uint32_t line = 0;         ///< where it stands in its object's file; 0 when unknown
  /// Surfaces of one group share a row and a column of the form-factor matrix (View3D's combined surfaces, the pieces
  /// of one that others were cut out of). Nothing else depends on it.
  std::uint32_t group = kNoGroup;
};

struct SceneObject {
  std::string name;
  std::string file;  ///< empty when it comes from no file
};

/// How a scene file wants its surfaces cut (MeshOptions), where nobody says otherwise.
struct MeshDefaults {
  double patch_size = 0;                ///< longest edge of a patch [m]; 0: every surface is one patch
  std::uint32_t elements_per_edge = 1;  ///< ≥ 1
  double small_patch = 0;               ///< [m²] patches that are not larger are one element each
};

struct Camera {
  Vec3 eye, target, up{0, 0, 1};
  double vertical_fov_degrees = 40;
};

struct Scene {
  std::string name;
  std::uint32_t bands = 3;
  std::string unit = "W/m^2";
  std::vector<Material> materials;
  std::vector<SceneObject> objects;
  std::vector<Surface> surfaces;  ///< in file order
  std::vector<Surface> absent;    ///< of objects that are not there at first (edit.h): no part of the scene
  MeshDefaults mesh;
  std::optional<Camera> camera;
  std::vector<std::string> warnings;  ///< what was noticed while reading and does not stop the work
};

}  // namespace exitance
