#include "src/output/ply.h"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cstring>

#include "src/output/whole_file.h"

namespace exitance {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are written as they stand in memory");

template <typename T>
void put(std::ostream& out, const T& value) {
  std::array<char, sizeof(T)> bytes{};
  std::memcpy(bytes.data(), &value, sizeof(T));
  out.write(bytes.data(), bytes.size());
}

ToneMap tone_map_by_area(const Faces& faces, const Appearance& a, std::span<const Rgb> colours) {
  std::vector<std::pair<double, double>> shown;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const std::uint32_t e = faces.element(f);
    if (a.emits.empty() || a.emits[e] == 0) shown.emplace_back(luminance(colours[e]), faces.area(f));
  }
  return ToneMap(bright_luminance(std::move(shown)));
}

void write_header(std::ostream& out, std::size_t vertices, std::size_t faces) {
  out << "ply\nformat binary_little_endian 1.0\ncomment radiosity solution, tone-mapped, sRGB\n"
      << fmt::format("element vertex {}\n", vertices)
      << "property double x\nproperty double y\nproperty double z\n"
         "property uchar red\nproperty uchar green\nproperty uchar blue\n"
      << fmt::format("element face {}\nproperty list uint int vertex_indices\nend_header\n", faces);
}

void put_vertex(std::ostream& out, const Vec3& p, const Rgb& shown) {
  put(out, p.x);
  put(out, p.y);
  put(out, p.z);
  put(out, srgb(shown));
}

}  // namespace

void write_ply(const std::filesystem::path& path, const Faces& faces, const Appearance& appearance, Shading shading) {
  const std::vector<Rgb> of_element = element_colours(appearance);
  const ToneMap tone_map = tone_map_by_area(faces, appearance, of_element);
  const bool smooth = shading == Shading::smooth;
  const std::vector<Rgb> of_point = smooth ? point_colours(faces, appearance) : std::vector<Rgb>{};
  std::size_t corners = 0;
  for (std::size_t f = 0; f < faces.size(); ++f) corners += faces.corners(f).size();

  write_whole_file(path, [&](std::ostream& out) {
    write_header(out, smooth ? faces.points().size() : corners, faces.size());
    for (std::size_t p = 0; p < of_point.size(); ++p) put_vertex(out, faces.points()[p], tone_map(of_point[p]));
    for (std::size_t f = 0; f < faces.size() && !smooth; ++f) {
      for (const std::uint32_t p : faces.corners(f)) {
        put_vertex(out, faces.points()[p], tone_map(of_element[faces.element(f)]));
      }
    }
    std::uint32_t next = 0;
    for (std::size_t f = 0; f < faces.size(); ++f) {
      put(out, static_cast<std::uint32_t>(faces.corners(f).size()));
      for (const std::uint32_t p : faces.corners(f)) put(out, smooth ? p : next++);
    }
  });
}

}  // namespace exitance
