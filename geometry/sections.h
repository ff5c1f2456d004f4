// The lumen's centreline and its cross-sections.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "geometry/triangle_mesh.h"

namespace geometry {

struct Centreline {
  std::vector<Eigen::Vector3d> points;    // m, evenly spaced (about 1 mm of the patient)
  std::vector<Eigen::Vector3d> tangents;  // unit, along the points' order
  std::vector<double> arc;                // m, from points[0]
  std::size_t size() const { return points.size(); }
};

// One closed contour of the mesh in a plane.
struct Section {
  std::vector<Eigen::Vector3d> contour;  // m, in order, not repeated; counter-clockwise about the plane's normal
  Eigen::Vector3d center;                // m, of area
  double area = 0;                       // m²
  double largest_width = 0;              // m, largest extent over all directions in the plane
  double perpendicular_width = 0;        // m, extent at right angles to the largest
  double diameter() const;               // m, of the circle of equal area
};

// All closed contours of the plane through `point` (open polylines, where the mesh has holes, are left out).
std::vector<Section> cut_sections(const TriangleMesh& mesh, const Eigen::Vector3d& point, const Eigen::Vector3d& normal);

// The smallest contour that holds `point` inside; an empty contour where there is none.
Section section_around(const TriangleMesh& mesh, const Eigen::Vector3d& point, const Eigen::Vector3d& normal);

// r(theta) of a section about `center`, `count` even steps of theta from x_axis towards y_axis (unit, in the plane); the innermost hit.
std::vector<double> section_radii(const Section& section, const Eigen::Vector3d& center, const Eigen::Vector3d& x_axis,
                                  const Eigen::Vector3d& y_axis, int count);

}  // namespace geometry
