// How much of a curved body each of its particles stands for.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "geometry/point_grid.h"
#include "geometry/shape.h"

namespace geometry {

struct Cells {
  std::vector<double> volume;             // m³ (2-D: m²)
  std::vector<Eigen::Vector3d> centroid;  // m, seen from the particle
};

// Volume and centroid of the part of the shape that is nearer to each particle than to any other: its Voronoi cell, cut at the surface.
// By sampling (a quarter of a spacing apart, in 2-D an eighth), samples near a face between two cells shared between them: right to about
// 0.1 % of a cell. Relaxed particles are evenly spaced, yet with equal volumes a sum over them would lie up to a tenth of a spacing beside
// the body's own middle, which bends a thin ring. depth: of each particle below the surface, m.
Cells cell_volumes(const Shape& shape, const std::vector<Eigen::Vector3d>& position, const std::vector<double>& depth, int dimension,
                   double spacing, const PeriodicBox& box = {});

}  // namespace geometry
