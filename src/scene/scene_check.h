#pragma once
// What is wrong, or worth knowing, about a scene before it is solved.

#include <string>
#include <string_view>
#include <vector>

#include "src/scene/scene.h"

namespace exitance {

enum class FindingKind {
  non_finite,         ///< a coordinate is NaN or infinite
  bad_extent,         ///< a coordinate, the scene or an area too large or too small to compute with (scene_extent.h)
  zero_area,          ///< all vertices of a face on one line
  self_intersecting,  ///< the boundary of a face crosses or touches itself
  non_planar,   ///< a face bent by more than rounding of its coordinates explains; `amount` is the worst deviation [m]
  reflectance,  ///< rho outside [0, 1), or E negative, too small or too large; counts materials
  no_patch,     ///< no face has an area and is more than an obstruction
  no_emitter,   ///< nothing emits
  duplicate_face,     ///< a face that is there already, facing the same way; `amount` is their area [m²]
  non_manifold_edge,  ///< an edge of one object used by more than two faces, or twice in the same direction
  open_edge,          ///< an edge that no other cancels and that ends on no surface; `amount` is their length [m]
  boundary_ring,  ///< a ring that bounds the mesh of an object with open edges (boundary_rings.h); `amount` likewise
  contact_edge,   ///< an edge that no other cancels, but that ends on a surface; `amount` likewise
  overlap_same_facing,  ///< two faces in one plane (but for rounding: level.h), one lying on the other, no duplicates;
                        ///< `amount` is the area in common [m²]
  overlap_against,      ///< two faces in one plane in contact, front to front or back to back; `amount` likewise
  inside_out,           ///< a closed piece of surface that seems to face the wrong way; `amount` is its area [m²]
  single_sheet,         ///< an open piece of surface within the scene, dark from behind; `amount` likewise
};

/// The kind's name as it stands above, e.g. "zero_area".
std::string_view name_of(FindingKind kind);

enum class Severity {
  note,     ///< legal, and worth knowing
  warning,  ///< legal, and probably not what was meant
  error     ///< cannot be solved
};

std::string_view name_of(Severity severity);

/// Where a finding was made: a surface, or a material (for `reflectance`).
struct FindingPlace {
  std::uint32_t surface = 0;  ///< index in the scene; of a material its index
  std::string object;         ///< name of the object, or of the material
  std::string file;           ///< empty when it comes from no file
  std::uint32_t line = 0;     ///< 0 when unknown
};

struct Finding {
  FindingKind kind{};
  Severity severity{};
  std::size_t count = 0;
  double amount = 0;
  std::string_view unit;             ///< of amount; empty when there is none
  std::vector<FindingPlace> places;  ///< the first few
  std::string_view what;             ///< in words, for a reader
  std::string_view hint;             ///< how to mend it, or what follows from it
};

struct SceneReport {
  /// Front and back sides fill what every receiver sees: see is_closed.
  bool closed = false;
  /// Every edge is cancelled by others or ends on a surface.
  bool watertight = false;
  std::size_t pieces = 0;         ///< connected pieces of surface
  std::vector<Finding> findings;  ///< in the order of the kinds, one a kind at most
};

/// Looks at everything listed in FindingKind. Faces that are not finite or cross themselves are left out of what comes
/// after. Takes seconds for 60,000 polygons.
SceneReport check_scene(const Scene& scene);

/// Whether the surfaces bound a volume that the patches face, so that no light escapes: there is a closed piece of
/// surface whose fronts look in (a room), and every other piece with patches is such a room too or lies within one.
/// Edges must cancel (T-junctions allowed) or end on the surface of another piece (contact: a box without a bottom on a
/// floor), but for the rounding of turned scenes (level.h). What stands within a room may be open: it lets nothing out.
/// Takes a second or so for 60,000 polygons. REQUIRES: polygons without defects but zero area, as read_scene returns
/// them.
bool is_closed(const Scene& scene);

}  // namespace exitance
