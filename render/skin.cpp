#include "render/skin.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace render {
namespace {

// New places of the old vertices (Loop's "even" rule).
std::vector<Eigen::Vector3f> smoothed_vertices(const std::vector<Eigen::Vector3f>& positions, const std::vector<Edge>& edges) {
  const std::size_t count = positions.size();
  std::vector<Eigen::Vector3f> inner(count, Eigen::Vector3f::Zero()), border(count, Eigen::Vector3f::Zero()), result(positions);
  std::vector<int> degree(count, 0), border_degree(count, 0);
  for (const Edge& edge : edges) {
    for (const auto& [here, there] : {std::pair{edge.low, edge.high}, std::pair{edge.high, edge.low}}) {
      inner[here] += positions[there];
      ++degree[here];
      if (edge.opposite[1] < 0) {
        border[here] += positions[there];
        ++border_degree[here];
      }
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (border_degree[i] == 2) {
      result[i] = 0.75f * positions[i] + 0.125f * border[i];
    } else if (border_degree[i] == 0 && degree[i] > 2) {
      const float weight = degree[i] == 3 ? 3.0f / 16 : 3.0f / (8 * static_cast<float>(degree[i]));
      result[i] = (1 - static_cast<float>(degree[i]) * weight) * positions[i] + weight * inner[i];
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

std::vector<Eigen::Vector3f> subdivided(const std::vector<Eigen::Vector3f>& positions, const Topology& topology) {
  std::vector<Eigen::Vector3f> fine = smoothed_vertices(positions, topology.edges);
  fine.reserve(positions.size() + topology.edges.size());
  for (const Edge& edge : topology.edges) {
    const Eigen::Vector3f ends = positions[edge.low] + positions[edge.high];
    if (edge.opposite[1] < 0)
      fine.emplace_back(0.5f * ends);
    else
      fine.emplace_back(0.375f * ends + 0.125f * (positions[edge.opposite[0]] + positions[edge.opposite[1]]));
  }
  return fine;
}

std::vector<float> subdivided(std::vector<float> values, const Topology& topology) {
  values.reserve(values.size() + topology.edges.size());
  for (const Edge& edge : topology.edges) values.push_back(0.5f * (values[edge.low] + values[edge.high]));
  return values;
}

std::vector<Eigen::Vector3f> border_outward(const DrawnMesh& mesh, const Border& border) {
  std::vector<Eigen::Vector3f> outward(mesh.positions.size(), Eigen::Vector3f::Zero());
  for (const auto& [a, b] : border) {
    const Eigen::Vector3f along = mesh.positions[b] - mesh.positions[a];
    outward[a] += along.cross(mesh.normals[a]);
    outward[b] += along.cross(mesh.normals[b]);
  }
  for (Eigen::Vector3f& direction : outward)
    if (direction.norm() > 0) direction.normalize();
  return outward;
}

Skin skin(const DrawnMesh& mesh, float thickness, const Border& border) {
  constexpr int arcs = 4;  // of the half circle round the rim
  const auto count = static_cast<std::int32_t>(mesh.positions.size());
  Skin skin;
  DrawnMesh& result = skin.mesh;
  for (const float side : {0.5f, -0.5f})
    for (std::int32_t i = 0; i < count; ++i) {
      result.positions.emplace_back(mesh.positions[i] + side * thickness * mesh.normals[i]);
      result.normals.emplace_back(side > 0 ? mesh.normals[i] : Eigen::Vector3f(-mesh.normals[i]));
      skin.source.push_back(i);
    }
  for (const auto& [a, b, c] : mesh.triangles) {
    result.triangles.push_back({a, b, c});
    result.triangles.push_back({a + count, c + count, b + count});
  }
  const std::vector<Eigen::Vector3f> outward = border_outward(mesh, border);
  std::vector<std::int32_t> first(mesh.positions.size(), -1);  // of a border vertex's points between both sides
  const auto level = [&](std::int32_t vertex, int arc) {
    return arc == 0 ? vertex : arc == arcs ? vertex + count : first[vertex] + arc - 1;
  };
  for (const auto& [a, b] : border) {
    for (const std::int32_t vertex : {a, b}) {
      if (first[vertex] >= 0) continue;
      first[vertex] = static_cast<std::int32_t>(result.positions.size());
      for (int arc = 1; arc < arcs; ++arc) {
        const float angle = static_cast<float>(M_PI) * static_cast<float>(arc) / arcs;
        const Eigen::Vector3f normal = std::cos(angle) * mesh.normals[vertex] + std::sin(angle) * outward[vertex];
        result.positions.emplace_back(mesh.positions[vertex] + 0.5f * thickness * normal);
        result.normals.push_back(normal);
        skin.source.push_back(vertex);
      }
    }
    for (int arc = 0; arc < arcs; ++arc) {
      result.triangles.push_back({level(a, arc), level(a, arc + 1), level(b, arc)});
      result.triangles.push_back({level(b, arc), level(a, arc + 1), level(b, arc + 1)});
    }
  }
  return skin;
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
