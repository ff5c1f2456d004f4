// Apart from check_mesh.cpp because CGAL's exact predicates and box intersection take long to compile.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>
#include <CGAL/intersections.h>

#include <algorithm>

#include "geometry/check_mesh.h"

namespace geometry {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Corners = std::array<std::int32_t, 3>;
struct Box : CGAL::Box_intersection_d::Box_d<double, 3, CGAL::Box_intersection_d::ID_EXPLICIT> {
  Box(const CGAL::Bbox_3& bounds, std::int32_t number)
      : CGAL::Box_intersection_d::Box_d<double, 3, CGAL::Box_intersection_d::ID_EXPLICIT>(bounds), triangle(number) {}
  std::int32_t triangle;
};

// Neighbours across an edge overlap only when folded flat onto each other.
bool folded_together(const std::vector<Point>& points, const Corners& p, const Corners& q, std::array<std::int32_t, 2> edge) {
  auto opposite = [&](const Corners& t) {
    for (std::int32_t v : t)
      if (v != edge[0] && v != edge[1]) return v;
    return t[0];
  };
  const std::int32_t a = opposite(p), b = opposite(q);
  if (a == b) return false;  // the same face twice: a duplicate, not a crossing
  const Point &s = points[std::size_t(edge[0])], &e = points[std::size_t(edge[1])], &c = points[std::size_t(a)],
              &d = points[std::size_t(b)];
  return CGAL::orientation(s, e, c, d) == CGAL::COPLANAR && CGAL::coplanar_orientation(s, e, c, d) == CGAL::POSITIVE;
}

// Triangles with one common corner cross when the edge opposite to it in one meets the other.
bool cross_at_corner(const std::vector<Point>& points, const Corners& p, const Corners& q, std::int32_t corner) {
  auto meets = [&](const Corners& edge_of, const Corners& face) {
    const std::size_t at = std::size_t(std::find(edge_of.begin(), edge_of.end(), corner) - edge_of.begin());
    const Kernel::Segment_3 edge(points[std::size_t(edge_of[(at + 1) % 3])], points[std::size_t(edge_of[(at + 2) % 3])]);
    const Kernel::Triangle_3 triangle(points[std::size_t(face[0])], points[std::size_t(face[1])], points[std::size_t(face[2])]);
    return CGAL::do_intersect(edge, triangle);
  };
  return meets(p, q) || meets(q, p);
}

bool cross(const std::vector<Point>& points, const Corners& p, const Corners& q) {
  std::array<std::int32_t, 3> shared{};
  std::size_t count = 0;
  for (std::int32_t a : p)
    for (std::int32_t b : q)
      if (a == b && count < 3) shared[count++] = a;
  if (count == 3) return false;
  if (count == 2) return folded_together(points, p, q, {shared[0], shared[1]});
  if (count == 1) return cross_at_corner(points, p, q, shared[0]);
  auto triangle = [&](const Corners& t) {
    return Kernel::Triangle_3(points[std::size_t(t[0])], points[std::size_t(t[1])], points[std::size_t(t[2])]);
  };
  return CGAL::do_intersect(triangle(p), triangle(q));
}

}  // namespace

std::vector<std::array<std::int32_t, 2>> self_intersections(const TriangleMesh& mesh) {
  std::vector<Point> points;
  for (const Eigen::Vector3d& v : mesh.vertices) points.emplace_back(v.x(), v.y(), v.z());
  std::vector<Box> boxes;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Corners& corners = mesh.triangles[t];
    const Point &a = points[std::size_t(corners[0])], &b = points[std::size_t(corners[1])], &c = points[std::size_t(corners[2])];
    if (CGAL::collinear(a, b, c)) continue;  // reported as degenerate
    boxes.emplace_back(a.bbox() + b.bbox() + c.bbox(), std::int32_t(t));
  }
  std::vector<std::array<std::int32_t, 2>> pairs;
  std::vector<const Box*> pointers;
  for (const Box& box : boxes) pointers.push_back(&box);
  CGAL::box_self_intersection_d(pointers.begin(), pointers.end(), [&](const Box* p, const Box* q) {
    if (cross(points, mesh.triangles[std::size_t(p->triangle)], mesh.triangles[std::size_t(q->triangle)]))
      pairs.push_back({std::min(p->triangle, q->triangle), std::max(p->triangle, q->triangle)});
  });
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace geometry
