// How a triangle mesh hangs together, apart from where it lies: found once for a mesh that moves. No OpenGL.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace render {

using Triangles = std::vector<std::array<std::int32_t, 3>>;

struct Edge {
  std::int32_t low, high;               // vertices, low < high
  std::int32_t opposite[2] = {-1, -1};  // the triangles' third vertices; the second is -1 on the border
  std::int32_t triangle_corner;         // 3 * triangle + corner where it was found first
};

struct Topology {
  Triangles triangles;
  std::vector<Edge> edges;                          // each once, in the order of their vertices
  std::vector<std::int32_t> edge_of_corner;         // [3 t + k] = the edge from corner k to corner k + 1 of triangle t
  std::vector<std::array<std::int32_t, 2>> border;  // edges of one triangle alone, in the direction in which it runs through them
};
Topology make_topology(Triangles triangles);

// The triangles after one level of subdivision: the old vertices, then one new one an edge, in their order. `vertices` = of the old mesh.
Triangles refined(const Topology& topology, std::size_t vertices);

}  // namespace render
