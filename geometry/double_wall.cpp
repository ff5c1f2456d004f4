#include "geometry/double_wall.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/check_mesh.h"
#include "geometry/openings.h"
#include "geometry/triangle_tree.h"

namespace geometry {
namespace {

struct Shell {
  TriangleMesh capped;
  std::vector<OpenEnd> rims;
  double area = 0;
};

std::vector<Shell> split_shells(const TriangleMesh& mesh, const MeshTopology& topology) {
  std::vector<Shell> shells(topology.components);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    shells[std::size_t(topology.component_of_triangle[t])].capped.triangles.push_back(mesh.triangles[t]);
  for (Shell& shell : shells) {
    shell.capped.vertices = mesh.vertices;
    drop_unused_vertices(shell.capped);
    shell.area = surface_area(shell.capped);
    for (const auto& loop : border_loops(shell.capped)) {
      std::vector<Eigen::Vector3d> rim;
      for (std::int32_t v : loop) rim.push_back(shell.capped.vertices[std::size_t(v)]);
      shell.rims.push_back(measure_loop(rim));
      cap_loop(shell.capped, loop);
    }
  }
  return shells;
}

// Two rims round one another in about the same plane.
bool concentric(const OpenEnd& a, const OpenEnd& b) {
  const double small = std::min(a.radius, b.radius), large = std::max(a.radius, b.radius);
  if (small <= 0 || large > 2.2 * small || large < 1.03 * small) return false;
  return (a.center - b.center).norm() < 0.35 * small && std::abs(a.normal.dot(b.normal)) > 0.8;
}

// Nearly all of `inner` lies inside `outer`.
bool nested(const Shell& inner, const Shell& outer, const TriangleTree& outer_tree) {
  if (inner.area >= outer.area) return false;
  std::size_t inside = 0, asked = 0;
  const std::size_t step = std::max<std::size_t>(1, inner.capped.vertices.size() / 300);
  for (std::size_t v = 0; v < inner.capped.vertices.size(); v += step, ++asked) inside += outer_tree.contains(inner.capped.vertices[v]);
  return double(inside) > 0.85 * double(asked);
}

}  // namespace

DoubleWall reduce_double_wall(TriangleMesh& mesh) {
  DoubleWall result;
  const MeshTopology topology = measure_topology(mesh);
  const std::vector<Shell> shells = split_shells(mesh, topology);
  for (const Shell& shell : shells)
    for (std::size_t i = 0; i < shell.rims.size(); ++i)
      for (std::size_t j = i + 1; j < shell.rims.size(); ++j)
        if (concentric(shell.rims[i], shell.rims[j])) {
          result.found = true;
          result.at = shell.rims[i].center;
          result.reason =
              "its outer and inner wall are joined into one surface, whose inside is tissue, not blood, and the inner wall alone does not "
              "close";
          return result;
        }
  std::vector<bool> is_outer(shells.size(), false);
  for (std::size_t outer = 0; outer < shells.size(); ++outer) {
    if (shells[outer].capped.triangles.size() < 20) continue;
    const TriangleTree tree(shells[outer].capped);
    for (std::size_t inner = 0; inner < shells.size(); ++inner) {
      if (inner == outer || shells[inner].area < 0.3 * shells[outer].area || !nested(shells[inner], shells[outer], tree)) continue;
      if (shells[inner].rims.size() != shells[outer].rims.size()) continue;
      is_outer[outer] = true;
      result.found = true;
      result.at = shells[outer].rims.empty() ? shells[outer].capped.vertices[0] : shells[outer].rims[0].center;
    }
  }
  if (!result.found) return result;
  std::vector<std::array<std::int32_t, 3>> kept;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!is_outer[std::size_t(topology.component_of_triangle[t])]) kept.push_back(mesh.triangles[t]);
  }
  result.triangles_dropped = mesh.triangles.size() - kept.size();
  mesh.triangles = std::move(kept);
  drop_unused_vertices(mesh);
  result.reduced = true;
  return result;
}

}  // namespace geometry
