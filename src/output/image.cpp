#include "src/output/image.h"

#include <png.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

#include "geometry/spatial_index.h"
#include "src/output/face_rays.h"
#include "src/output/whole_file.h"
#include "src/scene/input_error.h"

namespace exitance {
namespace {

// Where in a pixel its samples lie, from its middle, in sixteenths: no two in the same row or column, no three in line.
// (Direct3D's standard pattern of eight.)
constexpr std::array<std::array<double, 2>, 8> kSamples = {
    {{1, -3}, {-1, 3}, {5, 1}, {-3, -5}, {-5, 5}, {-7, -1}, {3, 7}, {7, -7}}};

// Direction of the ray through any point of the picture.
class Lens {
 public:
  Lens(const Camera& camera, const ImageOptions& options) {
    const double angle = camera.vertical_fov_degrees;
    if (!(angle > 0 && angle < 180))
      throw std::invalid_argument("the camera's angle must lie between 0 and 180 degrees");
    const Vec3 view = camera.target - camera.eye;
    const Vec3 right = cross(view, camera.up);
    if (!(norm(right) > 0) || !is_finite(right)) {
      throw std::invalid_argument("the camera's eye, target and up direction must span a plane");
    }
    const double half_height = std::tan(angle * std::numbers::pi / 360);
    forward_ = normalized(view);
    right_ = half_height * options.width / options.height * normalized(right);
    up_ = half_height * cross(normalized(right), forward_);
  }

  /// x, y in [0, 1] from the top left.
  Vec3 direction(double x, double y) const { return forward_ + (2 * x - 1) * right_ + (1 - 2 * y) * up_; }

 private:
  Vec3 forward_, right_, up_;
};

Rgb mix(const Rgb& a, const Rgb& b, double t) {
  return {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])};
}

Rgb interpolate(const FaceHit& hit, std::span<const Rgb> of_point) {
  const Rgb &a = of_point[hit.corners[0]], &b = of_point[hit.corners[1]], &c = of_point[hit.corners[2]];
  if (hit.corner_count == 4) return mix(mix(a, b, hit.u), mix(of_point[hit.corners[3]], c, hit.u), hit.v);
  Rgb result{};
  for (std::size_t k = 0; k < 3; ++k) result[k] = (1 - hit.u - hit.v) * a[k] + hit.u * b[k] + hit.v * c[k];
  return result;
}

// What a sample shows: linear RGB, and whether it counts for the exposure.
struct Sample {
  std::array<float, 3> rgb{};
  bool counts = false;
};

}  // namespace

Image render(const Faces& faces, const Appearance& appearance, const Camera& camera, const ImageOptions& options) {
  if (options.width == 0 || options.height == 0) throw std::invalid_argument("a picture needs at least one pixel");
  const Lens lens(camera, options);
  const bool smooth = options.shading == Shading::smooth;
  const std::vector<Rgb> of_element = element_colours(appearance);
  const std::vector<Rgb> of_point = smooth ? point_colours(faces, appearance) : std::vector<Rgb>{};
  const FaceRays rays(faces, camera.eye);

  const std::size_t pixels = std::size_t{options.width} * options.height;
  std::vector<Sample> samples(pixels * kSamples.size());
  tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, options.height), [&](const auto& rows) {
    for (std::uint32_t y = rows.begin(); y < rows.end(); ++y) {
      for (std::uint32_t x = 0; x < options.width; ++x) {
        for (std::size_t k = 0; k < kSamples.size(); ++k) {
          const Vec3 direction = lens.direction((x + 0.5 + kSamples[k][0] / 16) / options.width,
                                                (y + 0.5 + kSamples[k][1] / 16) / options.height);
          const std::optional<FaceHit> hit = rays.first_front(direction);
          if (!hit) continue;
          const std::uint32_t e = faces.element(hit->face);
          const Rgb rgb = smooth ? interpolate(*hit, of_point) : of_element[e];
          Sample& sample = samples[(std::size_t{y} * options.width + x) * kSamples.size() + k];
          for (std::size_t c = 0; c < 3; ++c) sample.rgb[c] = static_cast<float>(rgb[c]);
          sample.counts = appearance.emits.empty() || appearance.emits[e] == 0;
        }
      }
    }
  });

  const auto rgb_of = [](const Sample& s) { return Rgb{s.rgb[0], s.rgb[1], s.rgb[2]}; };
  std::vector<std::pair<double, double>> shown;
  for (const Sample& s : samples) {
    if (s.counts) shown.emplace_back(luminance(rgb_of(s)), 1.0);
  }
  const ToneMap tone_map(bright_luminance(std::move(shown)));
  Image image{options.width, options.height, std::vector<std::uint8_t>(3 * pixels)};
  for (std::size_t p = 0; p < pixels; ++p) {
    Rgb mean{};  // of what is shown, so that the edge of a light source is no staircase
    for (std::size_t k = 0; k < kSamples.size(); ++k) {
      const Rgb mapped = tone_map(rgb_of(samples[p * kSamples.size() + k]));
      for (std::size_t c = 0; c < 3; ++c) mean[c] += mapped[c] / static_cast<double>(kSamples.size());
    }
    const auto bytes = srgb(mean);
    std::copy(bytes.begin(), bytes.end(), image.rgb.begin() + static_cast<std::ptrdiff_t>(3 * p));
  }
  return image;
}

void write_png(const std::filesystem::path& path, const Image& image) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = image.width;
  png.height = image.height;
  png.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::string bytes(size, '\0');
  if (png_image_write_to_memory(&png, bytes.data(), &size, 0, image.rgb.data(), 0, nullptr) == 0) {
    throw InputError(path.string(), 0, std::string("cannot be encoded as PNG: ") + png.message);
  }
  write_whole_file(path, [&](std::ostream& out) { out.write(bytes.data(), static_cast<std::streamsize>(size)); });
}

Camera default_camera(std::span<const Vec3> points, bool closed) {
  Box box;
  for (const Vec3& p : points) box.extend(p);
  Camera camera;
  if (points.empty()) {
    camera.eye = {1, 0, 0};
    return camera;
  }
  camera.target = 0.5 * (box.lower + box.upper);
  const Vec3 half = 0.5 * (box.upper - box.lower);
  if (closed) {
    camera.eye = camera.target + Vec3{-0.96 * half.x, -0.96 * half.y, 0.35 * half.z};
    camera.target = camera.target + Vec3{0, 0, -0.1 * half.z};
    camera.vertical_fov_degrees = 80;
  } else {
    // Far enough for the sphere around everything.
    const double distance = 1.1 * norm(half) / std::sin(camera.vertical_fov_degrees * std::numbers::pi / 360);
    camera.eye = camera.target + distance * normalized(Vec3{-0.55, -0.75, 0.35});
  }
  // Everything may lie in one point or on one vertical line.
  if (norm(cross(camera.target - camera.eye, camera.up)) == 0) camera.eye = camera.target + Vec3{1 + norm(half), 0, 0};
  return camera;
}

}  // namespace exitance
