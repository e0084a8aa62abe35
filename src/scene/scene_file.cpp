#include "src/scene/scene_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "src/scene/face_mending.h"
#include "src/scene/furnished_room.h"
#include "src/scene/input_error.h"
#include "src/scene/mesh_file.h"
#include "src/scene/object_materials.h"
#include "src/scene/placement.h"
#include "src/scene/scene_extent.h"
#include "src/scene/text_cursor.h"
#include "src/scene/toml_table.h"

namespace exitance {
namespace {

/// Along the edge of a patch: what would make 2^32 points of a single one.
constexpr std::int64_t kMostElements = 65'535;

class SceneFile {
 public:
  SceneFile(const std::filesystem::path& path, Emission emission, bool keep_faults)
      : path_(path), emission_(emission), keep_faults_(keep_faults) {}

  DynamicScene read() {
    const toml::table parsed = parse_toml(path_);
    TomlTable file(parsed, path_.string(), "a scene file");
    scene_.name = file.string("name").value_or(path_.stem().string());
    read_unit(file);
    if (auto camera = file.table("camera")) scene_.camera = read_camera(*camera);
    if (auto mesh = file.table("mesh")) read_mesh_defaults(*mesh);
    if (auto links = file.table("links")) read_link_defaults(*links);
    for (TomlTable& material : file.tables("material")) read_material(material);
    for (TomlTable& object : file.tables("object")) read_object(object);
    for (TomlTable& event : file.tables("event")) read_event(event);
    for (TomlTable& camera : file.tables("camera_path")) read_camera_path(camera);
    file.refuse_unknown_keys();
    if (scene_.surfaces.empty() && !scene_.absent.empty())
      file.fail(0, "has no surfaces at the start, as all objects are absent; leave \"absent\" out of one");
    if (scene_.surfaces.empty()) file.fail(0, "has no surfaces; add an [[object]]");
    settle_materials_with_events();
    return {std::move(scene_), links_, std::move(events_), std::move(camera_path_)};
  }

 private:
  void read_unit(TomlTable& file) {
    const auto unit = file.string("unit");
    if (!unit) return;
    if (*unit != "W/m^2" && *unit != "lm/m^2")
      file.fail(file.line_of("unit"), "\"unit\" must be \"W/m^2\" or \"lm/m^2\"");
    scene_.unit = *unit;
  }

  static Camera read_camera(TomlTable& table) {
    Camera camera;
    camera.eye = table.require("eye", table.vector("eye"));
    camera.target = table.require("target", table.vector("target"));
    camera.up = table.vector("up").value_or(camera.up);
    camera.vertical_fov_degrees = table.number("vertical_fov").value_or(camera.vertical_fov_degrees);
    table.refuse_unknown_keys();
    if (camera.vertical_fov_degrees <= 0 || camera.vertical_fov_degrees >= 180) {
      table.fail(table.line_of("vertical_fov"), "\"vertical_fov\" must lie between 0 and 180 degrees");
    }
    if (cross(camera.target - camera.eye, camera.up) == Vec3{}) {
      table.fail(table.line(), "the camera has no direction; move its target off its eye and off the way up");
    }
    return camera;
  }

  void read_mesh_defaults(TomlTable& table) {
    const auto size = [&](const char* key) {
      const double value = table.number(key).value_or(0);
      if (value < 0) table.fail(table.line_of(key), fmt::format("\"{}\" must not be negative", key));
      return value;
    };
    scene_.mesh.patch_size = size("patch_size");
    scene_.mesh.small_patch = size("small_patch");
    const std::int64_t elements = table.integer("elements").value_or(1);
    if (elements < 1 || elements > kMostElements)
      table.fail(table.line_of("elements"), fmt::format("\"elements\" must be 1 to {}", kMostElements));
    scene_.mesh.elements_per_edge = static_cast<std::uint32_t>(elements);
    table.refuse_unknown_keys();
  }

  void read_link_defaults(TomlTable& table) {
    const auto number = [&](const char* key) {
      const std::optional<double> value = table.number(key);
      if (value && *value < 0) table.fail(table.line_of(key), fmt::format("\"{}\" must not be negative", key));
      return value;
    };
    links_ = {number("patch_size"), number("eps2"), number("eps1"), number("B_eps"), number("smallest_area")};
    if (links_.eps1 && links_.eps2 && *links_.eps1 > *links_.eps2)
      table.fail(table.line_of("eps1"), "\"eps1\" must not be above \"eps2\"");
    table.refuse_unknown_keys();
  }

  void read_camera_path(TomlTable& table) {
    CameraAt at;
    at.time = table.require("time", table.number("time"));
    if (!camera_path_.empty() && at.time <= camera_path_.back().time)
      table.fail(table.line_of("time"), "the camera's times must ascend; put its places in order");
    at.camera = read_camera(table);
    camera_path_.push_back(at);
  }

  void read_event(TomlTable& table) {
    Event event;
    event.line = table.line();
    event.time = table.require("time", table.number("time"));
    if (event.time < 0)
      table.fail(table.line_of("time"),
                 fmt::format("the event is at {}, but the scene begins at 0; give it a later time", event.time));
    if (!events_.empty() && event.time < events_.back().time)
      table.fail(table.line_of("time"), fmt::format("the event is at {}, but the one before it at {}; put events in "
                                                    "order of time",
                                                    event.time, events_.back().time));
    const std::string object = table.require("object", table.string("object"));
    const std::string operation = table.require("operation", table.string("operation"));
    event.edit.operation = find_operation(table, operation);
    event.edit.object = find_object(table, object);
    for (const Event& other : events_) {
      if (other.time == event.time && other.edit.object == event.edit.object)
        table.fail(table.line_of("time"),
                   fmt::format("object '{}' has another event at {} (line {}); give each its own time", object,
                               event.time, other.line));
    }
    switch (event.edit.operation) {
      case Operation::add:
      case Operation::move:
        if (has_placement(table)) {
          event.edit.placement = read_placement(table);
        } else if (event.edit.operation == Operation::move) {
          table.fail(table.line(),
                     "a move needs \"translate\", \"rotate\" or \"scale\", from where the object was "
                     "given; add one");
        }
        break;
      case Operation::reshape:
        read_new_shape(table, event.edit, object);
        break;
      case Operation::change:
        event.edit.materials = read_changes(table);
        follow_changes(event.edit);
        break;
      default:
        break;
    }
    table.refuse_unknown_keys();
    events_.push_back(std::move(event));
  }

  static Operation find_operation(const TomlTable& table, const std::string& name) {
    for (const Operation o : {Operation::add, Operation::remove, Operation::move, Operation::reshape, Operation::change,
                              Operation::select, Operation::deselect}) {
      if (name == name_of(o)) return o;
    }
    table.fail(table.line_of("operation"),
               fmt::format("\"operation\" '{}' is not known; there are add, remove, move, reshape, change, select and "
                           "deselect",
                           name));
  }

  std::uint32_t find_object(const TomlTable& table, const std::string& name) const {
    const auto found = std::ranges::find(scene_.objects, name, &SceneObject::name);
    if (found == scene_.objects.end())
      table.fail(table.line_of("object"),
                 fmt::format("there is no object '{}'; name one that an [[object]] gives, above", name));
    if (std::ranges::count(scene_.objects, name, &SceneObject::name) > 1)
      table.fail(table.line_of("object"), fmt::format("several objects are called '{}'; give each its own name", name));
    return static_cast<std::uint32_t>(found - scene_.objects.begin());
  }

  static bool has_placement(const TomlTable& table) {
    return table.has("scale") || table.has("rotate") || table.has("translate");
  }

  /// A new shape is of what the object was made of, where the event does not say.
  void read_new_shape(TomlTable& table, Edit& edit, const std::string& name) {
    Scene part = read_part(table, name);
    std::vector<std::uint32_t> overrides = read_overrides(table, part);
    const ObjectMaterials& kept = materials_of_[edit.object];
    for (std::uint32_t i = 0; i < overrides.size(); ++i) {
      const Material& own = part.materials[i];
      const bool is_used = std::ranges::any_of(part.surfaces, [&](const Surface& s) { return s.material == i; });
      if (overrides[i] != kOwn || !is_used) continue;
      if (const auto known = kept.of_new_shape(own)) {
        overrides[i] = *known;
      } else if (own.rho.empty() && own.E.empty()) {
        table.fail(table.line(), fmt::format("object '{}' is of {} materials and its new shape names none; say which "
                                             "with \"material\" or \"materials\"",
                                             name, kept.used.size()));
      }
    }
    const auto every = table.string("material");
    ObjectMaterials now{
        every ? find_material(table, table.line_of("material"), *every) : kept.every, renamed(part, overrides), {}};
    const std::vector<std::uint32_t> numbers = take_materials(part, overrides);
    for (Surface& surface : part.surfaces) {
      surface.material = numbers[surface.material];
      surface.object = edit.object;
      now.used.insert(surface.material);
      edit.shape.push_back(std::move(surface));
    }
    materials_of_[edit.object] = std::move(now);
    std::ranges::move(part.warnings, std::back_inserter(scene_.warnings));
  }

  /// What an object is made of changes, and with it what a later shape is.
  void follow_changes(const Edit& edit) {
    for (const MaterialChange& change : edit.materials) {
      const bool is_of_mesh = change.from != MaterialChange::kEvery && !is_of_file(change.from);
      materials_of_[edit.object].follow(change, is_of_mesh ? scene_.materials[change.from].name : "");
    }
  }

  /// Whether a [[material]] of the file is meant, not a mesh's own.
  bool is_of_file(std::uint32_t material) const {
    const auto found = material_numbers_.find(scene_.materials[material].name);
    return found != material_numbers_.end() && found->second == material;
  }

  std::vector<MaterialChange> read_changes(TomlTable& table) const {
    std::vector<MaterialChange> changes;
    if (const auto all = table.string("material"))
      changes.push_back({MaterialChange::kEvery, find_material(table, table.line_of("material"), *all)});
    if (auto some = table.table("materials")) {
      for (const std::string& from : some->keys()) {
        const std::string to = *some->string(from);
        const auto found = std::ranges::find(scene_.materials, from, &Material::name);
        if (found == scene_.materials.end())
          some->fail(some->line_of(from), fmt::format("there is no material '{}'; correct the name", from));
        changes.push_back({static_cast<std::uint32_t>(found - scene_.materials.begin()),
                           find_material(*some, some->line_of(from), to)});
      }
    }
    if (changes.empty()) table.fail(table.line(), "a change needs \"material\" or \"materials\"; add one");
    return changes;
  }

  /// Materials that only events name stay, and all are numbered anew: surfaces that stand for them are settled, too.
  void settle_materials_with_events() {
    std::vector<std::uint32_t*> numbers;
    for (Event& event : events_) {
      for (Surface& surface : event.edit.shape) numbers.push_back(&surface.material);
      for (MaterialChange& change : event.edit.materials) {
        numbers.push_back(&change.to);
        if (change.from != MaterialChange::kEvery) numbers.push_back(&change.from);
      }
    }
    const std::size_t absent = scene_.absent.size();
    for (const std::uint32_t* number : numbers) {
      Surface stand_in;
      stand_in.material = *number;
      scene_.absent.push_back(std::move(stand_in));
    }
    settle_materials(scene_, 1, keep_faults_);
    for (std::size_t k = 0; k < numbers.size(); ++k) *numbers[k] = scene_.absent[absent + k].material;
    scene_.absent.resize(absent);
  }

  void read_material(TomlTable& table) {
    Material material;
    material.name = table.require("name", table.string("name"));
    material.rho = table.require("rho", table.numbers("rho"));
    material.E = table.numbers("E").value_or(std::vector<double>{0});
    const Emission meaning = read_emission(table);
    for (double& band : material.E) band = to_exitance(band, meaning);
    material.file = table.file();
    material.line = table.line();
    table.refuse_unknown_keys();
    const auto number = static_cast<std::uint32_t>(scene_.materials.size());
    if (!material_numbers_.emplace(material.name, number).second) {
      table.fail(table.line(), fmt::format("material '{}' is defined twice; rename one", material.name));
    }
    scene_.materials.push_back(std::move(material));
  }

  Emission read_emission(TomlTable& table) const {
    const auto name = table.string("emission");
    if (!name) return emission_;
    if (*name == "exitance") return Emission::exitance;
    if (*name == "radiance") return Emission::radiance;
    table.fail(table.line_of("emission"), "\"emission\" must be \"exitance\" or \"radiance\"");
  }

  std::uint32_t find_material(const TomlTable& table, std::uint32_t line, const std::string& name) const {
    const auto found = material_numbers_.find(name);
    if (found == material_numbers_.end()) {
      table.fail(line, fmt::format("material '{}' is not defined; add a [[material]] of that name", name));
    }
    return found->second;
  }

  void read_object(TomlTable& table) {
    const std::string name = table.string("name").value_or("");
    Scene part = read_part(table, name);
    const std::vector<std::uint32_t> overrides = read_overrides(table, part);
    const auto every = table.string("material");
    const ObjectMaterials given{
        every ? std::optional(find_material(table, table.line_of("material"), *every)) : std::nullopt,
        renamed(part, overrides),
        {}};
    materials_of_.resize(scene_.objects.size() + part.objects.size(), given);
    append(std::move(part), overrides, table.flag("absent"));
    table.refuse_unknown_keys();
  }

  /// Surfaces as they stand in the scene, with their own materials.
  Scene read_part(TomlTable& table, const std::string& name) {
    Scene part = read_shape(table, name);
    place(part, read_placement(table));
    if (table.has("mesh")) {
      mend_faces(part);
    } else if (!keep_faults_) {
      refuse_crossing(table, part);
    }
    if (table.flag("flip")) flip(part);
    if (table.flag("two_sided")) make_two_sided(part);
    const bool obstruction_only = table.flag("obstruction_only");
    for (Surface& surface : part.surfaces) surface.obstruction_only |= obstruction_only;
    limit_reflectance(table, part);
    return part;
  }

  // One of the four forms. Its materials are its own; those of the file are named by surfaces through named_.
  Scene read_shape(TomlTable& table, const std::string& name) {
    named_.clear();
    const int forms = table.has("mesh") + table.has("polygons") + table.has("box") + table.has("furnished-room");
    if (forms != 1) table.fail(table.line(), "an object needs exactly one of mesh, polygons, box and furnished-room");
    if (const auto mesh = table.string("mesh")) return read_mesh_part(table, *mesh, name);
    if (auto room = table.table("furnished-room")) return read_furnished_room(*room, name);
    Scene part;
    part.objects.push_back({name.empty() ? fmt::format("object {}", scene_.objects.size()) : name, table.file()});
    part.materials.push_back({.name = "", .rho = {}, .E = {}, .file = table.file(), .line = table.line()});
    if (auto box = table.table("box")) {
      read_box(*box, part);
    } else {
      for (const toml::node& item : *table.array("polygons")) read_polygon(table, item, part);
    }
    return part;
  }

  Scene read_mesh_part(const TomlTable& table, const std::string& mesh, const std::string& name) const {
    const std::filesystem::path file = path_.parent_path() / mesh;
    if (!is_file(file)) {
      table.fail(table.line_of("mesh"),
                 fmt::format("the mesh {} is missing or no file; paths are relative to this file", file.string()));
    }
    if (const std::string extension = lower_extension(file); extension == ".toml" || extension == ".vs3") {
      table.fail(table.line_of("mesh"),
                 fmt::format("{} is no mesh; an object takes .obj, .ply, .off or .stl", file.string()));
    }
    Scene part = read_mesh(file, emission_, keep_faults_);
    part.objects = {{name.empty() ? part.name : name, file.string()}};
    for (Surface& surface : part.surfaces) surface.object = 0;
    return part;
  }

  static Scene read_furnished_room(TomlTable& table, const std::string& name) {
    const std::int64_t polygons = table.require("polygons", table.integer("polygons"));
    const std::int64_t seed = table.require("seed", table.integer("seed"));
    table.refuse_unknown_keys();
    if (polygons < 100 || polygons > 1'000'000)
      table.fail(table.line_of("polygons"), "\"polygons\" must be 100 to 1000000");
    if (seed < 0) table.fail(table.line_of("seed"), "\"seed\" must not be negative");
    Scene part = make_furnished_room(static_cast<std::uint32_t>(polygons), static_cast<std::uint64_t>(seed));
    if (!name.empty()) {
      for (SceneObject& object : part.objects) object.name = name + "/" + object.name;
    }
    return part;
  }

  static void read_box(TomlTable& table, Scene& part) {
    const Vec3 a = table.require("min", table.vector("min"));
    const Vec3 b = table.require("max", table.vector("max"));
    table.refuse_unknown_keys();
    if (!(a.x < b.x && a.y < b.y && a.z < b.z)) table.fail(table.line(), "\"min\" must be below \"max\" in x, y and z");
    const auto add = [&](const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s) {
      part.surfaces.push_back({.polygon = {{p, q, r, s}, {}}, .line = table.line()});
    };
    add({a.x, a.y, a.z}, {a.x, b.y, a.z}, {b.x, b.y, a.z}, {b.x, a.y, a.z});  // below
    add({a.x, a.y, b.z}, {b.x, a.y, b.z}, {b.x, b.y, b.z}, {a.x, b.y, b.z});  // above
    add({a.x, a.y, a.z}, {b.x, a.y, a.z}, {b.x, a.y, b.z}, {a.x, a.y, b.z});  // y = min
    add({a.x, b.y, a.z}, {a.x, b.y, b.z}, {b.x, b.y, b.z}, {b.x, b.y, a.z});  // y = max
    add({a.x, a.y, a.z}, {a.x, a.y, b.z}, {a.x, b.y, b.z}, {a.x, b.y, a.z});  // x = min
    add({b.x, a.y, a.z}, {b.x, b.y, a.z}, {b.x, b.y, b.z}, {b.x, a.y, b.z});  // x = max
  }

  void read_polygon(const TomlTable& object, const toml::node& node, Scene& part) {
    Surface surface;
    surface.line = line_of(node);
    if (node.is_table()) {
      TomlTable table(*node.as_table(), object.file(), "polygons");
      const toml::array* outer = table.array("polygon");
      if (!outer) table.fail(table.line(), "\"polygon\" is missing; add it");
      surface.polygon.outer = read_loop(table, *outer);
      if (const toml::array* holes = table.array("holes")) {
        for (const toml::node& hole : *holes) surface.polygon.holes.push_back(read_loop(table, hole));
      }
      if (const auto material = table.string("material")) {
        surface.material = own_material(part, find_material(table, table.line_of("material"), *material));
      }
      table.refuse_unknown_keys();
    } else {
      surface.polygon.outer = read_loop(object, node);
    }
    part.surfaces.push_back(std::move(surface));
  }

  static std::vector<Vec3> read_loop(const TomlTable& table, const toml::node& node) {
    const toml::array* list = node.as_array();
    if (!list) table.fail(line_of(node), "a polygon must be a list of points [[x, y, z], …]");
    if (list->size() < 3) {
      table.fail(line_of(node),
                 fmt::format("the polygon has {} vertices, it needs three; correct or remove it", list->size()));
    }
    std::vector<Vec3> loop;
    for (const toml::node& point : *list) loop.push_back(table.to_vector(point));
    return loop;
  }

  // The part's stand-in for a material of the file.
  std::uint32_t own_material(Scene& part, std::uint32_t number) {
    const auto next = static_cast<std::uint32_t>(part.materials.size());
    for (const auto& [own, of_file] : named_) {
      if (of_file == number) return own;
    }
    part.materials.emplace_back();
    named_.emplace(next, number);
    return next;
  }

  static Placement read_placement(TomlTable& table) {
    Placement placement;
    for (TomlTable& turn : read_rotations(table)) {
      const Vec3 axis = turn.require("axis", turn.vector("axis"));
      const double degrees = turn.require("degrees", turn.number("degrees"));
      turn.refuse_unknown_keys();
      if (axis == Vec3{}) turn.fail(turn.line(), "\"axis\" has no direction");
      placement.linear = product(rotation(axis, degrees), placement.linear);
    }
    placement.linear = product(placement.linear, scaling(read_scale(table)));
    placement.translation = table.vector("translate").value_or(Vec3{});
    if (const auto pivot = table.vector("pivot")) {
      const Placement about_origin{placement.linear, {}};
      placement.translation = placement.translation + (*pivot - about_origin(*pivot));
    }
    return placement;
  }

  static std::vector<TomlTable> read_rotations(TomlTable& table) {
    if (!table.has("rotate")) return {};
    if (table.is_list("rotate")) return table.tables("rotate");
    return {*table.table("rotate")};
  }

  static Vec3 read_scale(TomlTable& table) {
    if (!table.has("scale")) return {1, 1, 1};
    Vec3 scale;
    if (table.is_list("scale")) {
      scale = *table.vector("scale");
    } else {
      const double s = *table.number("scale");
      scale = {s, s, s};
    }
    if (scale.x == 0 || scale.y == 0 || scale.z == 0) table.fail(table.line_of("scale"), "\"scale\" must not be zero");
    return scale;
  }

  static void refuse_crossing(const TomlTable& table, const Scene& part) {
    for (const Surface& surface : part.surfaces) {
      const PolygonDefect defect = find_defect(surface.polygon);
      if (defect == PolygonDefect::none || defect == PolygonDefect::zero_area) continue;
      table.fail(surface.line, fmt::format("the polygon is not valid: {}; correct or remove it", describe(defect)));
    }
  }

  static void limit_reflectance(TomlTable& table, Scene& part) {
    const auto limit = table.number("max_rho");
    if (!limit) return;
    if (*limit < 0 || *limit >= 1) table.fail(table.line_of("max_rho"), "\"max_rho\" must be at least 0 and below 1");
    for (Material& material : part.materials) {
      for (double& rho : material.rho) rho = std::min(rho, *limit);
    }
  }

  // The file's material that replaces each of the part's, or kOwn.
  std::vector<std::uint32_t> read_overrides(TomlTable& table, const Scene& part) const {
    std::vector<std::uint32_t> overrides(part.materials.size(), kOwn);
    for (const auto& [own, of_file] : named_) overrides[own] = of_file;
    if (const auto all = table.string("material")) {
      const std::uint32_t number = find_material(table, table.line_of("material"), *all);
      for (std::uint32_t& entry : overrides) {
        // A polygon's own word counts more than its object's.
        if (entry == kOwn) entry = number;
      }
    }
    if (auto some = table.table("materials")) {
      for (const std::string& from : some->keys()) {
        const std::string to = *some->string(from);
        const auto found = std::ranges::find(part.materials, from, &Material::name);
        if (found == part.materials.end()) {
          some->fail(some->line_of(from), fmt::format("the object has no material '{}'; correct the name", from));
        }
        overrides[static_cast<std::size_t>(found - part.materials.begin())] =
            find_material(*some, some->line_of(from), to);
      }
    }
    return overrides;
  }

  /// By the names of a part's own materials: those of the scene that replace them.
  std::map<std::string, std::uint32_t> renamed(const Scene& part, const std::vector<std::uint32_t>& overrides) const {
    std::map<std::string, std::uint32_t> numbers;
    for (std::uint32_t i = 0; i < overrides.size(); ++i) {
      if (overrides[i] != kOwn && !named_.contains(i) && !part.materials[i].name.empty())
        numbers.emplace(part.materials[i].name, overrides[i]);
    }
    return numbers;
  }

  /// Numbers in the scene of a part's materials.
  std::vector<std::uint32_t> take_materials(Scene& part, std::vector<std::uint32_t> numbers) {
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      if (numbers[i] != kOwn) continue;
      numbers[i] = static_cast<std::uint32_t>(scene_.materials.size());
      scene_.materials.push_back(std::move(part.materials[i]));
    }
    return numbers;
  }

  void append(Scene part, const std::vector<std::uint32_t>& overrides, bool absent) {
    const std::vector<std::uint32_t> numbers = take_materials(part, overrides);
    const auto first_object = static_cast<std::uint32_t>(scene_.objects.size());
    std::ranges::move(part.objects, std::back_inserter(scene_.objects));
    for (Surface& surface : part.surfaces) {
      surface.material = numbers[surface.material];
      surface.object += first_object;
      materials_of_[surface.object].used.insert(surface.material);
      (absent ? scene_.absent : scene_.surfaces).push_back(std::move(surface));
    }
    std::ranges::move(part.warnings, std::back_inserter(scene_.warnings));
  }

  static constexpr std::uint32_t kOwn = 0xffffffffu;

  std::filesystem::path path_;
  Emission emission_;
  bool keep_faults_;
  Scene scene_;
  LinkDefaults links_;
  std::vector<Event> events_;
  std::vector<CameraAt> camera_path_;
  std::map<std::string, std::uint32_t> material_numbers_;
  std::vector<ObjectMaterials> materials_of_;     // by object
  std::map<std::uint32_t, std::uint32_t> named_;  // of the object being read: its material → the file's
};

}  // namespace

Scene read_scene_file(const std::filesystem::path& path, Emission emission, bool keep_faults) {
  return SceneFile(path, emission, keep_faults).read().scene;
}

DynamicScene read_dynamic_scene(const std::filesystem::path& path, Emission emission) {
  DynamicScene read = SceneFile(path, emission, false).read();
  refuse_bad_extents(read.scene, path);
  EditedScene edited(read.scene);
  for (const Event& event : read.events) {
    try {
      edited.apply(event.edit);
    } catch (const InvalidEdit& wrong) {
      throw InputError(path.string(), event.line, wrong.what());
    }
  }
  return read;
}

}  // namespace exitance
