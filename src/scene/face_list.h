#pragma once
// What a mesh file says, before it is judged: vertices, and faces as loops of vertex numbers. All mesh readers end
// here, so that one place decides what a face may be.

#include <cstdint>
#include <string>
#include <vector>

#include "geometry/vec3.h"
#include "src/scene/scene.h"

namespace exitance {

struct Face {
  std::size_t first = 0, count = 0;  ///< its corners
  std::uint32_t material = 0;
  std::uint32_t object = 0;
  std::uint32_t line = 0;  ///< 0 in binary files
};

struct FaceList {
  std::string file;
  std::vector<Vec3> vertices;
  std::vector<std::uint32_t> vertex_lines;  ///< one for each vertex, or empty (binary files)
  std::vector<std::int64_t> corners;        ///< numbers of vertices from 0; not yet checked
  std::vector<Face> faces;
  int numbering_from = 0;            ///< how the file counts vertices, for messages
  std::vector<std::string> objects;  ///< names; empty: one, named after the file
  /// A material without rho is one that the file names or implies but does not define. Empty: one such, without a name.
  std::vector<Material> materials;
  std::vector<std::string> warnings;
};

/// The faces as surfaces of a scene, in file order. Throws InputError for a file without faces, a vertex that is not
/// finite (unless keep_faults), a face with fewer than three vertices and a vertex number out of range.
Scene to_scene(FaceList list, bool keep_faults);

}  // namespace exitance
