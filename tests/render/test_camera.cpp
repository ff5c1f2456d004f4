#include "render/camera.h"

#include <gtest/gtest.h>

#include <cmath>

namespace render {
namespace {

Bounds ball(const Eigen::Vector3f& center, float radius) {
  Bounds bounds;
  bounds.add(center, radius);
  return bounds;
}

TEST(Camera, orthographic_puts_points_by_pixels_per_metre) {
  Camera camera;
  camera.target = {1, 2, 3};
  camera.width = 2;
  camera.height = 1;
  const Projection p = project(camera, 400, 200, ball(camera.target, 1));
  EXPECT_FLOAT_EQ(p.pixels_per_metre, 200);
  EXPECT_NEAR((to_pixel(p, {1, 2, 3}) - Eigen::Vector3f(200, 100, 0)).head<2>().norm(), 0, 1e-3);
  EXPECT_NEAR((to_pixel(p, {1.5f, 2.25f, 3.4f}) - Eigen::Vector3f(300, 50, 0)).head<2>().norm(), 0, 1e-3);
}

TEST(Camera, perspective_is_exact_at_the_target_and_smaller_behind_it) {
  Camera camera;
  camera.width = camera.height = 1;
  camera.field_of_view = 0.6f;
  const Projection p = project(camera, 300, 300, ball({0, 0, 0}, 1));
  EXPECT_NEAR(to_pixel(p, {0.25f, 0, 0}).x(), 150 + 75, 1e-2);
  const float distance = 0.5f / std::tan(0.3f);
  EXPECT_NEAR(to_pixel(p, {0.25f, 0, -0.5f}).x(), 150 + 75 * distance / (distance + 0.5f), 1e-2);
}

TEST(Camera, fits_the_wider_need_and_makes_room_at_the_right) {
  Camera camera;
  camera.width = 4;
  camera.height = 1;
  EXPECT_FLOAT_EQ(project(camera, 400, 400, {}).pixels_per_metre, 100);
  for (const float field_of_view : {0.0f, 0.5f}) {
    camera.field_of_view = field_of_view;
    const Projection p = project(camera, 500, 400, ball({0, 0, 0}, 2), 100);
    EXPECT_NEAR(p.pixels_per_metre, 100, 1e-3);
    EXPECT_NEAR(to_pixel(p, {0, 0, 0}).x(), 200, 1e-2);
    EXPECT_NEAR(to_pixel(p, {2, 0, 0}).x(), 400, 1e-2);
  }
}

TEST(Camera, nearer_points_have_smaller_depth_and_all_lie_between_the_planes) {
  for (const float field_of_view : {0.0f, 0.5f}) {
    Camera camera;
    camera.width = camera.height = 2;
    camera.field_of_view = field_of_view;
    const Projection p = project(camera, 100, 100, ball({0, 0, 0}, 1));
    const float near = to_pixel(p, {0, 0, 1}).z(), middle = to_pixel(p, {0, 0, 0}).z(), far = to_pixel(p, {0, 0, -1}).z();
    EXPECT_GT(near, 0);
    EXPECT_LT(near, middle);
    EXPECT_LT(middle, far);
    EXPECT_LT(far, 1);
  }
}

TEST(Camera, standard_views_look_the_way_their_names_say) {
  const Eigen::Vector3f axis(0, 0, 1), side(1, 0, 0), center(0, 0, 0);
  const auto at = [&](StandardView view, const Eigen::Vector3f& point) {
    return to_pixel(project(standard_camera(view, center, axis, side, 2, 2), 200, 200, ball(center, 2)), point);
  };
  EXPECT_LT(at(StandardView::long_axis, {0, 0, 0.5f}).y(), 100);                                             // the aorta upwards
  EXPECT_LT(at(StandardView::long_axis, {0.5f, 0, 0}).z(), at(StandardView::long_axis, {-0.5f, 0, 0}).z());  // the side towards the eye
  EXPECT_GT(at(StandardView::short_axis, {0.5f, 0, 0}).x(), 100);
  EXPECT_LT(at(StandardView::from_aorta, {0, 0, 0.5f}).z(), at(StandardView::from_aorta, {0, 0, -0.5f}).z());
  EXPECT_GT(at(StandardView::from_aorta, {0.5f, 0, 0}).x(), 100);
  EXPECT_GT(at(StandardView::from_ventricle, {0, 0, 0.5f}).z(), at(StandardView::from_ventricle, {0, 0, -0.5f}).z());
  EXPECT_GT(at(StandardView::from_ventricle, {0.5f, 0, 0}).x(), 100);
  // Seen from the two sides, y lies on opposite sides.
  EXPECT_LT((at(StandardView::from_aorta, {0, 0.5f, 0}).y() - 100) * (at(StandardView::from_ventricle, {0, 0.5f, 0}).y() - 100), 0);
}

TEST(Camera, an_upright_along_the_line_of_sight_still_gives_a_picture) {
  Camera camera;
  camera.backward = camera.up = Eigen::Vector3f::UnitZ();
  EXPECT_TRUE(to_pixel(project(camera, 10, 10, {}), {0.1f, 0.1f, 0}).allFinite());
}

TEST(Camera, flat_camera_holds_the_whole_scene) {
  Bounds bounds;
  bounds.add({-1, 2, 0});
  bounds.add({3, 3, 0});
  const Projection p = project(flat_camera(bounds), 640, 480, bounds);
  for (const Eigen::Vector3f& corner : {Eigen::Vector3f(-1, 2, 0), Eigen::Vector3f(3, 3, 0)}) {
    const Eigen::Vector3f pixel = to_pixel(p, corner);
    EXPECT_GT(pixel.x(), 0);
    EXPECT_LT(pixel.x(), 640);
    EXPECT_GT(pixel.y(), 0);
    EXPECT_LT(pixel.y(), 480);
  }
}

}  // namespace
}  // namespace render
