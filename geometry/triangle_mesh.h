// A surface as triangles. Lengths in metres from load_mesh on; `load_mesh` alone converts.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace geometry {

struct TriangleMesh {
  std::vector<Eigen::Vector3d> vertices;               // m
  std::vector<std::array<std::int32_t, 3>> triangles;  // indices into vertices; outward by the right-hand rule where closed
  bool empty() const { return triangles.empty(); }
};

}  // namespace geometry
