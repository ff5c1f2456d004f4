#include "geometry/check_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>
#include <unordered_map>

namespace geometry {
namespace {

struct CellHash {
  std::size_t operator()(const std::array<std::int64_t, 3>& cell) const {
    return std::size_t(cell[0] * 73856093) ^ std::size_t(cell[1] * 19349663) ^ std::size_t(cell[2] * 83492791);
  }
};

// new_index[v] = the first vertex at v's position.
std::vector<std::int32_t> match_exactly(const std::vector<Eigen::Vector3d>& vertices) {
  std::vector<std::int32_t> order(vertices.size()), first(vertices.size());
  std::iota(order.begin(), order.end(), 0);
  auto before = [&](std::int32_t a, std::int32_t b) {
    const Eigen::Vector3d &p = vertices[std::size_t(a)], &q = vertices[std::size_t(b)];
    for (int k = 0; k < 3; ++k)
      if (p[k] != q[k]) return p[k] < q[k];
    return a < b;
  };
  std::sort(order.begin(), order.end(), before);
  for (std::size_t i = 0; i < order.size(); ++i) {
    const auto v = std::size_t(order[i]);
    const bool same = i > 0 && vertices[v] == vertices[std::size_t(order[i - 1])];
    first[v] = same ? first[std::size_t(order[i - 1])] : order[i];
  }
  return first;
}

std::vector<std::int32_t> match_within(const std::vector<Eigen::Vector3d>& vertices, double tolerance) {
  std::unordered_map<std::array<std::int64_t, 3>, std::vector<std::int32_t>, CellHash> kept;
  std::vector<std::int32_t> first(vertices.size());
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    std::array<std::int64_t, 3> cell;
    for (int k = 0; k < 3; ++k) cell[std::size_t(k)] = std::int64_t(std::floor(vertices[v][k] / tolerance));
    first[v] = std::int32_t(v);
    for (int n = 0; n < 27 && first[v] == std::int32_t(v); ++n) {
      const auto found = kept.find({cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n / 9 - 1});
      if (found == kept.end()) continue;
      for (std::int32_t other : found->second)
        if ((vertices[std::size_t(other)] - vertices[v]).norm() <= tolerance) {
          first[v] = other;
          break;
        }
    }
    if (first[v] == std::int32_t(v)) kept[cell].push_back(std::int32_t(v));
  }
  return first;
}

struct HalfEdge {
  std::int32_t low, high, triangle;
  bool forward;  // runs from low to high
};

std::vector<HalfEdge> sorted_half_edges(const TriangleMesh& mesh) {
  std::vector<HalfEdge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t c = 0; c < 3; ++c) {
      const std::int32_t a = mesh.triangles[t][c], b = mesh.triangles[t][(c + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), std::int32_t(t), a < b});
    }
  std::sort(edges.begin(), edges.end(),
            [](const HalfEdge& p, const HalfEdge& q) { return std::tie(p.low, p.high, p.triangle) < std::tie(q.low, q.high, q.triangle); });
  return edges;
}

std::int32_t root_of(std::vector<std::int32_t>& parent, std::int32_t item) {
  while (parent[std::size_t(item)] != item) item = parent[std::size_t(item)] = parent[std::size_t(parent[std::size_t(item)])];
  return item;
}

}  // namespace

std::size_t weld_vertices(TriangleMesh& mesh, double tolerance) {
  const std::vector<std::int32_t> first = tolerance > 0 ? match_within(mesh.vertices, tolerance) : match_exactly(mesh.vertices);
  const std::size_t before = mesh.vertices.size();
  for (auto& triangle : mesh.triangles)
    for (std::int32_t& corner : triangle) corner = first[std::size_t(corner)];
  drop_unused_vertices(mesh);
  return before - mesh.vertices.size();
}

void drop_unused_vertices(TriangleMesh& mesh) {
  std::vector<std::int32_t> new_index(mesh.vertices.size(), -1);
  std::vector<Eigen::Vector3d> kept;
  for (auto& triangle : mesh.triangles)
    for (std::int32_t& corner : triangle) {
      std::int32_t& index = new_index[std::size_t(corner)];
      if (index < 0) {
        index = std::int32_t(kept.size());
        kept.push_back(mesh.vertices[std::size_t(corner)]);
      }
      corner = index;
    }
  mesh.vertices = std::move(kept);
}

MeshTopology measure_topology(const TriangleMesh& mesh) {
  MeshTopology topology;
  const std::vector<HalfEdge> edges = sorted_half_edges(mesh);
  std::vector<std::int32_t> parent(mesh.triangles.size());
  std::iota(parent.begin(), parent.end(), 0);
  for (std::size_t begin = 0, end; begin < edges.size(); begin = end) {
    for (end = begin + 1; end < edges.size() && edges[end].low == edges[begin].low && edges[end].high == edges[begin].high;) ++end;
    const std::size_t faces = end - begin;
    if (faces == 1) ++topology.border_edges;
    if (faces > 2 && topology.non_manifold_edges++ == 0) topology.non_manifold_at = mesh.vertices[std::size_t(edges[begin].low)];
    if (faces == 2 && edges[begin].forward == edges[begin + 1].forward) ++topology.mismatched_edges;
    for (std::size_t e = begin + 1; e < end; ++e) {
      const std::int32_t a = root_of(parent, edges[begin].triangle), b = root_of(parent, edges[e].triangle);
      parent[std::size_t(std::max(a, b))] = std::min(a, b);
    }
  }
  topology.component_of_triangle.resize(mesh.triangles.size());
  std::vector<std::int32_t> number(mesh.triangles.size(), -1);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto root = std::size_t(root_of(parent, std::int32_t(t)));
    if (number[root] < 0) number[root] = std::int32_t(topology.components++);
    topology.component_of_triangle[t] = number[root];
  }
  return topology;
}

double signed_volume(const TriangleMesh& mesh) {
  if (mesh.vertices.empty()) return 0;
  const Eigen::Vector3d origin = mesh.vertices[0];  // near the mesh: keeps round-off small
  double volume = 0;
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d a = mesh.vertices[std::size_t(t[0])] - origin, b = mesh.vertices[std::size_t(t[1])] - origin,
                          c = mesh.vertices[std::size_t(t[2])] - origin;
    volume += a.dot(b.cross(c)) / 6;
  }
  return volume;
}

double surface_area(const TriangleMesh& mesh) {
  double area = 0;
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d &a = mesh.vertices[std::size_t(t[0])], &b = mesh.vertices[std::size_t(t[1])],
                          &c = mesh.vertices[std::size_t(t[2])];
    area += (b - a).cross(c - a).norm() / 2;
  }
  return area;
}

void bounding_box(const TriangleMesh& mesh, Eigen::Vector3d& low, Eigen::Vector3d& high) {
  low.setConstant(std::numeric_limits<double>::infinity());
  high = -low;
  for (const Eigen::Vector3d& v : mesh.vertices) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
}

}  // namespace geometry
