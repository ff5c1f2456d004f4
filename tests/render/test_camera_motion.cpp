#include "render/camera_motion.h"

#include <gtest/gtest.h>

#include <cmath>

namespace render {
namespace {

const Camera front{{0, 0, 0}, {0, 0, 1}, {0, 1, 0}, 0.02f, 0.01f, 0};

TEST(CameraMotion, between_two_cameras_turns_along_the_shortest_arc) {
  const Camera side{{0.01f, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0.04f, 0.03f, 0.5f};
  const Camera half = between(front, side, 0.5);
  EXPECT_NEAR((half.backward - Eigen::Vector3f(1, 0, 1).normalized()).norm(), 0, 1e-5);
  EXPECT_NEAR((half.up - Eigen::Vector3f::UnitY()).norm(), 0, 1e-5);
  EXPECT_NEAR(half.width, 0.03f, 1e-6);
  EXPECT_NEAR(half.target.x(), 0.005f, 1e-6);
  EXPECT_EQ(between(front, side, 0).field_of_view, 0);
  EXPECT_EQ(between(front, side, 1).width, 0.04f);
  EXPECT_EQ(eased(0), 0);
  EXPECT_EQ(eased(0.5), 0.5);
  EXPECT_EQ(eased(2), 1);
}

// What lies before the target follows the mouse.
TEST(CameraMotion, orbit_and_pan_follow_the_mouse) {
  const Bounds bounds{{-0.01f, -0.01f, -0.01f}, {0.01f, 0.01f, 0.01f}};
  const Eigen::Vector3f nose(0, 0, 0.004f);
  const Projection before = project(front, 400, 400, bounds);
  const Eigen::Vector3f start = to_pixel(before, nose);
  const Eigen::Vector3f right = to_pixel(project(orbited(front, 0.2f, 0), 400, 400, bounds), nose);
  EXPECT_GT(right.x(), start.x() + 5);
  EXPECT_NEAR(right.y(), start.y(), 1e-2);
  EXPECT_GT(to_pixel(project(orbited(front, 0, 0.2f), 400, 400, bounds), nose).y(), start.y() + 5);
  const Eigen::Vector3f panned_to = to_pixel(project(panned(front, 0.002f, 0.001f), 400, 400, bounds), nose);
  EXPECT_NEAR(panned_to.x() - start.x(), 0.002f * before.pixels_per_metre, 0.1);
  EXPECT_NEAR(panned_to.y() - start.y(), 0.001f * before.pixels_per_metre, 0.1);
}

TEST(CameraMotion, zoom_scales_and_stops) {
  EXPECT_NEAR(zoomed(front, 2, 0.02f).width, 0.01f, 1e-7);
  EXPECT_NEAR(zoomed(front, 2, 0.02f).height, 0.005f, 1e-7);
  EXPECT_NEAR(zoomed(front, 1e9f, 0.02f).width, 0.0004f, 1e-7);
}

}  // namespace
}  // namespace render
