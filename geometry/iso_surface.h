// The surface of a shape as small flat elements: a closed surface, so that their vector areas sum to zero.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "geometry/shape.h"

namespace geometry {

struct SurfaceElement {
  Eigen::Vector3d center;  // m
  Eigen::Vector3d area;    // m², outward (2-D: m)
};

// Marching tetrahedra (2-D: triangles) on a grid of `spacing` m over the shape's bounding box.
std::vector<SurfaceElement> surface_elements(const Shape& shape, int dimension, double spacing);

}  // namespace geometry
