// A bounding-volume tree over triangles: first hit of a ray, parity of a ray, nearest distance.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "geometry/triangle_mesh.h"

namespace geometry {

class TriangleTree {
 public:
  explicit TriangleTree(const TriangleMesh& mesh);

  // Distance along the unit `direction` to the first triangle hit beyond `from` (m); infinity where none is. Either side counts.
  double first_hit(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double from = 0) const;
  // Inside the closed surface, whatever its orientation (parity of a ray in a skew direction).
  bool contains(const Eigen::Vector3d& point) const;
  // m, to the nearest point of the surface.
  double distance(const Eigen::Vector3d& point) const;

 private:
  struct Node {
    Eigen::Vector3d low, high;
    std::int32_t first = 0, count = 0;  // count > 0: leaf over order_[first...]; else children at first and first + 1
  };
  void build(std::int32_t node, std::int32_t first, std::int32_t count, const std::vector<Eigen::Vector3d>& centers);
  template <class Visit>
  void along_ray(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, Visit&& visit) const;

  TriangleMesh mesh_;
  std::vector<std::int32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace geometry
