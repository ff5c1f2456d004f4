#include "render/topology.h"

#include <algorithm>
#include <utility>

namespace render {
namespace {

// The corners' edges, sorted by their vertices and then by the corner: a counting sort by the lower vertex, and within it by the higher.
std::vector<Edge> sorted_edges(const Triangles& triangles) {
  std::int32_t vertices = 0;
  for (const auto& triangle : triangles) vertices = std::max({vertices, triangle[0] + 1, triangle[1] + 1, triangle[2] + 1});
  std::vector<std::size_t> first(static_cast<std::size_t>(vertices) + 1, 0);
  const auto low_of = [&](std::size_t t, std::size_t k) { return std::min(triangles[t][k], triangles[t][(k + 1) % 3]); };
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) ++first[static_cast<std::size_t>(low_of(t, k)) + 1];
  for (std::size_t i = 1; i < first.size(); ++i) first[i] += first[i - 1];
  std::vector<Edge> sorted(3 * triangles.size());
  std::vector<std::size_t> next = first;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t low = low_of(t, k), high = std::max(triangles[t][k], triangles[t][(k + 1) % 3]);
      std::size_t place = next[static_cast<std::size_t>(low)]++;
      for (; place > first[static_cast<std::size_t>(low)] && sorted[place - 1].high > high; --place) sorted[place] = sorted[place - 1];
      sorted[place] = {low, high, {triangles[t][(k + 2) % 3], -1}, static_cast<std::int32_t>(3 * t + k)};
    }
  return sorted;
}

}  // namespace

Topology make_topology(Triangles triangles) {
  Topology topology;
  topology.triangles = std::move(triangles);
  topology.edge_of_corner.assign(3 * topology.triangles.size(), -1);
  for (const Edge& edge : sorted_edges(topology.triangles)) {
    std::vector<Edge>& unique = topology.edges;
    if (!unique.empty() && unique.back().low == edge.low && unique.back().high == edge.high)
      unique.back().opposite[1] = edge.opposite[0];
    else
      unique.push_back(edge);
    topology.edge_of_corner[static_cast<std::size_t>(edge.triangle_corner)] = static_cast<std::int32_t>(unique.size()) - 1;
  }
  for (const Edge& edge : topology.edges) {
    if (edge.opposite[1] >= 0) continue;
    const auto& triangle = topology.triangles[static_cast<std::size_t>(edge.triangle_corner / 3)];
    const auto k = static_cast<std::size_t>(edge.triangle_corner % 3);
    topology.border.push_back({triangle[k], triangle[(k + 1) % 3]});
  }
  return topology;
}

Triangles refined(const Topology& topology, std::size_t vertices) {
  const auto first_new = static_cast<std::int32_t>(vertices);
  Triangles fine;
  fine.reserve(4 * topology.triangles.size());
  for (std::size_t t = 0; t < topology.triangles.size(); ++t) {
    const auto& [a, b, c] = topology.triangles[t];
    const std::int32_t* edge = &topology.edge_of_corner[3 * t];
    const std::int32_t ab = first_new + edge[0], bc = first_new + edge[1], ca = first_new + edge[2];
    fine.push_back({a, ab, ca});
    fine.push_back({b, bc, ab});
    fine.push_back({c, ca, bc});
    fine.push_back({ab, bc, ca});
  }
  return fine;
}

}  // namespace render
