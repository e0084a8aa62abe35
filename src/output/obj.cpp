#include "src/output/obj.h"

#include <array>
#include <charconv>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "geometry/facets.h"
#include "src/output/whole_file.h"
#include "src/scene/mesh_file.h"

namespace exitance {
namespace {

void append(std::string& text, double value) {
  std::array<char, 32> digits;
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  text.append(1, ' ').append(digits.data(), end);
}

/// Names end at the first blank in OBJ.
std::string one_word(std::string name) {
  for (char& c : name)
    if (c == ' ' || c == '\t') c = '_';
  return name;
}

std::string materials_text(const Scene& scene) {
  std::string text = "# Kd: reflectance. Ke: emitted exitance, " + scene.unit + ".\n";
  for (const Material& material : scene.materials) {
    text += "newmtl " + one_word(material.name) + "\n";
    for (const auto& [key, bands] : {std::pair{"Kd", &material.rho}, {"Ke", &material.E}}) {
      text += key;
      for (std::size_t band = 0; band < 3; ++band) append(text, (*bands)[scene.bands == 1 ? 0 : band]);
      text += '\n';
    }
  }
  return text;
}

std::string geometry_text(const Scene& scene, const std::string& material_file) {
  std::map<std::tuple<double, double, double>, std::size_t> index_of;
  std::string vertices, faces;
  const auto add_face = [&](const Loop& loop) {
    faces += 'f';
    for (const Vec3& p : loop) {
      const auto [place, is_new] = index_of.try_emplace({p.x, p.y, p.z}, index_of.size() + 1);
      if (is_new) {
        vertices += 'v';
        for (int axis = 0; axis < 3; ++axis) append(vertices, p[axis]);
        vertices += '\n';
      }
      faces += ' ' + std::to_string(place->second);
    }
    faces += '\n';
  };
  const Surface* previous = nullptr;
  for (const Surface& surface : scene.surfaces) {
    const bool new_object = !previous || surface.object != previous->object;
    if (new_object && surface.object < scene.objects.size())
      faces += "o " + one_word(scene.objects[surface.object].name) + '\n';
    if (!previous || surface.material != previous->material)
      faces += "usemtl " + one_word(scene.materials.at(surface.material).name) + '\n';
    previous = &surface;
    if (surface.polygon.holes.empty())
      add_face(surface.polygon.outer);
    else
      for (const Loop& facet : cut_into_facets(surface.polygon)) add_face(facet);
  }
  return "# " + scene.name + "\nmtllib " + material_file + '\n' + vertices + faces;
}

}  // namespace

void write_obj(const Scene& scene, const std::filesystem::path& path) {
  if (scene.bands != 1 && scene.bands != 3)
    throw std::invalid_argument("OBJ materials have one or three bands, not " + std::to_string(scene.bands));
  if (lower_extension(path) != ".obj")
    throw std::invalid_argument(path.string() + ": the file's name must end in .obj");
  std::filesystem::path materials = path;
  materials.replace_extension(".mtl");
  // The second file is published while the first stands ready, so that none comes without the other.
  write_whole_file(path, [&](std::ostream& geometry) {
    geometry << geometry_text(scene, materials.filename().string()) << std::flush;
    if (!geometry) return;
    write_whole_file(materials, [&](std::ostream& out) { out << materials_text(scene); });
  });
}

}  // namespace exitance
