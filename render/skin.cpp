#include "render/skin.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "render/fairing.h"

namespace render {
namespace {

struct Edge {
  std::int32_t low, high;               // vertices, low < high
  std::int32_t opposite[2] = {-1, -1};  // the triangles' third vertices
  std::int32_t triangle_corner;         // 3 * triangle + corner where it was found
};

// All edges once, in the order of their vertices; `of_corner[3 t + k]` is the edge from corner k to corner k + 1 of triangle t.
std::vector<Edge> edges(const std::vector<std::array<std::int32_t, 3>>& triangles, std::vector<std::int32_t>& of_corner) {
  std::vector<Edge> all;
  all.reserve(3 * triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const std::int32_t a = triangles[t][k], b = triangles[t][(k + 1) % 3];
      Edge edge{std::min(a, b), std::max(a, b), {triangles[t][(k + 2) % 3], -1}, static_cast<std::int32_t>(3 * t + k)};
      all.push_back(edge);
    }
  std::sort(all.begin(), all.end(), [](const Edge& a, const Edge& b) {
    if (a.low != b.low) return a.low < b.low;
    if (a.high != b.high) return a.high < b.high;
    return a.triangle_corner < b.triangle_corner;
  });
  of_corner.assign(3 * triangles.size(), -1);
  std::vector<Edge> unique;
  for (const Edge& edge : all) {
    if (!unique.empty() && unique.back().low == edge.low && unique.back().high == edge.high)
      unique.back().opposite[1] = edge.opposite[0];
    else
      unique.push_back(edge);
    of_corner[edge.triangle_corner] = static_cast<std::int32_t>(unique.size()) - 1;
  }
  return unique;
}

// New places of the old vertices (Loop's "even" rule).
std::vector<Eigen::Vector3f> smoothed_vertices(const DrawnMesh& mesh, const std::vector<Edge>& all) {
  const std::size_t count = mesh.positions.size();
  std::vector<Eigen::Vector3f> inner(count, Eigen::Vector3f::Zero()), border(count, Eigen::Vector3f::Zero()), result(mesh.positions);
  std::vector<int> degree(count, 0), border_degree(count, 0);
  for (const Edge& edge : all) {
    for (const auto& [here, there] : {std::pair{edge.low, edge.high}, std::pair{edge.high, edge.low}}) {
      inner[here] += mesh.positions[there];
      ++degree[here];
      if (edge.opposite[1] < 0) {
        border[here] += mesh.positions[there];
        ++border_degree[here];
      }
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (border_degree[i] == 2) {
      result[i] = 0.75f * mesh.positions[i] + 0.125f * border[i];
    } else if (border_degree[i] == 0 && degree[i] > 2) {
      const float weight = degree[i] == 3 ? 3.0f / 16 : 3.0f / (8 * static_cast<float>(degree[i]));
      result[i] = (1 - static_cast<float>(degree[i]) * weight) * mesh.positions[i] + weight * inner[i];
    }
  }
  return result;
}

}  // namespace

std::vector<Eigen::Vector3f> vertex_normals(const std::vector<Eigen::Vector3f>& positions,
                                            const std::vector<std::array<std::int32_t, 3>>& triangles) {
  std::vector<Eigen::Vector3f> normals(positions.size(), Eigen::Vector3f::Zero());
  for (const auto& [a, b, c] : triangles) {
    const Eigen::Vector3f area = (positions[b] - positions[a]).cross(positions[c] - positions[a]);
    normals[a] += area;
    normals[b] += area;
    normals[c] += area;
  }
  for (Eigen::Vector3f& normal : normals) normal = normal.norm() > 0 ? Eigen::Vector3f(normal.normalized()) : Eigen::Vector3f::UnitZ();
  return normals;
}

DrawnMesh subdivide(const DrawnMesh& mesh) {
  std::vector<std::int32_t> of_corner;
  const std::vector<Edge> all = edges(mesh.triangles, of_corner);
  DrawnMesh fine;
  fine.positions = smoothed_vertices(mesh, all);
  fine.values = mesh.values;
  const auto first_new = static_cast<std::int32_t>(fine.positions.size());
  for (const Edge& edge : all) {
    const Eigen::Vector3f ends = mesh.positions[edge.low] + mesh.positions[edge.high];
    if (edge.opposite[1] < 0)
      fine.positions.emplace_back(0.5f * ends);
    else
      fine.positions.emplace_back(0.375f * ends + 0.125f * (mesh.positions[edge.opposite[0]] + mesh.positions[edge.opposite[1]]));
    fine.values.push_back(0.5f * (mesh.values[edge.low] + mesh.values[edge.high]));
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    const std::int32_t ab = first_new + of_corner[3 * t], bc = first_new + of_corner[3 * t + 1], ca = first_new + of_corner[3 * t + 2];
    fine.triangles.push_back({a, ab, ca});
    fine.triangles.push_back({b, bc, ab});
    fine.triangles.push_back({c, ca, bc});
    fine.triangles.push_back({ab, bc, ca});
  }
  fine.normals = vertex_normals(fine.positions, fine.triangles);
  return fine;
}

std::vector<std::array<std::int32_t, 2>> border_edges(const std::vector<std::array<std::int32_t, 3>>& triangles) {
  std::vector<std::int32_t> of_corner;
  std::vector<std::array<std::int32_t, 2>> result;
  for (const Edge& edge : edges(triangles, of_corner)) {
    if (edge.opposite[1] >= 0) continue;
    const auto& triangle = triangles[edge.triangle_corner / 3];
    const int k = edge.triangle_corner % 3;
    result.push_back({triangle[k], triangle[(k + 1) % 3]});
  }
  return result;
}

std::vector<Eigen::Vector3f> border_outward(const DrawnMesh& mesh) {
  std::vector<Eigen::Vector3f> outward(mesh.positions.size(), Eigen::Vector3f::Zero());
  for (const auto& [a, b] : border_edges(mesh.triangles)) {
    const Eigen::Vector3f along = mesh.positions[b] - mesh.positions[a];
    outward[a] += along.cross(mesh.normals[a]);
    outward[b] += along.cross(mesh.normals[b]);
  }
  for (Eigen::Vector3f& direction : outward)
    if (direction.norm() > 0) direction.normalize();
  return outward;
}

DrawnMesh skin(const DrawnMesh& mesh, float thickness) {
  constexpr int arcs = 4;  // of the half circle round the rim
  const auto count = static_cast<std::int32_t>(mesh.positions.size());
  DrawnMesh result;
  for (const float side : {0.5f, -0.5f})
    for (std::int32_t i = 0; i < count; ++i) {
      result.positions.emplace_back(mesh.positions[i] + side * thickness * mesh.normals[i]);
      result.normals.emplace_back(side > 0 ? mesh.normals[i] : Eigen::Vector3f(-mesh.normals[i]));
      result.values.push_back(mesh.values[i]);
    }
  for (const auto& [a, b, c] : mesh.triangles) {
    result.triangles.push_back({a, b, c});
    result.triangles.push_back({a + count, c + count, b + count});
  }
  const std::vector<Eigen::Vector3f> outward = border_outward(mesh);
  std::vector<std::int32_t> first(mesh.positions.size(), -1);  // of a border vertex's points between both sides
  const auto level = [&](std::int32_t vertex, int arc) {
    return arc == 0 ? vertex : arc == arcs ? vertex + count : first[vertex] + arc - 1;
  };
  for (const auto& [a, b] : border_edges(mesh.triangles)) {
    for (const std::int32_t vertex : {a, b}) {
      if (first[vertex] >= 0) continue;
      first[vertex] = static_cast<std::int32_t>(result.positions.size());
      for (int arc = 1; arc < arcs; ++arc) {
        const float angle = static_cast<float>(M_PI) * static_cast<float>(arc) / arcs;
        const Eigen::Vector3f normal = std::cos(angle) * mesh.normals[vertex] + std::sin(angle) * outward[vertex];
        result.positions.emplace_back(mesh.positions[vertex] + 0.5f * thickness * normal);
        result.normals.push_back(normal);
        result.values.push_back(mesh.values[vertex]);
      }
    }
    for (int arc = 0; arc < arcs; ++arc) {
      result.triangles.push_back({level(a, arc), level(a, arc + 1), level(b, arc)});
      result.triangles.push_back({level(b, arc), level(a, arc + 1), level(b, arc + 1)});
    }
  }
  return result;
}

DrawnMesh mid_mesh(const Surface& surface, int field) {
  DrawnMesh mesh;
  mesh.positions = faired(surface.vertices, surface.triangles, surface.fairing);
  mesh.triangles = surface.triangles;
  mesh.values = field >= 0 ? recovered(surface.fields.at(field), surface.vertices, surface.triangles, surface.averaging)
                           : std::vector<float>(surface.vertices.size(), 0.0f);
  mesh.normals = vertex_normals(mesh.positions, mesh.triangles);
  for (int level = 0; level < std::min(surface.smoothing, 3); ++level) mesh = subdivide(mesh);
  return mesh;
}

DrawnMesh drawn_mesh(const Surface& surface, int field) {
  DrawnMesh mesh = mid_mesh(surface, field);
  return surface.thickness > 0 ? skin(mesh, surface.thickness) : mesh;
}

std::vector<std::array<Eigen::Vector3f, 2>> section(const std::vector<Eigen::Vector3f>& positions,
                                                    const std::vector<std::array<std::int32_t, 3>>& triangles, const ClipPlane& plane) {
  std::vector<float> height(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) height[i] = plane.normal.dot(positions[i] - plane.point);
  std::vector<std::array<Eigen::Vector3f, 2>> cuts;
  for (const auto& triangle : triangles) {
    Eigen::Vector3f ends[3];
    int found = 0;
    for (int k = 0; k < 3; ++k) {
      const std::int32_t a = triangle[k], b = triangle[(k + 1) % 3];
      if ((height[a] > 0) == (height[b] > 0)) continue;
      ends[found++] = positions[a] + height[a] / (height[a] - height[b]) * (positions[b] - positions[a]);
    }
    if (found == 2) cuts.push_back({ends[0], ends[1]});
  }
  return cuts;
}

Surface cut_away(const Surface& surface, const ClipPlane& plane) {
  Surface kept = surface;
  kept.triangles.clear();
  std::vector<float> height(surface.vertices.size());
  for (std::size_t i = 0; i < height.size(); ++i) height[i] = plane.normal.dot(surface.vertices[i] - plane.point);
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> cuts;  // one new vertex an edge
  const auto cut = [&](std::int32_t a, std::int32_t b) {
    if (a > b) std::swap(a, b);
    const auto [entry, fresh] = cuts.emplace(std::pair{a, b}, static_cast<std::int32_t>(kept.vertices.size()));
    if (fresh) {
      const float part = height[a] / (height[a] - height[b]);
      kept.vertices.emplace_back(surface.vertices[a] + part * (surface.vertices[b] - surface.vertices[a]));
      for (std::size_t k = 0; k < kept.fields.size(); ++k)
        kept.fields[k].push_back(surface.fields[k][a] + part * (surface.fields[k][b] - surface.fields[k][a]));
    }
    return entry->second;
  };
  for (const auto& triangle : surface.triangles) {
    std::vector<std::int32_t> polygon;  // the part of the triangle that stays, in its own sense of turning
    for (int k = 0; k < 3; ++k) {
      const std::int32_t a = triangle[k], b = triangle[(k + 1) % 3];
      if (height[a] <= 0) polygon.push_back(a);
      if ((height[a] <= 0) != (height[b] <= 0)) polygon.push_back(cut(a, b));
    }
    for (std::size_t k = 2; k < polygon.size(); ++k) kept.triangles.push_back({polygon[0], polygon[k - 1], polygon[k]});
  }
  return kept;
}

}  // namespace render
