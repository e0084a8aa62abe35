#include "src/scene/furnished_room.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace exitance {
namespace {

constexpr double kCell = 2;    ///< a group of furniture stands on kCell × kCell [m]
constexpr double kHeight = 3;  ///< of the room [m]

/// Numbers from the generator's bits alone: the distributions of the standard library differ between implementations.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double uniform(double lower, double upper) {
    return lower + (upper - lower) * std::ldexp(static_cast<double>(engine_() >> 11), -53);
  }
  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>((engine_() >> 32) % n); }

 private:
  std::mt19937_64 engine_;
};

/// Cosine and sine of a fraction of a full turn, rounded to 2^-30: mathematical libraries differ in the last bit.
std::array<double, 2> direction(double turn) {
  const auto rounded = [](double v) { return std::ldexp(std::nearbyint(std::ldexp(v, 30)), -30); };
  return {rounded(std::cos(2 * std::numbers::pi * turn)), rounded(std::sin(2 * std::numbers::pi * turn))};
}

/// Where a piece of furniture stands: its own (u, v) on the floor, turned about the vertical. With a quarter turn a
/// plane u = 0 or v = 0 lies exactly in the origin's, so that furniture can touch a wall.
struct Frame {
  double x = 0, y = 0;
  double c = 1, s = 0;

  Vec3 at(double u, double v, double z) const { return {x + c * u - s * v, y + s * u + c * v, z}; }
};

struct Span {
  double lower, upper;
};

/// Where an ornament may stand.
struct Place {
  Frame frame;
  double u, v, z;
  double radius, height;  ///< at most
};

/// In the order of the scene's materials.
enum MaterialIndex : std::uint32_t {
  wall,
  floor_boards,
  ceiling,
  wood,
  dark_wood,
  fabric,
  paper,
  card,
  ceramic,
  stone,
  lamp
};

class Furnisher {
 public:
  Furnisher(std::uint32_t polygons, std::uint64_t seed) : random_(seed) {
    scene_.name = "Furnished room of " + std::to_string(polygons) + " polygons, seed " + std::to_string(seed);
    for (const auto& [name, rho] : {std::pair<const char*, std::vector<double>>{"wall", {0.75, 0.72, 0.65}},
                                    {"floor_boards", {0.45, 0.32, 0.22}},
                                    {"ceiling", {0.8, 0.8, 0.8}},
                                    {"wood", {0.6, 0.42, 0.26}},
                                    {"dark_wood", {0.35, 0.25, 0.2}},
                                    {"fabric", {0.5, 0.2, 0.22}},
                                    {"paper", {0.7, 0.7, 0.62}},
                                    {"card", {0.25, 0.4, 0.55}},
                                    {"ceramic", {0.3, 0.6, 0.5}},
                                    {"stone", {0.55, 0.55, 0.55}},
                                    {"lamp", {0.5, 0.5, 0.5}}}) {
      Material& material = scene_.materials.emplace_back();
      material.name = name;
      material.rho = rho;
      material.E = {0, 0, 0};
    }
    scene_.materials[lamp].E = {40, 36, 30};
    const std::uint32_t groups = std::clamp(polygons / 100, 4u, 20u);
    columns_ = static_cast<std::uint32_t>(std::sqrt(groups));
    rows_ = groups / columns_;
    shell_ = 1 + columns_ * rows_ + 2 * (columns_ + rows_);
    polygons_ = polygons;
    fullness_ = std::clamp(polygons / 60000.0, 0.1, 0.5);
    const double width = kCell * columns_, depth = kCell * rows_;
    scene_.camera = Camera{{0.5, 0.3, 2.4}, {0.6 * width, 0.6 * depth, 0.5}, {0, 0, 1}, 65};
  }

  Scene make() {
    for_cells([&](std::uint32_t i, std::uint32_t j, bool at_wall) { light(i, j, at_wall); });
    std::uint32_t at_walls = 0, inside = 0;
    for_cells([&](std::uint32_t i, std::uint32_t j, bool at_wall) {
      if (at_wall)
        furnish_at_wall(i, j, at_walls++);
      else
        furnish_inside(i, j, inside++);
    });
    add_vases();
    add_shell();
    return std::move(scene_);
  }

 private:
  template <class Visit>
  void for_cells(const Visit& visit) const {
    for (std::uint32_t j = 0; j < rows_; ++j)
      for (std::uint32_t i = 0; i < columns_; ++i) visit(i, j, i == 0 || j == 0 || i + 1 == columns_ || j + 1 == rows_);
  }

  std::size_t left() const { return polygons_ - shell_ - scene_.surfaces.size(); }

  /// Adds an object if the number of polygons allows, else nothing of it; tells which.
  template <class Build>
  bool add_object(const std::string& name, const Build& build) {
    const std::size_t before = scene_.surfaces.size();
    scene_.objects.push_back({name + " " + std::to_string(scene_.objects.size()), ""});
    build();
    if (scene_.surfaces.size() + shell_ <= polygons_) return true;
    scene_.surfaces.resize(before);
    scene_.objects.pop_back();
    return false;
  }

  void add_polygon(std::vector<Vec3> loop, MaterialIndex material) {
    Surface surface;
    surface.polygon.outer = std::move(loop);
    surface.material = material;
    surface.object = static_cast<std::uint32_t>(scene_.objects.size()) - 1;
    scene_.surfaces.push_back(std::move(surface));
  }

  /// A closed solid over a polygon (counter-clockwise from above): corner k of the base and of the top.
  void add_solid(const std::vector<Vec3>& base, const std::vector<Vec3>& top, MaterialIndex material) {
    add_walls(base, top, material);
    add_caps(base, top, material);
  }

  void add_walls(const std::vector<Vec3>& base, const std::vector<Vec3>& top, MaterialIndex material) {
    for (std::size_t k = 0, n = base.size(); k < n; ++k)
      add_polygon({base[k], base[(k + 1) % n], top[(k + 1) % n], top[k]}, material);
  }

  void add_caps(const std::vector<Vec3>& base, const std::vector<Vec3>& top, MaterialIndex material) {
    add_polygon({base.rbegin(), base.rend()}, material);
    add_polygon(top, material);
  }

  void add_box(const Frame& f, Span u, Span v, Span z, MaterialIndex material) {
    const auto ring = [&](double level) {
      return std::vector<Vec3>{f.at(u.lower, v.lower, level), f.at(u.upper, v.lower, level),
                               f.at(u.upper, v.upper, level), f.at(u.lower, v.upper, level)};
    };
    add_solid(ring(z.lower), ring(z.upper), material);
  }

  static std::vector<Vec3> circle(const Frame& f, double u, double v, double z, double radius, std::uint32_t sides) {
    std::vector<Vec3> ring;
    for (std::uint32_t k = 0; k < sides; ++k) {
      const auto [c, s] = direction(static_cast<double>(k) / sides);
      ring.push_back(f.at(u + radius * c, v + radius * s, z));
    }
    return ring;
  }

  void add_prism(const Frame& f, double radius, std::uint32_t sides, Span z, MaterialIndex material) {
    add_solid(circle(f, 0, 0, z.lower, radius, sides), circle(f, 0, 0, z.upper, radius, sides), material);
  }

  Frame centre(std::uint32_t i, std::uint32_t j) const { return {kCell * (i + 0.5), kCell * (j + 0.5), 1, 0}; }

  Frame turned(Frame f) {
    const auto [c, s] = direction(random_.uniform(0, 1));
    f.c = c;
    f.s = s;
    return f;
  }

  /// At the middle of a cell's wall, v into the room.
  Frame wall_frame(std::uint32_t i, std::uint32_t j) const {
    const Frame middle = centre(i, j);
    if (j == 0) return {middle.x, 0, 1, 0};
    if (i + 1 == columns_) return {kCell * columns_, middle.y, 0, 1};
    if (j + 1 == rows_) return {middle.x, kCell * rows_, -1, 0};
    return {0, middle.y, 0, -1};
  }

  void furnish_at_wall(std::uint32_t i, std::uint32_t j, std::uint32_t number) {
    switch (number % 4) {
      case 0:
        add_shelf(wall_frame(i, j));
        break;
      case 1:
        add_table_group(centre(i, j));
        break;
      case 2:
        add_cupboard(wall_frame(i, j));
        break;
      case 3:
        add_stack(centre(i, j));
        break;
    }
  }

  void furnish_inside(std::uint32_t i, std::uint32_t j, std::uint32_t number) {
    switch (number % 4) {
      case 0:
        add_table_group(turned(centre(i, j)));
        break;
      case 1:
        add_column(centre(i, j));
        break;
      case 2:
        add_stack(centre(i, j));
        break;
      case 3:
        add_pedestals(turned(centre(i, j)));
        break;
    }
  }

  /// Every other cell is lit: lamps at the ceiling, spotlights along the walls.
  void light(std::uint32_t i, std::uint32_t j, bool at_wall) {
    if ((i + j) % 2 == 0) return;
    if (at_wall && i % 2 == 0)
      add_spotlight(centre(i, j));
    else
      add_ceiling_lamp(centre(i, j));
  }

  void add_ceiling_lamp(const Frame& f) {
    // Not in the middle, where a column may stand.
    add_object("ceiling lamp", [&] { add_box(f, {-0.3, 0.3}, {0.4, 0.7}, {kHeight - 0.08, kHeight}, lamp); });
  }

  /// A box hanging free, tilted, its faces planar up to rounding only.
  void add_spotlight(const Frame& f) {
    const auto tilt = direction(random_.uniform(0.05, 0.2));
    const Frame about = turned(f);
    add_object("spotlight", [&] {
      const auto [c, s] = tilt;
      std::vector<Vec3> base, top;
      for (const auto& [u, v] : {std::array{-0.1, -0.06}, {0.1, -0.06}, {0.1, 0.06}, {-0.1, 0.06}}) {
        base.push_back(about.at(c * u + s * 0.12, v, 2.6 + s * u - c * 0.12));
        top.push_back(about.at(c * u, v, 2.6 + s * u));
      }
      add_solid(base, top, lamp);
    });
  }

  void add_table_group(const Frame& f) {
    const bool rug = add_object("rug", [&] { add_box(f, {-0.55, 0.55}, {-0.37, 0.37}, {0, 0.0125}, fabric); });
    const double foot = rug ? 0.0125 : 0, top = random_.uniform(0.7, 0.78);
    const double inset = random_.below(2) == 0 ? 0 : 0.03;  // legs flush with the top's sides, or not
    const bool table = add_object("table", [&] {
      add_box(f, {-0.5, 0.5}, {-0.35, 0.35}, {top - 0.04, top}, wood);
      add_legs(f, 0.5 - inset, 0.35 - inset, 0.06, {foot, top - 0.04}, dark_wood);
    });
    if (table)
      for (const double u : {-0.3, 0.0, 0.3}) places_.push_back({f, u, random_.uniform(-0.15, 0.15), top, 0.14, 0.45});
    for (const double v : {-0.66, 0.66}) {
      Frame chair = f;
      const Vec3 at = f.at(0, v, 0);
      chair.x = at.x;
      chair.y = at.y;
      add_chair(turned(chair));
    }
  }

  void add_legs(const Frame& f, double half_u, double half_v, double thickness, Span z, MaterialIndex material) {
    for (const Span u : {Span{-half_u, thickness - half_u}, Span{half_u - thickness, half_u}})
      for (const Span v : {Span{-half_v, thickness - half_v}, Span{half_v - thickness, half_v}})
        add_box(f, u, v, z, material);
  }

  void add_chair(const Frame& f) {
    add_object("chair", [&] {
      add_box(f, {-0.19, 0.19}, {-0.19, 0.19}, {0.42, 0.46}, fabric);
      add_legs(f, 0.17, 0.17, 0.04, {0, 0.42}, dark_wood);
      add_box(f, {-0.19, 0.19}, {0.15, 0.19}, {0.46, 0.9}, wood);
    });
  }

  void add_shelf(const Frame& f) {
    constexpr std::uint32_t kBoards = 4;
    constexpr double kBoard = 0.025, kTop = 1.5, kDepth = 0.3;
    const double pitch = kTop / kBoards;
    const bool shelf = add_object("shelf", [&] {
      add_box(f, {-0.8, 0.8}, {0, 0.02}, {0, kTop}, dark_wood);
      add_box(f, {-0.8, -0.775}, {0.02, kDepth}, {0, kTop}, wood);
      add_box(f, {0.775, 0.8}, {0.02, kDepth}, {0, kTop}, wood);
      for (std::uint32_t b = 0; b < kBoards; ++b)
        add_box(f, {-0.775, 0.775}, {0.02, kDepth}, {b * pitch, b * pitch + kBoard}, wood);
      add_box(f, {-0.8, 0.8}, {0, kDepth}, {kTop, kTop + kBoard}, wood);
    });
    if (!shelf) return;
    for (const double u : {-0.5, 0.0, 0.5}) places_.push_back({f, u, 0.16, kTop + kBoard, 0.13, 0.5});
    for (std::uint32_t b = 0; b < kBoards; ++b) add_books(f, b * pitch + kBoard, pitch - kBoard);
  }

  /// Books upright on a board, in touch with their neighbours or with a gap between.
  void add_books(const Frame& f, double z, double room) {
    double u = -0.775;
    while (u < 0.72) {
      const double next = u + random_.uniform(0.018, 0.05);
      if (random_.uniform(0, 1) < fullness_) {
        const Span height{z, z + room * random_.uniform(0.6, 0.95)}, depth{0.05, random_.uniform(0.18, 0.28)};
        const MaterialIndex cover = std::array{fabric, paper, card}[random_.below(3)];
        if (!add_object("book", [&] { add_box(f, {u, next}, depth, height, cover); })) return;
      }
      u = next;
    }
  }

  void add_cupboard(const Frame& f) {
    const double top = random_.uniform(0.8, 1.1);
    const bool cupboard = add_object("cupboard", [&] {
      add_box(f, {-0.7, 0.7}, {0, 0.4}, {0, top}, wood);
      for (const double side : {-1.0, 1.0}) {
        const double hinge = side * 0.68, edge = side * 0.01, knob = side * 0.06;
        add_box(f, {std::min(hinge, edge), std::max(hinge, edge)}, {0.4, 0.42}, {0.08, top - 0.02}, dark_wood);
        add_box(f, {knob - 0.015, knob + 0.015}, {0.42, 0.45}, {0.6, 0.63}, stone);
      }
    });
    if (!cupboard) return;
    for (const double u : {-0.5, 0.0, 0.5}) places_.push_back({f, u, 0.2, top, 0.16, 0.5});
    add_object("picture", [&] { add_box(f, {-0.5, 0.5}, {0, 0.03}, {1.75, 2.4}, card); });
  }

  /// Boxes on one another, each turned and small enough to stand inside the top of the one beneath.
  void add_stack(const Frame& f) {
    double half = random_.uniform(0.4, 0.6), z = 0;
    Frame top_frame = f;
    const std::uint32_t count = 2 + random_.below(3);
    for (std::uint32_t k = 0; k < count; ++k) {
      const double top = z + random_.uniform(0.2, 0.4);
      const Frame box = turned(f);
      if (!add_object("box", [&] { add_box(box, {-half, half}, {-half, half}, {z, top}, k % 2 == 0 ? card : paper); }))
        return;
      z = top;
      half *= 0.68;
      top_frame = box;
    }
    places_.push_back({top_frame, 0, 0, z, 0.95 * half, 0.4});
  }

  void add_column(const Frame& f) {
    add_object("column", [&] { add_prism(f, 0.2, 8 + 4 * random_.below(4), {0, kHeight}, stone); });
    const double top = random_.uniform(0.4, 0.5);
    for (const double side : {-1.0, 1.0}) {
      Frame bench = f;
      bench.y += side * 0.7;
      const bool kept = add_object("bench", [&] {
        add_box(bench, {-0.6, 0.6}, {-0.15, 0.15}, {top - 0.05, top}, wood);
        for (const double u : {-0.5, 0.4}) add_box(bench, {u, u + 0.1}, {-0.12, 0.12}, {0, top - 0.05}, stone);
      });
      if (kept)
        for (const double u : {-0.35, 0.35}) places_.push_back({bench, u, 0, top, 0.12, 0.5});
    }
  }

  void add_pedestals(const Frame& f) {
    for (const auto& [u, v] : {std::array{-0.5, -0.3}, {0.5, -0.3}, {0.0, 0.5}}) {
      const Vec3 at = f.at(u, v, 0);
      const Frame pedestal{at.x, at.y, f.c, f.s};
      const double top = random_.uniform(0.5, 1.2);
      const std::uint32_t sides = 3 + random_.below(6);
      if (add_object("pedestal", [&] { add_prism(pedestal, 0.25, sides, {0, top}, stone); }))
        places_.push_back({pedestal, 0, 0, top, 0.12, 0.6});
    }
  }

  /// Vases on all places, as finely cut as the number of polygons wants.
  void add_vases() {
    constexpr std::uint32_t kFewest = 40;  ///< polygons of a vase
    const std::size_t count = std::min(places_.size(), left() / kFewest);
    for (std::size_t k = 0; k < count; ++k) {
      const auto share = static_cast<std::uint32_t>(left() / (count - k));
      const auto sides = static_cast<std::uint32_t>(std::sqrt(1.5 * share));
      add_vase(places_[k * places_.size() / count], sides, (share - 2) / sides);
    }
  }

  void add_vase(const Place& place, std::uint32_t sides, std::uint32_t bands) {
    const double height = place.height * random_.uniform(0.6, 1), waist = random_.uniform(0.2, 0.8);
    add_object("vase", [&] {
      std::vector<std::vector<Vec3>> rings;
      for (std::uint32_t k = 0; k <= bands; ++k) {
        const double t = static_cast<double>(k) / bands;
        // A belly below and a flare above, of 0.35 … 1 times the largest radius.
        const double belly = 4 * t * (1 - t) * (1 - waist * t), flare = 0.5 * t * t * t;
        const double radius = place.radius * (0.35 + 0.65 * std::min(1.0, 0.9 * belly + flare));
        rings.push_back(circle(place.frame, place.u, place.v, k == 0 ? place.z : place.z + height * t, radius, sides));
      }
      for (std::uint32_t k = 0; k < bands; ++k) add_walls(rings[k], rings[k + 1], ceramic);
      add_caps(rings.front(), rings.back(), ceramic);
    });
  }

  /// The room itself, facing inward: one floor, a grid of ceiling panels, and wall panels below their edges, of which
  /// some are cut into rows so that the number of polygons comes out.
  void add_shell() {
    const double width = kCell * columns_, depth = kCell * rows_;
    std::size_t cuts = left();
    scene_.objects.push_back({"room", ""});
    add_polygon({{0, 0, 0}, {width, 0, 0}, {width, depth, 0}, {0, depth, 0}}, floor_boards);
    for (std::uint32_t j = 0; j < rows_; ++j)
      for (std::uint32_t i = 0; i < columns_; ++i) {
        const double x0 = kCell * i, x1 = kCell * (i + 1), y0 = kCell * j, y1 = kCell * (j + 1);
        add_polygon({{x0, y0, kHeight}, {x0, y1, kHeight}, {x1, y1, kHeight}, {x1, y0, kHeight}}, ceiling);
      }
    std::size_t strips = 2 * (columns_ + rows_);
    const auto add_strip = [&](double x0, double y0, double x1, double y1) {
      const std::size_t rows = 1 + cuts / strips;
      cuts -= rows - 1;
      --strips;
      const auto level = [&](std::size_t k) { return kHeight * static_cast<double>(k) / static_cast<double>(rows); };
      for (std::size_t k = 0; k < rows; ++k)
        add_polygon({{x0, y0, level(k)}, {x0, y0, level(k + 1)}, {x1, y1, level(k + 1)}, {x1, y1, level(k)}}, wall);
    };
    for (std::uint32_t i = 0; i < columns_; ++i) {
      add_strip(kCell * i, 0, kCell * (i + 1), 0);
      add_strip(kCell * (i + 1), depth, kCell * i, depth);
    }
    for (std::uint32_t j = 0; j < rows_; ++j) {
      add_strip(width, kCell * j, width, kCell * (j + 1));
      add_strip(0, kCell * (j + 1), 0, kCell * j);
    }
  }

  Scene scene_;
  Random random_;
  std::uint32_t polygons_ = 0, columns_ = 0, rows_ = 0, shell_ = 0;
  double fullness_ = 0;  ///< how much of a shelf is filled with books
  std::vector<Place> places_;
};

}  // namespace

Scene make_furnished_room(std::uint32_t polygons, std::uint64_t seed) {
  if (polygons < 100 || polygons > 1000000)
    throw std::invalid_argument("a furnished room has 100 to 1,000,000 polygons, not " + std::to_string(polygons));
  return Furnisher(polygons, seed).make();
}

}  // namespace exitance
