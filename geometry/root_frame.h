// The cylindrical frame of a root in which a valve is designed: z = 0 at the annulus's centre, z along the axis towards the junction's
// centre, theta counter-clockwise from x_axis.
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>

#include "geometry/aortic_root.h"

namespace geometry {

struct RootFrame {
  Eigen::Vector3d origin, x_axis, y_axis, axis;  // m; unit, right-handed (x, y, axis)
  double junction_height = 0;                    // m, z of the sinotubular junction's centre
  double annulus_radius = 0;                     // m, mean
  std::array<double, 3> commissure_angles{};     // rad, increasing within [0, 2 pi)
  std::array<double, 3> commissure_heights{};    // m, z
  std::array<double, 3> nadir_angles{};          // rad; nadir i between commissures i and i+1 (may exceed 2 pi)
  std::array<double, 3> nadir_heights{};         // m, z
  Eigen::Vector3d to_world(double radius, double theta, double z) const;
  Eigen::Vector3d to_local(const Eigen::Vector3d& world) const;  // (x, y, z) in the frame, m
};

RootFrame make_root_frame(const AorticRoot& root);

// R(theta, z): distance from the axis to the wall along a ray, first hit. Owns its own search tree; cheap to copy.
class WallRadius {
 public:
  WallRadius(const TriangleMesh& lumen, const RootFrame& frame);
  // m; throws std::runtime_error where the ray leaves the lumen without a hit or starts outside it.
  double radius_at(double theta, double z) const;
  const RootFrame& frame() const { return frame_; }

 private:
  struct Tree;
  std::shared_ptr<const Tree> tree_;
  RootFrame frame_;
};

}  // namespace geometry
