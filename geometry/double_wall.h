// Vessels given as a wall with thickness: an outer and an inner surface. The blood is inside the inner one.
#pragma once

#include <Eigen/Core>
#include <string>

#include "geometry/triangle_mesh.h"

namespace geometry {

struct DoubleWall {
  bool found = false;
  bool reduced = false;                          // the mesh is now the inner surface alone
  Eigen::Vector3d at = Eigen::Vector3d::Zero();  // m, where the two walls show side by side
  std::size_t triangles_dropped = 0;             // of the outer surface
  std::string reason;                            // why it could not be reduced
};

// Looks for a surface nested in another (two components) or for two rims round each other at one end (walls joined elsewhere).
// The mesh is welded, components consistently oriented. Where each outer surface has its inner one as a component of its own, keeps the
// inner.
DoubleWall reduce_double_wall(TriangleMesh& mesh);

}  // namespace geometry
