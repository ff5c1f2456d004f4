// What is done to a surface before it is drawn: smoothing, thickness, borders, sections. No OpenGL.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "render/frame.h"

namespace render {

// A surface ready to draw: one normal and one value a vertex. Values are copied through every step, so that stress stays where it was.
struct DrawnMesh {
  std::vector<Eigen::Vector3f> positions, normals;
  std::vector<float> values;
  std::vector<std::array<std::int32_t, 3>> triangles;
};

// Area-weighted unit normals of the vertices; a vertex in no triangle gets the z axis.
std::vector<Eigen::Vector3f> vertex_normals(const std::vector<Eigen::Vector3f>& positions,
                                            const std::vector<std::array<std::int32_t, 3>>& triangles);

// One level of Loop subdivision (C. Loop 1987; weights of J. Warren 1995: 3/8n, for n = 3 3/16; border by the cubic B-spline). Values of
// old vertices are kept as they are, those of new ones are the mean of their edge, so that no value leaves the range it had.
DrawnMesh subdivide(const DrawnMesh& mesh);

// Along the border, the unit direction out of the surface and across it; elsewhere zero.
std::vector<Eigen::Vector3f> border_outward(const DrawnMesh& mesh);

// The mesh moved by half the thickness to either side, closed along its free border by a half circle. thickness > 0, m.
DrawnMesh skin(const DrawnMesh& mesh, float thickness);

// A surface's middle as it is drawn: recovered values, faired, smoothed, with normals. field = -1: values are 0.
DrawnMesh mid_mesh(const Surface& surface, int field);

// What is drawn for a surface: its middle with its skin.
DrawnMesh drawn_mesh(const Surface& surface, int field);

// Edges that belong to one triangle alone, in the direction in which that triangle runs through them.
std::vector<std::array<std::int32_t, 2>> border_edges(const std::vector<std::array<std::int32_t, 3>>& triangles);

// Where the plane cuts the surface: pairs of points.
std::vector<std::array<Eigen::Vector3f, 2>> section(const std::vector<Eigen::Vector3f>& positions,
                                                    const std::vector<std::array<std::int32_t, 3>>& triangles, const ClipPlane& plane);

// What of the surface does not lie on the side the plane's normal points to; triangles that cross it are cut along it.
Surface cut_away(const Surface& surface, const ClipPlane& plane);

}  // namespace render
