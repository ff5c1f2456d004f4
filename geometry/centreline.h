// Paths through a lumen that keep to its middle, from a lattice of distances to the wall.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "geometry/sections.h"
#include "geometry/voxel_grid.h"

namespace geometry {

struct LumenField {
  VoxelGrid grid;                // the lumen's largest connected part
  std::vector<double> distance;  // m, to the wall, per voxel
  double largest_bore() const;   // m, of the largest inscribed sphere
};

// About `voxels` voxels inside the lumen: 1 mm for an adult's root, 0.5 mm for a child's.
LumenField make_lumen_field(const TriangleMesh& lumen, double voxels = 1e5);

// Ends of a closed lumen: voxels geodesically farthest from one another, each at least one bore away from the paths between the others.
std::vector<Eigen::Vector3d> find_far_ends(const LumenField& field, std::size_t most = 8);

// Geodesic distance, m, within the lumen; infinity where `to` cannot be reached.
double geodesic_distance(const LumenField& field, const Eigen::Vector3d& from, const Eigen::Vector3d& to);

// Dijkstra with the cost length / d^2, smoothed, resampled in even steps of about the lattice's spacing. Empty where no path exists.
Centreline trace_centreline(const LumenField& field, const Eigen::Vector3d& from, const Eigen::Vector3d& to);

// Even steps, tangents and arc length for a polyline.
Centreline resample_centreline(const std::vector<Eigen::Vector3d>& polyline, double step);

}  // namespace geometry
