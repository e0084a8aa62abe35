// How much light gets through closed surfaces? An emitter in a closed shell in a closed room: nothing of it is to reach
// the room, by whatever kind of polygons the shell is made of.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "experiments/csv_table.h"
#include "experiments/experiment_options.h"
#include "experiments/plot_note.h"
#include "src/output/heat_map.h"
#include "src/scene/patch_mesh.h"
#include "src/visibility/exact_visibility.h"
#include "src/visibility/ray_caster.h"
#include "src/visibility/ray_sampled_visibility.h"

namespace exitance {
namespace {

constexpr std::uint32_t kFaces = 6;      // of the room, which come first, and of the emitter, which follow
constexpr std::uint32_t kGrid = 8;       // cells along the edge of a shell's face
constexpr std::uint32_t kSlivers = 200;  // of a face

/// How the shell's faces are cut, and where the scene stands.
struct Kind {
  std::string name;
  enum class Cut { whole, triangles, t_junctions, slivers } cut = Cut::triangles;
  double offset = 0;          ///< of the scene from the origin, along every axis [m]
  bool on_the_floor = false;  ///< the shell has no bottom and stands on the room's floor
};

std::vector<Kind> kinds() {
  return {{"shared edges", Kind::Cut::triangles},    {"T-junctions", Kind::Cut::t_junctions},
          {"slivers", Kind::Cut::slivers},           {"offset 1e3", Kind::Cut::triangles, 1e3},
          {"offset 1e4", Kind::Cut::triangles, 1e4}, {"offset 1e5", Kind::Cut::triangles, 1e5},
          {"offset 1e6", Kind::Cut::triangles, 1e6}, {"contact", Kind::Cut::whole, 0, true}};
}

double offset_of(const std::string& name) {
  const std::vector<Kind> all = kinds();
  return std::ranges::find(all, name, &Kind::name)->offset;
}

/// A rectangle from a corner along two edges; its front is where u × v points.
struct Rectangle {
  Vec3 corner, u, v;
  Vec3 at(double s, double t) const { return corner + s * u + t * v; }
};

/// The faces of a cube around the origin, out or in; the bottom comes last.
std::vector<Rectangle> cube(double half, const Vec3& centre, bool outward) {
  std::vector<Rectangle> faces;
  for (const auto& [axis, sign] : {std::pair{0, 1}, {0, -1}, {1, 1}, {1, -1}, {2, 1}, {2, -1}}) {
    Vec3 n, u, v;
    n[axis] = sign;
    u[(axis + 1) % 3] = 2 * half;
    v[(axis + 2) % 3] = 2 * half * sign;
    if (!outward) std::swap(u, v);
    faces.push_back({centre + half * n - 0.5 * u - 0.5 * v, u, v});
  }
  return faces;
}

using Loops = std::vector<std::vector<Vec3>>;

void cut(const Rectangle& r, Kind::Cut how, Loops& loops) {
  constexpr double n = kGrid;
  switch (how) {
    case Kind::Cut::whole:
      loops.push_back({r.at(0, 0), r.at(1, 0), r.at(1, 1), r.at(0, 1)});
      return;
    case Kind::Cut::triangles:
      for (double i = 0; i < n; ++i) {
        for (double j = 0; j < n; ++j) {
          const Vec3 a = r.at(i / n, j / n), b = r.at((i + 1) / n, j / n), c = r.at((i + 1) / n, (j + 1) / n),
                     d = r.at(i / n, (j + 1) / n);
          loops.push_back({a, b, c});
          loops.push_back({a, c, d});
        }
      }
      return;
    case Kind::Cut::t_junctions:  // every other row has one cell more
      for (double j = 0; j < n; ++j) {
        const double m = n + std::fmod(j, 2);
        for (double i = 0; i < m; ++i) {
          loops.push_back({r.at(i / m, j / n), r.at((i + 1) / m, j / n), r.at((i + 1) / m, (j + 1) / n)});
          loops.push_back({r.at(i / m, j / n), r.at((i + 1) / m, (j + 1) / n), r.at(i / m, (j + 1) / n)});
        }
      }
      return;
    case Kind::Cut::slivers: {  // a fan from one corner to the two sides that it is not on
      constexpr double half = kSlivers / 2;
      for (double k = 0; k < half; ++k) {
        loops.push_back({r.at(0, 0), r.at(1, k / half), r.at(1, (k + 1) / half)});
        loops.push_back({r.at(0, 0), r.at(1 - k / half, 1), r.at(1 - (k + 1) / half, 1)});
      }
      return;
    }
  }
}

/// The scene, turned by angles that no coordinate survives unrounded.
struct Shell {
  explicit Shell(const Kind& kind) {
    scene.name = kind.name;
    scene.bands = 1;
    scene.materials = {{"grey", {0.5}, {0}}, {"emitter", {0}, {1}}};
    scene.objects = {{"scene", ""}};
    Loops room, shell, emitter;
    const Vec3 centre = kind.on_the_floor ? Vec3{0, 0, -1} : Vec3{};
    for (const Rectangle& r : cube(2, {}, false)) cut(r, Kind::Cut::whole, room);
    std::vector<Rectangle> faces = cube(1, centre, true);
    if (kind.on_the_floor) faces.pop_back();
    for (const Rectangle& r : faces) cut(r, kind.cut, shell);
    for (const Rectangle& r : cube(0.5, centre, true)) cut(r, Kind::Cut::whole, emitter);
    const auto add = [&](const Loops& loops, std::uint32_t material) {
      for (const auto& loop : loops) {
        Surface surface;
        for (const Vec3& v : loop) surface.polygon.outer.push_back(placed(v, kind.offset));
        surface.material = material;
        scene.surfaces.push_back(surface);
      }
    };
    add(room, 0);
    add(emitter, 1);
    add(shell, 0);
    for (const auto& loop : shell) {
      for (std::size_t k = 0; k < loop.size(); ++k)
        edges.push_back({placed(loop[k], kind.offset), placed(loop[(k + 1) % loop.size()], kind.offset)});
    }
    middle = placed(centre, kind.offset);
  }

  static Vec3 placed(const Vec3& v, double offset) {
    constexpr double a = 0.4, b = 1.1;
    const Vec3 w{std::cos(a) * v.x - std::sin(a) * v.y, std::sin(a) * v.x + std::cos(a) * v.y, v.z};
    return Vec3{offset, offset, offset} +
           Vec3{w.x, std::cos(b) * w.y - std::sin(b) * w.z, std::sin(b) * w.y + std::cos(b) * w.z};
  }

  Scene scene;
  std::vector<std::array<Vec3, 2>> edges;  ///< of the shell's polygons
  Vec3 middle;                             ///< of the emitter
};

/// What reaches the room's sample points of the emitter, which nothing should.
struct Leak {
  double mean = 0, largest = 0;   ///< form factor to the emitter, over the room's points and at the worst of them
  std::optional<double> closure;  ///< largest |front + back − 1| of those that look around
};

/// rows_every: of so many points one looks around; with 1, all do, and what they see of the emitter is taken from
/// there. Of a shell on the floor the floor's points are left out, since some lie in it.
Leak leak_by(const MeshVisibility& visibility, std::size_t rows_every, bool on_the_floor) {
  const PatchMesh& mesh = visibility.mesh();
  const auto is_of = [&](std::uint32_t patch, std::uint32_t first, std::uint32_t last) {
    return mesh.patches[patch].surface >= first && mesh.patches[patch].surface < last;
  };
  const std::unique_ptr<Observer> observer = visibility.observer();
  Leak leak;
  double points = 0;
  const std::uint32_t faces = on_the_floor ? kFaces - 1 : kFaces;
  for (std::size_t e = 0; e < mesh.elements.size() && is_of(mesh.elements[e].patch, 0, faces); ++e) {
    PointRow row;
    if (rows_every > 0 && e % rows_every == 0) {
      row = observer->row(e);
      leak.closure = std::max(leak.closure.value_or(0), row.statistics.closure_max_defect);
    }
    double sum = 0;
    if (rows_every == 1) {
      for (std::size_t k = 0; k < row.F.size(); ++k) sum += is_of(row.column[k], kFaces, 2 * kFaces) ? row.F[k] : 0;
    } else {
      for (std::uint32_t p = 0; p < mesh.patches.size(); ++p) {
        if (is_of(p, kFaces, 2 * kFaces)) sum += observer->entry(e, p).F;
      }
    }
    leak.mean += sum;
    leak.largest = std::max(leak.largest, sum);
    ++points;
  }
  leak.mean /= points;
  return leak;
}

/// The share of rays, aimed from within the shell at points on its edges, that get out.
double share_through_edges(const Shell& shell, const PolygonSoup& soup, bool robust) {
  constexpr std::size_t kRays = 1 << 18;
  const RayCaster caster(soup, {.robust = robust});
  std::mt19937_64 random(1);
  const auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  std::vector<Vec3> from, to;
  for (std::size_t k = 0; k < kRays; ++k) {
    const auto& [a, b] = shell.edges[random() % shell.edges.size()];
    const Vec3 inside = shell.middle + Vec3{0.4 * unit(), 0.4 * unit(), 0.4 * unit()}, at = a + unit() * (b - a);
    from.push_back(at - 0.2 * (at - inside));
    to.push_back(at + 0.2 * (at - inside));
  }
  std::vector<std::uint8_t> visible(kRays);
  caster.cast(from, to, visible);
  return static_cast<double>(std::ranges::count(visible, 1)) / kRays;
}

void answer(const Kind& kind, double patch_size, CsvTable& table) {
  const Shell shell(kind);
  const PolygonSoup soup = make_soup(shell.scene);
  const PatchMesh mesh = make_patch_mesh(shell.scene, soup, {.patch_size = patch_size});
  const auto row = [&](const std::string& method, const Leak& leak) {
    table.rows.push_back(
        {kind.name, method, digits(leak.mean), digits(leak.largest), leak.closure ? digits(*leak.closure) : "-"});
    fmt::print(stderr, "{}, {}: {:.2g}\n", kind.name, method, leak.mean);
  };
  row("exact", leak_by(ExactVisibility(mesh, soup), 16, kind.on_the_floor));
  for (const bool robust : {true, false}) {
    const std::string mode = robust ? "robust" : "fast";
    row("shadow rays " + mode,
        leak_by(RaySampledVisibility(mesh, soup, {.rays = 1024, .robust = robust}), 0, kind.on_the_floor));
    row("hemisphere " + mode,
        leak_by(RaySampledVisibility(
                    mesh, soup,
                    {.rays = 1 << 14, .sampler = Sampler::owen, .estimator = Estimator::hemisphere, .robust = robust}),
                1, kind.on_the_floor));
    if (kind.on_the_floor) continue;  // its edges on the floor have no inside
    const double share = share_through_edges(shell, soup, robust);
    row("rays at edges " + mode, {share, share, {}});
  }
  row("centre", leak_by(RaySampledVisibility(mesh, soup, {.estimator = Estimator::centre}), 0, kind.on_the_floor));
}

/// The largest leak of each kind and method, and what exact visibility misses of closure. White fields: nothing at all.
HeatMap picture(const CsvTable& table) {
  HeatMap map;
  map.title = "Light through closed shells: largest leak";
  map.scale_label = "leak, closure defect";
  map.note = plot_note();
  struct Column {
    std::string name, method;
    std::size_t field;
  };
  constexpr std::size_t kLargest = 3, kClosure = 4;
  const std::vector<std::pair<std::string, std::vector<Column>>> panels{
      {"exact", {{"leak", "exact", kLargest}, {"closure", "exact", kClosure}}},
      {"rays, robust",
       {{"shadow", "shadow rays robust", kLargest},
        {"all", "hemisphere robust", kLargest},
        {"edges", "rays at edges robust", kLargest}}},
      {"rays, fast",
       {{"shadow", "shadow rays fast", kLargest},
        {"all", "hemisphere fast", kLargest},
        {"edges", "rays at edges fast", kLargest}}},
      {"one ray", {{"centre", "centre", kLargest}}}};
  for (const Kind& kind : kinds()) map.row_names.push_back(kind.name);
  for (const auto& [title, columns] : panels) {
    HeatMap::Panel panel{title, {}, {}};
    for (const Column& column : columns) panel.columns.push_back(column.name);
    for (const std::string& kind : map.row_names) {
      panel.rows.emplace_back();
      for (const Column& column : columns) {
        const auto row = std::ranges::find_if(
            table.rows, [&](const auto& other) { return other[0] == kind && other[1] == column.method; });
        const std::string text = row == table.rows.end() ? "-" : (*row)[column.field];
        const double value = text == "-" ? 0 : std::stod(text);
        panel.rows.back().push_back({value, text == "-" || value == 0 ? text : fmt::format("{:.0e}", value)});
      }
    }
    map.panels.push_back(std::move(panel));
  }
  return map;
}

/// Exactly nothing may leak, up to the rounding of the coordinates [m], which is as much of the room's size. How many
/// rays pass differs from processor to processor.
std::vector<std::string> leaks_that_are_new(const CsvTable& found, const CsvTable& expected) {
  std::vector<std::string> wrong;
  for (const auto& row : found.rows) {
    const auto match = std::ranges::find_if(
        expected.rows, [&](const auto& other) { return other[0] == row[0] && other[1] == row[1]; });
    const bool is_known = match != expected.rows.end();
    const auto at_most = [&](std::size_t column, double limit) { return std::stod(row[column]) <= limit; };
    const double rounding = 1e-12 + 0x1p-53 * offset_of(row[0]);
    const bool holds = is_known && (row[1] == "exact" ? at_most(3, 1e-12) && at_most(4, rounding)
                                                      : at_most(3, std::max(4 * std::stod((*match)[3]), 1e-12)));
    if (!holds) wrong.push_back(fmt::format("{}, {}: {} leaks, defect {}", row[0], row[1], row[3], row[4]));
  }
  return wrong;
}

int run(int argc, char** argv) {
  CLI::App app{"Light through closed surfaces"};
  ExperimentOptions wanted(app, "results.csv and plot.svg", "Fewer points in the room",
                           "What exact visibility and robust rays let through must be as little as there");
  CLI11_PARSE(app, argc, argv);
  CsvTable table{{"kind", "method", "mean_leak", "largest_leak", "closure_defect"}, {}};
  for (const Kind& kind : kinds()) answer(kind, wanted.reduced() ? 2 : 1, table);
  if (wanted.writes()) {
    table.write(wanted.folder() / "results.csv");
    write_heat_map(wanted.folder() / "plot.svg", picture(table));
  }
  return wanted.check([&](const CsvTable& expected) { return leaks_that_are_new(table, expected); });
}

}  // namespace
}  // namespace exitance

int main(int argc, char** argv) {
  return exitance::run(argc, argv);
}
