#include "geometry/vec3.h"

#include <gtest/gtest.h>

namespace exitance {
namespace {

TEST(Vec3, CrossIsRightHanded) {
  EXPECT_EQ(cross(Vec3{1, 0, 0}, Vec3{0, 1, 0}), (Vec3{0, 0, 1}));
  EXPECT_EQ(dot(Vec3{1, 2, 3}, Vec3{4, 5, 6}), 32);
}

}  // namespace
}  // namespace exitance
