// What is wrong with a surface, and where.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "geometry/triangle_mesh.h"

namespace geometry {

struct Defect {
  std::string kind;  // duplicate_faces | degenerate_faces | non_manifold_edges | flipped_faces | inward_normals | holes | specks |
                     // self_intersections | split_vertices | double_wall | not_finite
  std::size_t count = 0;
  Eigen::Vector3d at = Eigen::Vector3d::Zero();  // m, of the first or largest
  bool repaired = false;
};

// Plain counts of a welded mesh.
struct MeshTopology {
  std::size_t border_edges = 0, non_manifold_edges = 0, mismatched_edges = 0;  // mismatched: both faces run along it the same way
  std::size_t components = 0;
  Eigen::Vector3d non_manifold_at = Eigen::Vector3d::Zero();  // m, the first such edge
  std::vector<std::int32_t> component_of_triangle;
  bool closed() const { return border_edges == 0 && non_manifold_edges == 0; }
};

// Merges vertices at the same position (`tolerance` 0: exactly equal) and drops unused ones. Returns how many went.
std::size_t weld_vertices(TriangleMesh& mesh, double tolerance = 0);

// Renumbers; vertices at one position stay apart (where two sheets of the surface touch).
void drop_unused_vertices(TriangleMesh& mesh);

MeshTopology measure_topology(const TriangleMesh& mesh);
double signed_volume(const TriangleMesh& mesh);  // m³, > 0 when closed and oriented outward
double surface_area(const TriangleMesh& mesh);   // m²
void bounding_box(const TriangleMesh& mesh, Eigen::Vector3d& low, Eigen::Vector3d& high);

// Pairs of triangles that cross each other (neighbours sharing an edge or corner only where they really overlap).
std::vector<std::array<std::int32_t, 2>> self_intersections(const TriangleMesh& mesh);

}  // namespace geometry
