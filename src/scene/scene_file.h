#pragma once
// Scene files (TOML): objects put together from meshes, polygons and boxes.
//
//   name = "Cornell box"            # optional; the file's name otherwise
//   unit = "W/m^2"                  # of E and of all results; or "lm/m^2"
//
//   [camera]                        # optional
//   eye = [x, y, z]
//   target = [x, y, z]
//   up = [0, 0, 1]                  # this unless said otherwise
//   vertical_fov = 40               # degrees, likewise
//
//   [mesh]                          # optional: how surfaces are cut unless options say otherwise
//   patch_size = 0.3                # longest edge of a patch [m]; 0: surfaces as they are
//   elements = 2                    # along the edge of a patch
//   small_patch = 0.02              # patches of this area [m²] or less are one element each
//
//   [links]                         # optional, likewise: how hierarchical links are refined
//   patch_size = 0                  # longest edge of what is one quadtree [m]; that of [mesh] unless given
//   smallest_area = 0.01            # of a sub-patch [m²]
//   eps2 = 0.005                    # shares of the brightest E: refined while B F is above this,
//   eps1 = 0.0025                   # un-refined below this,
//   B_eps = 0.0001                  # left as it is by progressive updates where it could not change by more
//
//   [[material]]
//   name = "white"
//   rho = 0.7                       # or one number a band: [0.7, 0.7, 0.6]
//   E = 0                           # likewise; 0 unless said otherwise
//   emission = "exitance"           # how E is meant: "exitance" or "radiance" (then E times pi is emitted)
//
//   [[object]]                      # of exactly one of these forms
//   name = "table"                  # optional
//   mesh = "table.obj"              # relative to this file; .obj, .ply, .off or .stl
//   polygons = [ [[x,y,z], …], {polygon = [[x,y,z], …], holes = [[[x,y,z], …]], material = "white"} ]
//   box = {min = [x,y,z], max = [x,y,z]}          # six faces that look outward; flip = true makes a room of it
//   furnished-room = {polygons = 500, seed = 1}   # a room made by rules, see furnished_room.h
//
//   material = "white"              # for all its faces, whatever the mesh says
//   materials = {wood = "white"}    # or for those of some of the mesh's materials
//   max_rho = 0.9                   # lowers the reflectances that the mesh itself gives (furniture often says 1)
//   scale = 0.01                    # or [sx, sy, sz]; then
//   rotate = {axis = [0,0,1], degrees = 30}       # about the origin; or a list of these, the first one first; then
//   translate = [x, y, z]
//   flip = true                     # turns every face over; then
//   two_sided = true                # adds every face again, turned over, right after itself
//   obstruction_only = true         # hides, but neither emits nor receives
//   absent = true                   # is not there until an event adds it
//
//   [[event]]                       # what happens to an object; in order of time, one event an object and time
//   time = 1                        # not negative: the scene begins at 0
//   object = "table"
//   operation = "move"              # add, remove, move, reshape, change, select, deselect (edit.h)
//   scale, rotate, translate        # add, move: where it stands, as in [[object]] and from what stands there, about
//   pivot = [x, y, z]               # this point; the origin unless given
//   mesh, polygons or box, …        # reshape: what it becomes, with the keys of [[object]]; made of what it was made
//                                   # of, where these do not say
//   material = "red"                # change: of all its surfaces
//   materials = {wood = "red"}      # change: of those of some materials
//
//   [[camera_path]]                 # where the observer is at some times, evenly moving in between; keys of [camera]
//   time = 0
//
// Every [[object]] is one object of the scene, a furnished room as many as it has. Materials have one number a band;
// numbers are repeated to the length of the lists, so that a scene with numbers only has one band. Keys that are not
// known are errors.

#include <filesystem>
#include <optional>
#include <vector>

#include "src/scene/edit.h"
#include "src/scene/material_check.h"
#include "src/scene/scene.h"

namespace exitance {

/// Reads a scene file and the meshes it names. emission: how E and Ke are meant where the file does not say. Faces of
/// meshes are mended (face_mending.h); polygons written in the file that cross themselves are refused, unless
/// keep_faults. Throws InputError.
Scene read_scene_file(const std::filesystem::path& path, Emission emission, bool keep_faults);

/// How a scene file wants its links refined (src/links/linked_radiosity.h), where nobody says otherwise.
struct LinkDefaults {
  std::optional<double> patch_size;         ///< [m] of what is one quadtree
  std::optional<double> eps2, eps1, B_eps;  ///< shares of the brightest E
  std::optional<double> smallest_area;      ///< [m²]
};

/// A scene and what happens to it.
struct DynamicScene {
  Scene scene;
  LinkDefaults links;
  std::vector<Event> events;  ///< in order of time
  std::vector<CameraAt> camera_path;
};

/// Reads a scene file with its events, and checks them by applying all of them. Throws InputError, for an event that
/// has no meaning (InvalidEdit) with its line.
DynamicScene read_dynamic_scene(const std::filesystem::path& path, Emission emission);

}  // namespace exitance
