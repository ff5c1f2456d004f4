#include "render/camera_motion.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace render {
namespace {

// The camera's axes in space: right, up, backward as columns.
Eigen::Matrix3f axes_of(const Camera& camera) {
  const Eigen::Vector3f back = camera.backward.normalized();
  Eigen::Vector3f right = camera.up.cross(back);
  right = right.norm() > 1e-6f ? right.normalized() : back.unitOrthogonal();
  Eigen::Matrix3f axes;
  axes << right, back.cross(right), back;
  return axes;
}

void turn_to(Camera& camera, const Eigen::Matrix3f& axes) {
  camera.up = axes.col(1);
  camera.backward = axes.col(2);
}

}  // namespace

double eased(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

Camera between(const Camera& from, const Camera& to, double t) {
  if (t <= 0) return from;
  if (t >= 1) return to;
  constexpr float flat = 0.02f;  // rad: stands for no perspective while the camera moves
  const auto part = static_cast<float>(t);
  const auto blended = [part](float a, float b) { return a + part * (b - a); };
  Camera camera;
  camera.target = from.target + part * (to.target - from.target);
  camera.width = blended(from.width, to.width);
  camera.height = blended(from.height, to.height);
  if (from.field_of_view > 0 || to.field_of_view > 0)
    camera.field_of_view = blended(std::max(from.field_of_view, flat), std::max(to.field_of_view, flat));
  const Eigen::Quaternionf start(axes_of(from)), end(axes_of(to));
  turn_to(camera, start.slerp(part, end).normalized().toRotationMatrix());
  return camera;
}

Camera orbited(const Camera& camera, float right, float down) {
  const Eigen::Matrix3f axes = axes_of(camera);
  const Eigen::Matrix3f turn = (Eigen::AngleAxisf(-right, axes.col(1)) * Eigen::AngleAxisf(-down, axes.col(0))).toRotationMatrix();
  Camera result = camera;
  turn_to(result, turn * axes);
  return result;
}

Camera panned(const Camera& camera, float right, float down) {
  const Eigen::Matrix3f axes = axes_of(camera);
  Camera result = camera;
  result.target += -right * axes.col(0) + down * axes.col(1);
  return result;
}

Camera zoomed(const Camera& camera, float factor, float whole) {
  Camera result = camera;
  const float wanted = std::clamp(camera.width / factor, whole / 50, whole * 50), scale = wanted / camera.width;
  result.width *= scale;
  result.height *= scale;
  return result;
}

}  // namespace render
