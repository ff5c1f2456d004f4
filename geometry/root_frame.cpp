#include "geometry/root_frame.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <stdexcept>

#include "geometry/triangle_tree.h"

namespace geometry {

using Eigen::Vector3d;

Vector3d RootFrame::to_world(double radius, double theta, double z) const {
  return origin + radius * (std::cos(theta) * x_axis + std::sin(theta) * y_axis) + z * axis;
}

Vector3d RootFrame::to_local(const Vector3d& world) const {
  const Vector3d d = world - origin;
  return {d.dot(x_axis), d.dot(y_axis), d.dot(axis)};
}

RootFrame make_root_frame(const AorticRoot& root) {
  constexpr double turn = 2 * std::numbers::pi;
  RootFrame frame;
  frame.origin = root.annulus.center;
  frame.axis = (root.sinotubular_junction.center - root.annulus.center).normalized();
  const Vector3d toward = root.commissures[0] - frame.origin;  // theta = 0 at the first commissure
  frame.x_axis = (toward - toward.dot(frame.axis) * frame.axis).normalized();
  frame.y_axis = frame.axis.cross(frame.x_axis);
  frame.junction_height = (root.sinotubular_junction.center - root.annulus.center).norm();
  frame.annulus_radius = root.annulus.mean_diameter / 2;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector3d commissure = frame.to_local(root.commissures[i]), nadir = frame.to_local(root.nadirs[i]);
    const double angle = std::atan2(commissure.y(), commissure.x());
    frame.commissure_angles[i] = angle < -1e-12 ? angle + turn : std::max(0.0, angle);
    frame.commissure_heights[i] = commissure.z();
    frame.nadir_angles[i] = std::atan2(nadir.y(), nadir.x());
    frame.nadir_heights[i] = nadir.z();
  }
  for (std::size_t i = 0; i < 3; ++i)
    while (frame.nadir_angles[i] < frame.commissure_angles[i]) frame.nadir_angles[i] += turn;
  return frame;
}

struct WallRadius::Tree {
  explicit Tree(const TriangleMesh& lumen) : triangles(lumen) {}
  TriangleTree triangles;
};

WallRadius::WallRadius(const TriangleMesh& lumen, const RootFrame& frame) : tree_(std::make_shared<const Tree>(lumen)), frame_(frame) {}

double WallRadius::radius_at(double theta, double z) const {
  const Vector3d from = frame_.origin + z * frame_.axis;
  const double radius = tree_->triangles.first_hit(from, std::cos(theta) * frame_.x_axis + std::sin(theta) * frame_.y_axis);
  if (std::isinf(radius) || !tree_->triangles.contains(from)) {
    char text[160];
    std::snprintf(text, sizeof text, "the root's axis leaves the lumen %.1f mm above the annulus; give the annulus and junction planes",
                  1e3 * z);
    throw std::runtime_error(text);
  }
  return radius;
}

}  // namespace geometry
