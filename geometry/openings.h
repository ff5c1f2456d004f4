// The open ends of a vessel: found as border loops, told apart from holes in the wall, capped flat, named.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "geometry/triangle_mesh.h"

namespace geometry {

struct OpenEnd {
  std::string name;                  // unique: its role, numbered where several share it ("branch1")
  std::string role;                  // ventricle | ascending | descending | branch; where no arch or root tells: inlet | outlet | branch
  Eigen::Vector3d center;            // m, centroid of the cap
  Eigen::Vector3d normal;            // unit, out of the lumen
  double area = 0;                   // m²
  double radius = 0;                 // m, of the circle of equal area
  double radius_max = 0;             // m, farthest rim point from the centre
  bool open_in_file = true;          // false: the file had it closed already by a flat cap
  std::vector<Eigen::Vector3d> rim;  // m, in order round the end
};

// Closed border loops, each as vertex indices in order; the mesh must be welded. The loop runs as its triangles' half-edges do,
// so a cap is (loop reversed).
std::vector<std::vector<std::int32_t>> border_loops(const TriangleMesh& mesh);

// Centre, normal (out of the lumen when the mesh is oriented outward), area, radii of one loop of points.
OpenEnd measure_loop(const std::vector<Eigen::Vector3d>& rim);

// A loop is a vessel's end when it is wide and the wall beside it runs along the cap's normal; otherwise it is a hole in the wall.
// `minimum_diameter` in metres.
bool is_vessel_end(const TriangleMesh& mesh, const std::vector<std::int32_t>& loop, double minimum_diameter);

// Adds flat triangles over the loop (ear clipping in the loop's own plane; rim vertices are not moved). Returns how many.
std::size_t cap_loop(TriangleMesh& mesh, const std::vector<std::int32_t>& loop);

// Flat faces that close a vessel in the file: connected triangles coplanar within `degrees`, with a sharp rim, at least
// `minimum_diameter` (m) wide.
std::vector<OpenEnd> find_flat_caps(const TriangleMesh& mesh, double minimum_diameter, double degrees = 2);

}  // namespace geometry
