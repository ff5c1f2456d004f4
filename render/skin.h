// What is done to a surface before it is drawn: smoothing, thickness, borders, sections. No OpenGL.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "render/frame.h"
#include "render/topology.h"

namespace render {

// A surface ready to draw: one normal and one value a vertex.
struct DrawnMesh {
  std::vector<Eigen::Vector3f> positions, normals;
  std::vector<float> values;
  std::vector<std::array<std::int32_t, 3>> triangles;
};

// Area-weighted unit normals of the vertices; a vertex in no triangle gets the z axis.
std::vector<Eigen::Vector3f> vertex_normals(const std::vector<Eigen::Vector3f>& positions,
                                            const std::vector<std::array<std::int32_t, 3>>& triangles);

// One level of Loop subdivision (C. Loop 1987; weights of J. Warren 1995: 3/8n, for n = 3 3/16; border by the cubic B-spline); the
// triangles: refined() in topology.h. Values of old vertices are kept as they are, those of new ones are the mean of their edge, so that no
// value leaves the range it had.
std::vector<Eigen::Vector3f> subdivided(const std::vector<Eigen::Vector3f>& positions, const Topology& topology);
std::vector<float> subdivided(std::vector<float> values, const Topology& topology);

using Border = std::vector<std::array<std::int32_t, 2>>;  // Topology::border
// Along the border, the unit direction out of the surface and across it; elsewhere zero.
std::vector<Eigen::Vector3f> border_outward(const DrawnMesh& mesh, const Border& border);

// The mesh moved by half the thickness to either side, closed along its free border by a half circle. thickness > 0, m.
struct Skin {
  DrawnMesh mesh;                    // without values
  std::vector<std::int32_t> source;  // of each vertex: the vertex of the middle that it belongs to
};
Skin skin(const DrawnMesh& mesh, float thickness, const Border& border);

// Where the plane cuts the surface: pairs of points.
std::vector<std::array<Eigen::Vector3f, 2>> section(const std::vector<Eigen::Vector3f>& positions,
                                                    const std::vector<std::array<std::int32_t, 3>>& triangles, const ClipPlane& plane);

// What of the surface does not lie on the side the plane's normal points to; triangles that cross it are cut along it.
Surface cut_away(const Surface& surface, const ClipPlane& plane);

}  // namespace render
