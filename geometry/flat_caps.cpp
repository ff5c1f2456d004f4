// Ends that the file had closed already: flat faces across a vessel, with a sharp rim and a vessel of the same size behind them.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

#include "geometry/check_mesh.h"
#include "geometry/openings.h"
#include "geometry/sections.h"

namespace geometry {
namespace {

using Eigen::Vector3d;

struct FaceGraph {
  std::vector<Vector3d> normal;  // unit; zero where degenerate
  std::vector<double> area;
  std::vector<std::array<std::int32_t, 3>> neighbour;  // across edge c -> c+1, or -1
};

FaceGraph make_face_graph(const TriangleMesh& mesh) {
  FaceGraph graph;
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> face_of;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& corners = mesh.triangles[t];
    const Vector3d &a = mesh.vertices[std::size_t(corners[0])], &b = mesh.vertices[std::size_t(corners[1])],
                   &c = mesh.vertices[std::size_t(corners[2])];
    const Vector3d cross = (b - a).cross(c - a);
    graph.area.push_back(cross.norm() / 2);
    graph.normal.push_back(graph.area.back() > 0 ? Vector3d(cross.normalized()) : Vector3d::Zero());
    for (std::size_t k = 0; k < 3; ++k) face_of[{corners[k], corners[(k + 1) % 3]}] = std::int32_t(t);
  }
  for (const auto& corners : mesh.triangles) {
    std::array<std::int32_t, 3> neighbours;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto found = face_of.find({corners[(k + 1) % 3], corners[k]});
      neighbours[k] = found == face_of.end() ? -1 : found->second;
    }
    graph.neighbour.push_back(neighbours);
  }
  return graph;
}

std::vector<std::int32_t> grow_plane(const TriangleMesh& mesh, const FaceGraph& graph, std::int32_t seed, double cosine,
                                     std::vector<std::int32_t>& owner) {
  std::vector<std::int32_t> region{seed};
  owner[std::size_t(seed)] = seed;
  Vector3d normal = graph.normal[std::size_t(seed)], weighted = normal * graph.area[std::size_t(seed)];
  const Vector3d anchor = mesh.vertices[std::size_t(mesh.triangles[std::size_t(seed)][0])];
  // A sliver's normal is round-off: it belongs to the plane when its corners do.
  auto lies_in_plane = [&](std::int32_t t, double tolerance) {
    const auto& corners = mesh.triangles[std::size_t(t)];
    return std::all_of(corners.begin(), corners.end(),
                       [&](std::int32_t v) { return std::abs((mesh.vertices[std::size_t(v)] - anchor).dot(normal)) < tolerance; });
  };
  for (std::size_t i = 0; i < region.size(); ++i)
    for (std::int32_t next : graph.neighbour[std::size_t(region[i])]) {
      if (next < 0 || owner[std::size_t(next)] >= 0) continue;
      const bool along = graph.normal[std::size_t(next)].dot(normal) >= cosine;
      const bool sliver = graph.area[std::size_t(next)] < 1e-2 * graph.area[std::size_t(seed)] &&
                          lies_in_plane(next, 1e-3 * std::sqrt(graph.area[std::size_t(seed)]));
      if (!along && !sliver) continue;
      owner[std::size_t(next)] = seed;
      region.push_back(next);
      weighted += graph.normal[std::size_t(next)] * graph.area[std::size_t(next)];
      normal = weighted.normalized();
    }
  return region;
}

// Share of the region's rim whose outer neighbour stands at more than 40 degrees and turns away (convex, as at a cut vessel).
double sharp_share(const TriangleMesh& mesh, const FaceGraph& graph, const std::vector<std::int32_t>& region,
                   const std::vector<std::int32_t>& owner, const Vector3d& normal) {
  double sharp = 0, total = 0;
  for (std::int32_t t : region)
    for (std::size_t c = 0; c < 3; ++c) {
      const std::int32_t next = graph.neighbour[std::size_t(t)][c];
      if (next >= 0 && owner[std::size_t(next)] == owner[std::size_t(t)]) continue;
      const auto& corners = mesh.triangles[std::size_t(t)];
      const Vector3d a = mesh.vertices[std::size_t(corners[c])], b = mesh.vertices[std::size_t(corners[(c + 1) % 3])];
      const double length = (b - a).norm();
      total += length;
      if (next < 0 || graph.normal[std::size_t(next)].dot(normal) > std::cos(40 * std::numbers::pi / 180)) continue;
      const auto& other = mesh.triangles[std::size_t(next)];
      const Vector3d middle =
          (mesh.vertices[std::size_t(other[0])] + mesh.vertices[std::size_t(other[1])] + mesh.vertices[std::size_t(other[2])]) / 3;
      if ((middle - a).dot(normal) < 0) sharp += length;
    }
  return total > 0 ? sharp / total : 0;
}

}  // namespace

std::vector<OpenEnd> find_flat_caps(const TriangleMesh& mesh, double minimum_diameter, double degrees) {
  const FaceGraph graph = make_face_graph(mesh);
  std::vector<std::int32_t> order(mesh.triangles.size()), owner(mesh.triangles.size(), -1);
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::int32_t a, std::int32_t b) { return graph.area[std::size_t(a)] > graph.area[std::size_t(b)]; });
  std::vector<OpenEnd> caps;
  for (std::int32_t seed : order) {
    if (owner[std::size_t(seed)] >= 0 || graph.area[std::size_t(seed)] == 0) continue;
    const auto region = grow_plane(mesh, graph, seed, std::cos(degrees * std::numbers::pi / 180), owner);
    TriangleMesh patch{mesh.vertices, {}};
    Vector3d weighted = Vector3d::Zero();
    double area = 0;
    for (std::int32_t t : region) area += graph.area[std::size_t(t)];
    if (2 * std::sqrt(area / std::numbers::pi) < minimum_diameter) continue;
    for (std::int32_t t : region) {
      patch.triangles.push_back(mesh.triangles[std::size_t(t)]);
      weighted += graph.normal[std::size_t(t)] * graph.area[std::size_t(t)];
    }
    const Vector3d normal = weighted.normalized();
    if (weighted.norm() < 0.98 * area || sharp_share(mesh, graph, region, owner, normal) < 0.85) continue;
    const auto loops = border_loops(patch);
    if (loops.size() != 1) continue;
    std::vector<Vector3d> rim;
    for (auto v = loops[0].rbegin(); v != loops[0].rend(); ++v) rim.push_back(mesh.vertices[std::size_t(*v)]);
    OpenEnd end = measure_loop(rim);
    end.open_in_file = false;
    if (end.radius_max > 2.2 * end.radius) continue;  // a flat strip along the wall
    const Section behind = section_around(mesh, end.center - 0.3 * end.radius * end.normal, end.normal);
    if (behind.area < 0.7 * end.area || behind.area > 1.5 * end.area) continue;
    caps.push_back(std::move(end));
  }
  return caps;
}

}  // namespace geometry
