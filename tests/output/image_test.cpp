#include "src/output/image.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <xmmintrin.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "src/output/face_rays.h"
#include "tests/output/scratch_folder.h"

namespace exitance {
namespace {

using Pixel = std::array<std::uint8_t, 3>;

Pixel pixel(const Image& image, std::uint32_t x, std::uint32_t y) {
  const std::size_t at = 3 * (std::size_t{y} * image.width + x);
  return {image.rgb[at], image.rgb[at + 1], image.rgb[at + 2]};
}

std::vector<Vec3> square(double x0, double y0, double x1, double y1, double z) {
  return {{x0, y0, z}, {x1, y0, z}, {x1, y1, z}, {x0, y1, z}};
}

// From above onto the plane z = 0; the picture's x is x, its up is y, and it shows [−1, 1]².
Camera from_above(const Vec3& offset = {}) {
  return {offset + Vec3{0, 0, 1}, offset, {0, 1, 0}, 90};
}

// Four squares of one surface: red, green, blue, white; counter-clockwise from the lower left.
struct Quarters {
  Faces faces{1e-9};
  std::vector<double> B{1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1};
  explicit Quarters(const Vec3& offset = {}) {
    const std::array<std::vector<Vec3>, 4> loops{square(-1, -1, 0, 0, 0), square(0, -1, 1, 0, 0), square(0, 0, 1, 1, 0),
                                                 square(-1, 0, 0, 1, 0)};
    for (std::uint32_t e = 0; e < 4; ++e) {
      std::vector<Vec3> loop = loops[e];
      for (Vec3& p : loop) p = p + offset;
      faces.add(0, 0, e, loop);
    }
  }
  Appearance appearance() const { return {3, B, {}, {}}; }
};

TEST(Image, ShowsEachElementWhereItIs) {
  // The same far from the origin, where floats alone would see nothing of it.
  for (const Vec3& offset : {Vec3{0, 0, 0}, Vec3{1e6, -1e6, 1e6}}) {
    const Quarters scene(offset);
    const Image image = render(scene.faces, scene.appearance(), from_above(offset), {40, 40, Shading::constant});
    const Pixel lower_left = pixel(image, 1, 38), lower_right = pixel(image, 38, 38), upper_right = pixel(image, 38, 1),
                upper_left = pixel(image, 1, 1);
    EXPECT_TRUE(lower_left[0] > 200 && lower_left[1] == 0 && lower_left[2] == 0);
    EXPECT_TRUE(lower_right[1] > 200 && lower_right[0] == 0 && lower_right[2] == 0);
    EXPECT_TRUE(upper_right[2] > 200 && upper_right[0] == 0 && upper_right[1] == 0);
    EXPECT_TRUE(upper_left[0] > 200 && upper_left[0] == upper_left[1] && upper_left[1] == upper_left[2]);
    for (std::uint32_t x = 0; x < 19; ++x) EXPECT_EQ(pixel(image, x, 38), lower_left);  // constant, to the edge
  }
}

TEST(Image, SmoothShadingIsContinuousAndMeetsTheMeans) {
  const Quarters scene;
  const Image image = render(scene.faces, scene.appearance(), from_above(), {64, 64, Shading::smooth});
  for (std::uint32_t y = 0; y < 64; ++y) {
    for (std::uint32_t x = 1; x < 64; ++x) {
      for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(pixel(image, x, y)[c], pixel(image, x - 1, y)[c], 40);
    }
  }
  // In the middle all four meet: red, green and blue in equal parts.
  const Pixel middle = pixel(image, 32, 32);
  EXPECT_NEAR(middle[0], middle[1], 12);
  EXPECT_NEAR(middle[1], middle[2], 12);
}

TEST(Image, InterpolationIsLinearInTrianglesAndBilinearInQuadrilaterals) {
  // One triangle and one square beside it; corners are known by their weights.
  Faces faces(0);
  faces.add(0, 0, 0, std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  faces.add(1, 1, 1, square(2, 0, 3, 1, 0));
  const FaceRays rays(faces, {0, 0, 1});
  const auto triangle = rays.first_front({0.2, 0.3, -1});
  ASSERT_TRUE(triangle && triangle->face == 0);
  EXPECT_EQ(triangle->corner_count, 3u);
  EXPECT_NEAR(triangle->u, 0.2, 1e-6);
  EXPECT_NEAR(triangle->v, 0.3, 1e-6);
  for (const Vec3& at : {Vec3{2.25, 0.5, -1}, Vec3{2.9, 0.8, -1}}) {  // on both sides of the diagonal
    const auto quad = rays.first_front(at);
    ASSERT_TRUE(quad && quad->face == 1);
    EXPECT_EQ(quad->corner_count, 4u);
    EXPECT_NEAR(quad->u, at.x - 2, 1e-6);
    EXPECT_NEAR(quad->v, at.y, 1e-6);
  }
  EXPECT_FALSE(rays.first_front({1.5, 0.5, -1}));
  EXPECT_FALSE(rays.first_front({0.2, 0.3, 1}));
}

TEST(Image, PolygonsWithMoreCornersAreWhole) {
  Faces faces(0);
  faces.add(0, 0, 0, std::vector<Vec3>{{-1, -1, 0}, {1, -1, 0}, {2, 0, 0}, {1, 1, 0}, {-1, 1, 0}, {-2, 0, 0}});
  const FaceRays rays(faces, {0, 0, 1});
  for (const Vec3& at : {Vec3{0, 0, -1}, Vec3{1.7, 0, -1}, Vec3{-1.7, 0, -1}, Vec3{0, 0.9, -1}, Vec3{0, -0.9, -1}}) {
    EXPECT_TRUE(rays.first_front(at));
  }
  EXPECT_FALSE(rays.first_front({1.9, 0.5, -1}));
}

TEST(Image, WallsSeenFromBehindAreLookedThrough) {
  Faces faces(0);
  faces.add(0, 0, 0, square(-1, -1, 1, 1, 0));
  std::vector<Vec3> wall = square(-1, -1, 1, 1, 0.5);
  std::reverse(wall.begin(), wall.end());
  faces.add(1, 1, 1, wall);
  EXPECT_EQ(FaceRays(faces, {0, 0, 1}).first_front({0, 0, -1})->face, 0u);
  EXPECT_EQ(FaceRays(faces, {0, 0, 0.25}).first_front({0, 0, 1})->face, 1u);
}

TEST(Image, TheLaterOfCoincidingSurfacesLiesOnTop) {
  Faces faces(0);
  faces.add(0, 0, 0, square(-1, -1, 1, 1, 0));
  faces.add(1, 1, 1, square(-0.3, -0.4, 0.5, 0.6, 0));
  faces.add(2, 2, 2, square(-2, -2, 2, 2, -0.1));
  const FaceRays rays(faces, {0.1, 0.2, 0.7});
  for (double x = -0.29; x < 0.5; x += 0.013) {
    for (double y = -0.39; y < 0.6; y += 0.017) {
      EXPECT_EQ(rays.first_front(Vec3{x, y, 0} - Vec3{0.1, 0.2, 0.7})->face, 1u);
    }
  }
}

TEST(Image, LightSourcesClipToWhiteAndDoNotSetTheExposure) {
  Faces faces(0);
  faces.add(0, 0, 0, square(-1, -1, 1, 1, 0));
  faces.add(1, 1, 1, square(-0.5, -0.5, 0.5, 0.5, 0.1));
  const std::vector<double> B{0.1, 0.05, 0.02, 20, 15, 5};
  const std::vector<std::uint8_t> emits{0, 1};
  const Image image = render(faces, {3, B, emits, {}}, from_above(), {32, 32, Shading::smooth});
  EXPECT_EQ(pixel(image, 16, 16), (Pixel{255, 255, 255}));
  const Pixel floor = pixel(image, 1, 1);
  EXPECT_GT(floor[0], 200);
  EXPECT_TRUE(floor[0] > floor[1] && floor[1] > floor[2]);
}

TEST(Image, EdgesAreAntiAliased) {
  Faces faces(0);
  faces.add(0, 0, 0, std::vector<Vec3>{{-1, -1, 0}, {1, -1, 0}, {1, 0.7, 0}});
  const std::vector<double> B{1};
  const Image image = render(faces, {1, B, {}, {}}, from_above(), {64, 64, Shading::constant});
  std::set<std::uint8_t> greys;
  for (std::size_t k = 0; k < image.rgb.size(); k += 3) greys.insert(image.rgb[k]);
  EXPECT_GE(greys.size(), 5u);
}

TEST(Image, NothingToSeeIsBlack) {
  const Image image = render(Faces(0), {3, {}, {}, {}}, from_above(), {4, 4, Shading::smooth});
  EXPECT_THAT(image.rgb, testing::Each(0));
}

TEST(Image, ThreadsDoNotChangeABit) {
  const Quarters scene;
  const auto with_threads = [&](std::size_t threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    return render(scene.faces, scene.appearance(), from_above(), {100, 100, Shading::smooth}).rgb;
  };
  EXPECT_EQ(with_threads(1), with_threads(4));
}

TEST(Image, FloatingPointModeIsLeftAlone) {
  // Flush-to-zero (bit 15) and denormals-are-zero (bit 6) would break exact predicates, here and in worker threads.
  const Quarters scene;
  const unsigned before = _mm_getcsr() & ~0x3fu;  // without the sticky flags
  render(scene.faces, scene.appearance(), from_above(), {64, 64, Shading::smooth});
  EXPECT_EQ(_mm_getcsr() & ~0x3fu, before);
  tbb::parallel_for(0, 1000, [&](int) { EXPECT_EQ(_mm_getcsr() & 0x8040u, 0u); });
}

TEST(Image, CamerasThatLookNowhereAreRefused) {
  const Quarters scene;
  const auto refused = [&](const Camera& camera) {
    EXPECT_THROW(render(scene.faces, scene.appearance(), camera, {4, 4, Shading::smooth}), std::invalid_argument);
  };
  refused({{0, 0, 1}, {0, 0, 1}, {0, 1, 0}, 40});
  refused({{0, 0, 1}, {0, 0, 0}, {0, 0, 1}, 40});
  refused({{0, 0, 1}, {0, 0, 0}, {0, 1, 0}, 180});
  refused({{0, 0, 1}, {0, 0, 0}, {0, 1, 0}, 0});
  EXPECT_THROW(render(scene.faces, scene.appearance(), from_above(), {0, 4, Shading::smooth}), std::invalid_argument);
}

TEST(Image, DefaultCameraIsInsideAClosedSceneAndSeesAllOfAnOpenOne) {
  const std::vector<Vec3> corners{{0, 0, 0}, {4, 3, 2.5}};
  const Camera inside = default_camera(corners, true);
  EXPECT_TRUE(inside.eye.x > 0 && inside.eye.x < 4 && inside.eye.y > 0 && inside.eye.y < 3 && inside.eye.z > 0 &&
              inside.eye.z < 2.5);
  const Camera outside = default_camera(corners, false);
  const Vec3 view = normalized(outside.target - outside.eye);
  for (unsigned k = 0; k < 8; ++k) {
    const Vec3 corner{k & 1u ? 4.0 : 0.0, k & 2u ? 3.0 : 0.0, k & 4u ? 2.5 : 0.0};
    const double cosine = dot(normalized(corner - outside.eye), view);
    EXPECT_GT(cosine, std::cos(outside.vertical_fov_degrees / 2 * 3.14159265358979 / 180));
  }
  const Quarters scene;
  for (const auto& points :
       {std::vector<Vec3>{}, std::vector<Vec3>{{1, 1, 1}}, std::vector<Vec3>{{0, 0, 0}, {0, 0, 2}}}) {
    for (const bool closed : {true, false}) {
      EXPECT_NO_THROW(render(scene.faces, scene.appearance(), default_camera(points, closed), {2, 2, Shading::smooth}));
    }
  }
}

TEST(Image, PngComesBackAsWritten) {
  const ScratchFolder folder;
  Image image{3, 2, {}};
  for (std::uint8_t k = 0; k < 18; ++k) image.rgb.push_back(static_cast<std::uint8_t>(13 * k));
  write_png(folder / "i.png", image);
  png_image read{};
  read.version = PNG_IMAGE_VERSION;
  ASSERT_TRUE(png_image_begin_read_from_file(&read, (folder / "i.png").c_str()));
  EXPECT_EQ(read.width, 3u);
  EXPECT_EQ(read.height, 2u);
  read.format = PNG_FORMAT_RGB;
  std::vector<std::uint8_t> rgb(PNG_IMAGE_SIZE(read));
  ASSERT_TRUE(png_image_finish_read(&read, nullptr, rgb.data(), 0, nullptr));
  EXPECT_EQ(rgb, image.rgb);
}

}  // namespace
}  // namespace exitance
