#include "render/fairing.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

namespace render {
namespace {

// Of each triangle.
std::vector<float> triangle_areas(const std::vector<Eigen::Vector3f>& positions,
                                  const std::vector<std::array<std::int32_t, 3>>& triangles) {
  std::vector<float> areas;
  areas.reserve(triangles.size());
  for (const auto& [a, b, c] : triangles) areas.push_back(0.5f * (positions[b] - positions[a]).cross(positions[c] - positions[a]).norm());
  return areas;
}

}  // namespace

std::vector<float> recovered(std::vector<float> values, const std::vector<Eigen::Vector3f>& positions,
                             const std::vector<std::array<std::int32_t, 3>>& triangles, int passes) {
  const std::vector<float> areas = triangle_areas(positions, triangles);
  for (int pass = 0; pass < passes; ++pass) {
    std::vector<float> sum(values.size(), 0), weight(values.size(), 0);
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      const auto& [a, b, c] = triangles[t];
      const float mean = (values[a] + values[b] + values[c]) / 3;
      for (const std::int32_t vertex : triangles[t]) {
        sum[vertex] += areas[t] * mean;
        weight[vertex] += areas[t];
      }
    }
    for (std::size_t i = 0; i < values.size(); ++i)
      if (weight[i] > 0) values[i] = sum[i] / weight[i];
  }
  return values;
}

Followed followed(std::size_t count, const Topology& topology) {
  Followed inner(count), border(count);
  for (const auto& triangle : topology.triangles)
    for (int k = 0; k < 3; ++k) {
      inner[triangle[k]].push_back(triangle[(k + 1) % 3]);
      inner[triangle[k]].push_back(triangle[(k + 2) % 3]);
    }
  for (const auto& [a, b] : topology.border) {
    border[a].push_back(b);
    border[b].push_back(a);
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (!border[i].empty()) {
      inner[i] = border[i].size() == 2 ? border[i] : std::vector<std::int32_t>();
      continue;
    }
    std::sort(inner[i].begin(), inner[i].end());
    inner[i].erase(std::unique(inner[i].begin(), inner[i].end()), inner[i].end());
  }
  return inner;
}

std::vector<Eigen::Vector3f> faired(std::vector<Eigen::Vector3f> positions, const Followed& others, int rounds) {
  for (int round = 0; round < 2 * rounds; ++round) {
    const float step = round % 2 == 0 ? 0.5f : -0.53f;
    std::vector<Eigen::Vector3f> next = positions;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      if (others[i].empty()) continue;
      Eigen::Vector3f mean = Eigen::Vector3f::Zero();
      for (const std::int32_t other : others[i]) mean += positions[other];
      next[i] += step * (mean / static_cast<float>(others[i].size()) - positions[i]);
    }
    positions = std::move(next);
  }
  return positions;
}

}  // namespace render
