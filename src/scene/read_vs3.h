#pragma once
// View3D's input files (.vs3), the three-dimensional vertex and surface format (F 3).
//
//   T  title                            everything after the first letter of a line's first word is ignored: "End" is E
//   C  encl=1 emit=0 eps=1e-4           controls of View3D's integration, which mean nothing here
//   F  3                                this unless said otherwise
//   V  1   0. 0. 0.                     vertices, numbered from 1 on
//   S  1   1 2 3 4   0 0   0.5  floor   surfaces: number, vertices (the fourth 0 in a triangle), base, combined with,
//   O  2   1 2 3 0                      emissivity, name; numbered likewise. O: only obstructs
//   N  3   4 3 2 1   1 0   0.5  hidden  null surface: what it hides of its base is no surface any more
//   E                                   the end; or *, or the end of the file
//
// Words are separated by blanks and commas; "!" or "/" begins a comment.

#include <filesystem>

#include "src/scene/scene.h"

namespace exitance {

/// One band, E = 0, rho = 1 − emissivity; every surface is an object of its name ("surface 7" without one), in file
/// order.
///  - A surface with a base is cut out of it (cut_out.h), as View3D takes the area and the exchange of a subsurface
///  from
///    those of its base. What remains of a base may be several surfaces, which make a group. The base may be an
///    obstruction.
///  - A surface that is combined with another is in its group.
///  - A null surface is cut out of its base likewise and only obstructs.
/// Throws InputError for other formats (F 3a, F 2), masking surfaces (M), transformations (X) and unknown lines;
/// numbers that are malformed, missing or out of sequence, vertices that do not exist; surfaces without area, that
/// cross themselves, or have an emissivity outside (0, 1] (unless keep_faults); a base or a surface to combine with
/// that does not exist, is of the wrong kind or comes later; subsurfaces that lie outside their base, overlap, touch
/// its boundary with a corner only, face the wrong way or leave nothing of it.
Scene read_vs3(const std::filesystem::path& path, bool keep_faults);

}  // namespace exitance
