// A lattice over a closed surface: inside test by scanline parity, exact distance transform, connected parts.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "geometry/triangle_mesh.h"

namespace geometry {

struct VoxelGrid {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  // m, centre of voxel (0,0,0)
  double spacing = 0;                                // m
  std::array<int, 3> size{};                         // voxels along x, y, z; x runs fastest
  std::vector<std::uint8_t> inside;                  // 1 = centre inside the surface

  std::size_t index(int i, int j, int k) const { return std::size_t(i) + size[0] * (std::size_t(j) + std::size_t(size[1]) * k); }
  Eigen::Vector3d center(int i, int j, int k) const { return origin + spacing * Eigen::Vector3d(i, j, k); }
  std::array<int, 3> coordinates(std::size_t index) const;
  // Nearest voxel, clamped to the grid.
  std::array<int, 3> nearest(const Eigen::Vector3d& point) const;
};

// Lattice points of the closed `mesh` by even-odd crossings along x: exact for points that are not on the surface; a lattice point that
// falls on an edge is decided consistently (half-open rule), so no ray leaks. `padding` empty voxels on each side.
VoxelGrid voxelize(const TriangleMesh& mesh, double spacing, int padding = 2);

// The same test for a given lattice (origin, spacing, size): fills `inside`.
void scan_inside(const TriangleMesh& mesh, VoxelGrid& grid);

// Distance (m) of each inside voxel's centre to the nearest outside voxel's centre; 0 outside. Exact Euclidean
// (Felzenszwalb & Huttenlocher 2012).
std::vector<double> distance_transform(const VoxelGrid& grid);

// Keeps only the largest 6-connected inside part; returns how many voxels went.
std::size_t keep_largest_part(VoxelGrid& grid);

}  // namespace geometry
