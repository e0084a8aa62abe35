#include "src/scene/scene_check.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "geometry/contact.h"
#include "geometry/level.h"
#include "geometry/spatial_index.h"
#include "geometry/surface_pieces.h"
#include "src/scene/boundary_rings.h"
#include "src/scene/material_check.h"
#include "src/scene/scene_extent.h"

namespace exitance {
namespace {

constexpr std::size_t kPlaces = 5;

struct KindText {
  std::string_view name;
  Severity severity;
  std::string_view unit, what, hint;
};

// In the order of FindingKind.
constexpr std::array<KindText, 17> kTexts{{
    {"non_finite", Severity::error, "", "faces with a coordinate that is not a finite number",
     "correct or remove them"},
    {"bad_extent", Severity::error, "",
     "faces too large or too small to compute with: coordinates may be 1e50 at most, the scene's largest must be 1e-50 "
     "at "
     "least, areas 1e-50 of its square",
     "scale the scene, or remove them"},
    {"zero_area", Severity::note, "", "faces without area", "they make no patch and hide nothing; remove them"},
    {"self_intersecting", Severity::error, "", "faces whose boundary crosses or touches itself",
     "cut them into simple polygons"},
    {"non_planar", Severity::note, "m", "faces that are not planar; the worst deviates by",
     "they are used as the triangles of one diagonal cut; triangulate them to choose another"},
    {"reflectance", Severity::error, "",
     "materials with a reflectance outside [0, 1), or an emission that is neither 0 nor from 1e-250 to 1e100",
     "correct them, or override the material in a scene file"},
    {"no_patch", Severity::error, "",
     "no face has an area and is more than an obstruction, so there is nothing to solve", "add one"},
    {"no_emitter", Severity::warning, "", "nothing emits, so everything stays dark",
     "give a material Ke (MTL) or E (scene file)"},
    {"duplicate_face", Severity::warning, "m^2", "faces that are there twice; their area is",
     "remove one of each: the later one hides the other"},
    {"non_manifold_edge", Severity::note, "",
     "edges used by more than two faces of an object, or twice in the same direction",
     "solids may touch so; otherwise orient neighbouring faces alike and remove inner walls"},
    {"open_edge", Severity::note, "m", "edges that no other face continues; their length is",
     "holes let light escape; close them, or leave the scene open"},
    {"boundary_ring", Severity::note, "m", "rings of edges that bound the mesh of an object; their length is",
     "holes, or the rims of sheets: an object that is meant to be closed lacks faces there"},
    {"contact_edge", Severity::note, "m", "edges that end on the surface of another piece; their length is",
     "the contact closes them; nothing to do"},
    {"overlap_same_facing", Severity::warning, "m^2",
     "pairs of faces that lie on one another, facing the same way, over",
     "the later one in the scene hides the other; raise or cut one if that is not meant"},
    {"overlap_against", Severity::note, "m^2", "pairs of faces in contact, facing against each other, over",
     "they exchange nothing; nothing to do"},
    {"inside_out", Severity::warning, "m^2", "closed pieces of surface that look inside out; their area is",
     "turn them over: --flip, or flip = true in a scene file"},
    {"single_sheet", Severity::note, "m^2", "open pieces of surface, dark from behind; their area is",
     "if both sides can be seen: --two-sided, or two_sided = true in a scene file"},
}};

// Rounding of coordinates moves a vertex of an exactly planar face by a few units in the last place.
constexpr double kRounding = 8 * 2.220446049250313e-16;

// Largest distance of a vertex from the plane through the middle of the outer vertices.
double deviation_from_plane(const Polygon& polygon) {
  const Vec3 normal = normalized(area_vector(polygon));
  Vec3 middle;
  for (const Vec3& p : polygon.outer)
    middle = middle + (1 / static_cast<double>(polygon.outer.size())) * (p - polygon.outer[0]);
  middle = middle + polygon.outer[0];
  double worst = 0;
  const auto look = [&](const std::vector<Vec3>& loop) {
    for (const Vec3& p : loop) worst = std::max(worst, std::fabs(dot(normal, p - middle)));
  };
  look(polygon.outer);
  std::ranges::for_each(polygon.holes, look);
  return worst;
}

auto order(const Vec3& p) {
  return std::tuple{p.x + 0.0, p.y + 0.0, p.z + 0.0};
}

// The loop from its smallest vertex on, so that equal loops compare equal whichever vertex comes first.
std::vector<Vec3> canonical(std::vector<Vec3> loop) {
  const auto smallest = std::ranges::min_element(loop, {}, order);
  std::rotate(loop.begin(), smallest, loop.end());
  return loop;
}

// surface_of: the surface of a polygon.
template <typename SurfaceOf>
bool encloses_all(const SurfacePieces& found, SurfaceOf surface_of) {
  const auto is_room = [](const SurfacePiece& piece) { return piece.volume < 0; };
  // Obstructions have no patches that could look out into the open.
  const auto only_obstructs = [&](std::uint32_t polygon) { return surface_of(polygon).obstruction_only; };
  const auto lets_nothing_out = [&](const SurfacePiece& piece) {
    return is_room(piece) || piece.enclosed || piece.area == 0 || std::ranges::all_of(piece.polygons, only_obstructs);
  };
  return std::ranges::any_of(found.pieces, is_room) && std::ranges::all_of(found.pieces, lets_nothing_out);
}

class SceneChecker {
 public:
  explicit SceneChecker(const Scene& scene) : scene_(scene) {}

  SceneReport check() {
    check_faces();
    check_materials();
    check_duplicates();
    check_edges_of_objects();
    check_overlaps();
    check_pieces();
    check_boundary_rings();
    for (auto& [kind, finding] : findings_) report_.findings.push_back(std::move(finding));
    return std::move(report_);
  }

 private:
  Finding& finding(FindingKind kind) {
    const KindText& text = kTexts[static_cast<std::size_t>(kind)];
    const auto [found, is_new] = findings_.try_emplace(kind);
    if (is_new) {
      found->second.kind = kind;
      found->second.severity = text.severity;
      found->second.unit = text.unit;
      found->second.what = text.what;
      found->second.hint = text.hint;
    }
    return found->second;
  }

  void add(FindingKind kind, std::uint32_t surface, double amount = 0) {
    Finding& found = finding(kind);
    ++found.count;
    found.amount += amount;
    if (found.places.size() == kPlaces) return;
    const Surface& s = scene_.surfaces[surface];
    const SceneObject& object = scene_.objects[s.object];
    found.places.push_back({surface, object.name, object.file, s.line});
  }

  // Sorts out the faces that the geometry can work with.
  void check_faces() {
    const double scene_extent = extent(scene_);
    for (std::uint32_t i = 0; i < scene_.surfaces.size(); ++i) {
      const Polygon& polygon = scene_.surfaces[i].polygon;
      const PolygonDefect defect = find_defect(polygon);
      if (defect == PolygonDefect::non_finite) add(FindingKind::non_finite, i);
      if (defect == PolygonDefect::self_intersecting) add(FindingKind::self_intersecting, i);
      if (defect == PolygonDefect::zero_area || defect == PolygonDefect::too_few_vertices)
        add(FindingKind::zero_area, i);
      if (defect != PolygonDefect::none && defect != PolygonDefect::zero_area) continue;
      if (!find_bad_extent(polygon, scene_extent).empty()) {
        add(FindingKind::bad_extent, i);
        continue;
      }
      any_patch_ = any_patch_ || (defect == PolygonDefect::none && !scene_.surfaces[i].obstruction_only);
      surface_of_.push_back(i);
      polygons_.push_back(polygon);
      near_ = std::max(near_, kLevel * extent(polygon));
      if (defect == PolygonDefect::none) check_planarity(i);
    }
  }

  void check_planarity(std::uint32_t i) {
    const Polygon& polygon = scene_.surfaces[i].polygon;
    const double deviation = deviation_from_plane(polygon);
    if (!(deviation > kRounding * extent(polygon))) return;
    const auto found = findings_.find(FindingKind::non_planar);
    const double worst = std::max(deviation, found == findings_.end() ? 0 : found->second.amount);
    add(FindingKind::non_planar, i);
    finding(FindingKind::non_planar).amount = worst;
  }

  void check_materials() {
    const auto in_range = [](const Material& m) {
      return std::ranges::all_of(m.rho, [](double rho) { return rho >= 0 && rho < 1; }) &&
             std::ranges::all_of(m.E, is_emission);
    };
    for (std::uint32_t i = 0; i < scene_.materials.size(); ++i) {
      const Material& m = scene_.materials[i];
      if (in_range(m)) continue;
      Finding& found = finding(FindingKind::reflectance);
      ++found.count;
      if (found.places.size() < kPlaces) found.places.push_back({i, m.name, m.file, m.line});
    }
    emits_ = std::ranges::any_of(scene_.surfaces, [&](const Surface& s) {
      return !s.obstruction_only && std::ranges::any_of(scene_.materials[s.material].E, [](double E) { return E > 0; });
    });
    if (!emits_) finding(FindingKind::no_emitter).count = 1;
    if (!any_patch_) finding(FindingKind::no_patch).count = 1;
  }

  void check_duplicates() {
    const auto compare = [](const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
      return std::ranges::lexicographical_compare(a, b, {}, order, order);
    };
    using Loops = std::vector<std::vector<Vec3>>;  // the outer one first
    const auto compare_all = [&](const Loops& a, const Loops& b) {
      return std::ranges::lexicographical_compare(a, b, compare);
    };
    std::set<Loops, decltype(compare_all)> seen(compare_all);
    for (std::uint32_t i = 0; i < polygons_.size(); ++i) {
      Loops loops{canonical(polygons_[i].outer)};
      for (const std::vector<Vec3>& hole : polygons_[i].holes) loops.push_back(canonical(hole));
      std::sort(loops.begin() + 1, loops.end(), compare);
      if (seen.insert(std::move(loops)).second) {
        distinct_.push_back(i);
      } else {
        add(FindingKind::duplicate_face, surface_of_[i], norm(area_vector(polygons_[i])));
      }
    }
  }

  void check_edges_of_objects() {
    struct Use {
      std::uint32_t object, surface;
      Vec3 low, high;
      bool up;
      auto key() const { return std::tuple{object, order(low), order(high)}; }
    };
    std::vector<Use> uses;
    for (const DirectedEdge& e : directed_edges(polygons_)) {
      const std::uint32_t surface = surface_of_[e.polygon];
      const bool up = order(e.from) < order(e.to);
      uses.push_back({scene_.surfaces[surface].object, surface, up ? e.from : e.to, up ? e.to : e.from, up});
    }
    std::ranges::stable_sort(uses, {}, &Use::key);
    bool unbalanced = false;
    for (std::size_t first = 0; first < uses.size();) {
      std::size_t last = first + 1;
      while (last < uses.size() && uses[last].key() == uses[first].key()) ++last;
      const auto up = static_cast<std::size_t>(std::count_if(uses.begin() + static_cast<std::ptrdiff_t>(first),
                                                             uses.begin() + static_cast<std::ptrdiff_t>(last),
                                                             [](const Use& use) { return use.up; }));
      const bool balanced = 2 * up == last - first;
      if (last - first > 2 || (last - first == 2 && !balanced)) {
        add(FindingKind::non_manifold_edge, uses[first].surface);
        unbalanced = unbalanced || !balanced;
      }
      first = last;
    }
    // Solids that touch along an edge, and sheets of two sides, are legal.
    if (unbalanced) finding(FindingKind::non_manifold_edge).severity = Severity::warning;
  }

  // Of what is there more than once, one: the others are told of as duplicates.
  void check_overlaps() {
    std::vector<Polygon> polygons;
    for (const std::uint32_t i : distinct_) polygons.push_back(polygons_[i]);
    for (const CoplanarOverlap& overlap : coplanar_overlaps(polygons, near_)) {
      const auto kind = overlap.same_facing ? FindingKind::overlap_same_facing : FindingKind::overlap_against;
      add(kind, surface_of_[distinct_[overlap.b]], overlap.area);
    }
  }

  void check_pieces() {
    const SurfacePieces found = find_surface_pieces(polygons_, near_);
    report_.pieces = found.pieces.size();
    report_.watertight = !found.pieces.empty();
    for (const auto& [edge, in_contact] : found.open_edges) {
      report_.watertight = report_.watertight && in_contact;
      if (!in_contact) open_objects_.insert(scene_.surfaces[surface_of_[edge.polygon]].object);
      add(in_contact ? FindingKind::contact_edge : FindingKind::open_edge, surface_of_[edge.polygon],
          norm(edge.to - edge.from));
    }
    Box all;
    for (const Polygon& polygon : polygons_) extend(all, polygon);
    for (const SurfacePiece& piece : found.pieces) {
      if (seems_inside_out(piece, emits_ && found.pieces.size() == 1)) {
        add(FindingKind::inside_out, surface_of_[piece.polygons.front()], piece.area);
      }
      if (!piece.closed && piece.area > 0 && !spans(piece, all)) {
        add(FindingKind::single_sheet, surface_of_[piece.polygons.front()], piece.area);
      }
    }
    report_.closed = encloses_all(
        found, [&](std::uint32_t polygon) -> const Surface& { return scene_.surfaces[surface_of_[polygon]]; });
  }

  /// Of objects with open edges: what others close at a T-junction or by contact is no boundary.
  void check_boundary_rings() {
    std::vector<std::uint32_t> object;
    for (const std::uint32_t surface : surface_of_) object.push_back(scene_.surfaces[surface].object);
    for (const BoundaryRing& ring : find_boundary_rings(polygons_, object)) {
      const std::uint32_t surface = surface_of_[ring.polygon];
      if (open_objects_.contains(scene_.surfaces[surface].object)) {
        add(FindingKind::boundary_ring, surface, ring.length);
      }
    }
  }

  static void extend(Box& box, const Polygon& polygon) {
    for (const Vec3& p : polygon.outer) box.extend(p);
  }

  // A solid in a room that looks in and holds nothing, or a shell that looks out and holds the rest, or holds nothing
  // but is all that could receive its light.
  static bool seems_inside_out(const SurfacePiece& piece, bool lit_alone) {
    if (piece.volume < 0) return piece.enclosed && !piece.encloses;
    return piece.volume > 0 && !piece.enclosed && (piece.encloses || lit_alone);
  }

  // An open piece as large as the scene is the room itself, of which a wall is missing.
  bool spans(const SurfacePiece& piece, const Box& all) const {
    Box box;
    for (const std::uint32_t polygon : piece.polygons) extend(box, polygons_[polygon]);
    return box.contains(all.lower) && box.contains(all.upper);
  }

  const Scene& scene_;
  bool emits_ = false, any_patch_ = false;
  double near_ = 0;  // what lies no farther apart is in contact [m]
  std::set<std::uint32_t> open_objects_;
  SceneReport report_;
  std::map<FindingKind, Finding> findings_;
  std::vector<Polygon> polygons_;          // those that geometry can work with
  std::vector<std::uint32_t> surface_of_;  // and the surfaces they are of
  std::vector<std::uint32_t> distinct_;    // of them, without those that are there already
};

}  // namespace

std::string_view name_of(FindingKind kind) {
  return kTexts[static_cast<std::size_t>(kind)].name;
}

std::string_view name_of(Severity severity) {
  return severity == Severity::note ? "note" : severity == Severity::warning ? "warning" : "error";
}

SceneReport check_scene(const Scene& scene) {
  return SceneChecker(scene).check();
}

bool is_closed(const Scene& scene) {
  std::vector<Polygon> polygons;
  polygons.reserve(scene.surfaces.size());
  for (const Surface& surface : scene.surfaces) polygons.push_back(surface.polygon);
  return encloses_all(find_surface_pieces(polygons, kLevel * extent(scene)),
                      [&](std::uint32_t polygon) -> const Surface& { return scene.surfaces[polygon]; });
}

}  // namespace exitance
