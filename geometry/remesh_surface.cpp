#include "geometry/remesh_surface.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/remesh.h>
#include <CGAL/Surface_mesh.h>

#include <stdexcept>

namespace geometry {

TriangleMesh remesh_surface(const TriangleMesh& mesh, double edge_length, bool keep_border) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using Surface = CGAL::Surface_mesh<Kernel::Point_3>;
  namespace processing = CGAL::Polygon_mesh_processing;
  std::vector<Kernel::Point_3> points;
  std::vector<std::array<std::size_t, 3>> polygons;
  for (const Eigen::Vector3d& p : mesh.vertices) points.emplace_back(p.x(), p.y(), p.z());
  for (const auto& t : mesh.triangles) polygons.push_back({std::size_t(t[0]), std::size_t(t[1]), std::size_t(t[2])});
  if (!processing::is_polygon_soup_a_polygon_mesh(polygons))
    throw std::runtime_error("the surface's triangles branch or face different ways; repair it so that each edge joins two triangles");
  Surface surface;
  processing::polygon_soup_to_polygon_mesh(points, polygons, surface);
  if (!keep_border) {
    std::vector<Surface::Edge_index> border;
    for (auto edge : surface.edges())
      if (surface.is_border(edge)) border.push_back(edge);
    processing::split_long_edges(border, edge_length, surface);
  }
  processing::isotropic_remeshing(
      faces(surface), edge_length, surface,
      processing::parameters::number_of_iterations(10).number_of_relaxation_steps(3).protect_constraints(keep_border));
  surface.collect_garbage();
  TriangleMesh result;
  for (auto v : surface.vertices()) result.vertices.emplace_back(surface.point(v).x(), surface.point(v).y(), surface.point(v).z());
  for (auto f : surface.faces()) {
    std::array<std::int32_t, 3> corners;
    int k = 0;
    for (auto v : CGAL::vertices_around_face(surface.halfedge(f), surface)) corners[k++] = std::int32_t(v.idx());
    result.triangles.push_back(corners);
  }
  return result;
}

}  // namespace geometry
