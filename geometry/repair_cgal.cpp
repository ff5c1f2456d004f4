#include "geometry/repair_cgal.h"

#define CGAL_EIGEN3_ENABLED 1
#define CGAL_NO_WARNINGS 1  // its notes on stderr are none of the user's business; what matters is reported as a defect
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/bbox.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_mesh_to_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/repair_degeneracies.h>
#include <CGAL/Polygon_mesh_processing/repair_self_intersections.h>
#include <CGAL/Polygon_mesh_processing/stitch_borders.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Surface_mesh.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <numbers>

namespace geometry::detail {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;
using Polygon = std::array<std::size_t, 3>;

Surface to_surface(const TriangleMesh& mesh) {
  std::vector<Kernel::Point_3> points;
  for (const Eigen::Vector3d& v : mesh.vertices) points.emplace_back(v.x(), v.y(), v.z());
  std::vector<Polygon> polygons;
  for (const auto& t : mesh.triangles) polygons.push_back({std::size_t(t[0]), std::size_t(t[1]), std::size_t(t[2])});
  pmp::orient_polygon_soup(points, polygons);
  Surface surface;
  pmp::polygon_soup_to_polygon_mesh(points, polygons, surface);
  return surface;
}

TriangleMesh from_surface(const Surface& surface) {
  TriangleMesh mesh;
  std::vector<std::int32_t> number(surface.number_of_vertices() + surface.number_of_removed_vertices(), -1);
  for (auto v : surface.vertices()) {
    number[std::size_t(v)] = std::int32_t(mesh.vertices.size());
    const auto& p = surface.point(v);
    mesh.vertices.emplace_back(p.x(), p.y(), p.z());
  }
  for (auto f : surface.faces()) {
    std::array<std::int32_t, 3> triangle{};
    std::size_t corner = 0;
    for (auto v : surface.vertices_around_face(surface.halfedge(f))) triangle[corner++ % 3] = number[std::size_t(v)];
    mesh.triangles.push_back(triangle);
  }
  return mesh;
}

}  // namespace

bool mend_surface(TriangleMesh& mesh, bool self_intersections) {
  try {
    Surface surface = to_surface(mesh);
    pmp::stitch_borders(surface);
    pmp::remove_degenerate_faces(surface);
    // Caps of 179.9 degrees and needles 10 000 times as long as wide are round-off's degenerate faces: flipped or collapsed away.
    const CGAL::Bbox_3 box = pmp::bbox(surface);
    const double diagonal = std::hypot(box.xmax() - box.xmin(), box.ymax() - box.ymin(), box.zmax() - box.zmin());
    pmp::experimental::remove_almost_degenerate_faces(surface, std::cos(179.9 * std::numbers::pi / 180), 1e4, 1e-5 * diagonal);
    if (self_intersections) pmp::experimental::remove_self_intersections(surface);
    mesh = from_surface(surface);
    return true;
  } catch (const std::exception&) {  // CGAL's own checks: the surface is beyond it
    return false;
  }
}

bool fill_hole(TriangleMesh& mesh, const std::vector<std::int32_t>& loop) {
  try {
    Surface surface = to_surface(mesh);
    for (auto h : surface.halfedges()) {
      if (!surface.is_border(h)) continue;
      const auto& p = surface.point(surface.target(h));
      const Eigen::Vector3d at(p.x(), p.y(), p.z());
      const bool on_loop = std::any_of(loop.begin(), loop.end(), [&](std::int32_t v) { return mesh.vertices[std::size_t(v)] == at; });
      if (!on_loop) continue;
      std::vector<Surface::Face_index> faces;
      std::vector<Surface::Vertex_index> vertices;
      pmp::triangulate_refine_and_fair_hole(surface, h, std::back_inserter(faces), std::back_inserter(vertices));
      if (faces.empty()) return false;
      mesh = from_surface(surface);
      return true;
    }
  } catch (const std::exception&) {
  }
  return false;
}

}  // namespace geometry::detail
