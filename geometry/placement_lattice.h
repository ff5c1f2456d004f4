// The lattice that bodies share: cells between planes; even spacing between the planes of straight bodies, so that particle planes lie
// half a cell on either side of every such face.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "geometry/place_particles.h"
#include "geometry/point_grid.h"

namespace geometry {

struct PlacementLattice {
  int dimension = 3;
  std::array<std::vector<double>, 3> edge;  // cell boundaries along each axis, increasing, m
  PeriodicBox periodic;
  BoundingBox bodies;  // of the bodies it was made for; cells may reach beyond
  int count(int axis) const { return int(edge[axis].size()) - 1; }
  std::size_t size() const { return std::size_t(count(0)) * count(1) * count(2); }
  std::size_t index(int i, int j, int k) const { return i + std::size_t(count(0)) * (j + std::size_t(count(1)) * k); }
  std::array<int, 3> cell(std::size_t index) const;
  Eigen::Vector3d center(const std::array<int, 3>& cell) const;
  Eigen::Vector3d pitch(const std::array<int, 3>& cell) const;  // m; z is 1 in 2-D
  double smallest_pitch(const std::array<int, 3>& cell) const;
  double volume(const std::array<int, 3>& cell) const { return pitch(cell).prod(); }
  // The cell `offset` away, wrapped; false where it lies outside.
  bool neighbor(const std::array<int, 3>& cell, const std::array<int, 3>& offset, std::array<int, 3>& result) const;
};

// All faces are parts of planes x, y or z = constant.
bool is_rectilinear(const Shape& shape, int dimension);

// Places of the faces square to `axis` in all parts of a shape, within its bounding box; sorted, without repetition.
std::vector<double> face_planes(const Shape& shape, int dimension, int axis);

// A lattice over the given bodies (indices into `bodies`); earlier ones have the say where planes are nearer than half a spacing.
PlacementLattice make_placement_lattice(const std::vector<PlacedBody>& bodies, const std::vector<int>& members,
                                        const PlacementOptions& options);

// Volume of a rectilinear shape, exact.
double rectilinear_volume(const Shape& shape, int dimension);

// Volume of any shape, m³ (2-D: m²): full cells plus cut cells, these by small parts.
double cut_cell_volume(const Shape& shape, const PlacementLattice& lattice);

}  // namespace geometry
