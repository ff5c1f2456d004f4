#include "render/camera.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace render {

void Bounds::add(const Eigen::Vector3f& point, float radius) {
  min = min.cwiseMin(point - Eigen::Vector3f::Constant(radius));
  max = max.cwiseMax(point + Eigen::Vector3f::Constant(radius));
}

void Bounds::add(const Bounds& other) {
  min = min.cwiseMin(other.min);
  max = max.cwiseMax(other.max);
}

namespace {

Eigen::Matrix4f look_along(const Camera& camera, const Eigen::Vector3f& eye) {
  const Eigen::Vector3f back = camera.backward.normalized();
  Eigen::Vector3f right = camera.up.cross(back);
  if (right.norm() < 1e-6f) right = back.unitOrthogonal();  // up along the line of sight: any upright will do
  right.normalize();
  const Eigen::Vector3f up = back.cross(right);
  Eigen::Matrix4f view = Eigen::Matrix4f::Identity();
  view.block<1, 3>(0, 0) = right.transpose();
  view.block<1, 3>(1, 0) = up.transpose();
  view.block<1, 3>(2, 0) = back.transpose();
  view.block<3, 1>(0, 3) = -view.block<3, 3>(0, 0) * eye;
  return view;
}

}  // namespace

Projection project(const Camera& camera, int width, int height, const Bounds& bounds, int reserved_right) {
  Projection result;
  result.width = width;
  result.height = height;
  const float aspect = static_cast<float>(width) / static_cast<float>(height);
  const float reserved = std::min(static_cast<float>(reserved_right) / static_cast<float>(width), 0.5f);
  const float visible_height = std::max(camera.height, camera.width / (aspect * (1 - reserved))), visible_width = visible_height * aspect;
  result.pixels_per_metre = static_cast<float>(height) / visible_height;
  const Eigen::Vector3f back = camera.backward.normalized();
  const float reach = bounds.empty() ? visible_height : 1.01f * bounds.radius() + 1e-6f;  // m, of the ball round everything
  result.perspective = camera.field_of_view > 0;
  if (result.perspective) {
    const float distance = 0.5f * visible_height / std::tan(0.5f * camera.field_of_view);
    const Eigen::Vector3f eye = camera.target + distance * back;
    const float depth = bounds.empty() ? distance : back.dot(eye - bounds.center());
    result.near = std::max(depth - reach, 0.02f * distance);
    result.far = std::max(depth + reach, 1.1f * result.near);
    result.view = look_along(camera, eye);
    const float scale = 2 * distance;
    result.projection.setZero();
    result.projection(0, 0) = scale / visible_width;
    result.projection(1, 1) = scale / visible_height;
    result.projection(0, 2) = reserved;  // times z / -z
    result.projection(2, 2) = -(result.far + result.near) / (result.far - result.near);
    result.projection(2, 3) = -2 * result.far * result.near / (result.far - result.near);
    result.projection(3, 2) = -1;
  } else {
    const Eigen::Vector3f middle = bounds.empty() ? camera.target : bounds.center();
    const Eigen::Vector3f eye = camera.target + (back.dot(middle - camera.target) + 1.1f * reach) * back;
    result.near = 0.1f * reach * 0.5f;
    result.far = 2.2f * reach;
    result.view = look_along(camera, eye);
    result.projection(0, 0) = 2 / visible_width;
    result.projection(1, 1) = 2 / visible_height;
    result.projection(0, 3) = -reserved;
    result.projection(2, 2) = -2 / (result.far - result.near);
    result.projection(2, 3) = -(result.far + result.near) / (result.far - result.near);
  }
  return result;
}

Eigen::Vector3f to_pixel(const Projection& projection, const Eigen::Vector3f& point) {
  const Eigen::Vector4f clip = projection.projection * projection.view * point.homogeneous();
  const Eigen::Vector3f ndc = clip.head<3>() / clip.w();
  return {0.5f * (ndc.x() + 1) * static_cast<float>(projection.width), 0.5f * (1 - ndc.y()) * static_cast<float>(projection.height),
          0.5f * (ndc.z() + 1)};
}

Camera standard_camera(StandardView view, const Eigen::Vector3f& center, const Eigen::Vector3f& axis, const Eigen::Vector3f& side,
                       float width, float height) {
  constexpr float surgeon_field_of_view = 0.5f;  // rad: some perspective lets the eye see down the vessel's wall
  Eigen::Vector3f across = side - axis * axis.dot(side);
  across = across.norm() > 1e-6f ? across.normalized() : axis.unitOrthogonal();
  Camera camera;
  camera.target = center;
  camera.width = width;
  camera.height = height;
  switch (view) {
    case StandardView::long_axis:
      camera.backward = across;
      camera.up = axis;
      break;
    case StandardView::short_axis:
    case StandardView::from_aorta:
      camera.backward = axis;
      camera.up = axis.cross(across);  // `side` to the right
      break;
    case StandardView::from_ventricle:
      camera.backward = -axis;
      camera.up = (-axis).cross(across);
      break;
  }
  if (view == StandardView::from_aorta || view == StandardView::from_ventricle) camera.field_of_view = surgeon_field_of_view;
  return camera;
}

Camera flat_camera(const Bounds& bounds, float margin) {
  Camera camera;
  if (bounds.empty()) return camera;
  camera.target = bounds.center();
  const Eigen::Vector3f size = bounds.max - bounds.min;
  const float pad = 2 * margin * std::max(size.x(), size.y());
  camera.width = std::max(size.x() + pad, 1e-6f);
  camera.height = std::max(size.y() + pad, 1e-6f);
  return camera;
}

}  // namespace render
