// Signed distance to a closed triangle surface, cached on a regular grid: exact at grid points in a band about the surface, sign by
// scanline parity (right for meshes of either orientation), trilinear in between.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "geometry/triangle_mesh.h"

namespace geometry {

class SignedDistanceGrid {
 public:
  // `spacing` m between grid points (half the particle spacing is a good choice); distances are exact at grid points nearer than `band`
  // (m, >= 2 spacing) to the surface. Throws std::runtime_error where the grid would need more than 400 million points.
  SignedDistanceGrid(const TriangleMesh& mesh, double spacing, double band);

  // m, negative inside. Beyond the band +-band or more; outside the grid's box a lower bound.
  double distance(const Eigen::Vector3d& point) const;
  double spacing() const { return spacing_; }
  double band() const { return band_; }
  const Eigen::Vector3d& min() const { return origin_; }
  std::size_t size() const { return values_.size(); }

 private:
  Eigen::Vector3d origin_;
  double spacing_, band_;
  std::array<int, 3> count_;
  std::vector<float> values_;
};

// Exact squared distance, m², from a point to a triangle (Ericson, Real-Time Collision Detection, 5.1.5); `closest` gets the foot.
double squared_distance_to_triangle(const Eigen::Vector3d& point, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                    const Eigen::Vector3d& c, Eigen::Vector3d* closest = nullptr);

// Volume enclosed by a closed mesh (divergence theorem), m³; negative where it is oriented inward.
double enclosed_volume(const TriangleMesh& mesh);

}  // namespace geometry
