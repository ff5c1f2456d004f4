// Even triangles over a surface (CGAL's isotropic remeshing).
#pragma once

#include "geometry/triangle_mesh.h"

namespace geometry {

// Triangles of about `edge_length` m over the same surface, vertices on it. With `keep_border` the border's vertices stay as they are (its
// edges must not be much longer than edge_length); else the border is divided anew. Throws std::runtime_error where triangles do not form a
// consistently oriented manifold surface.
TriangleMesh remesh_surface(const TriangleMesh& mesh, double edge_length, bool keep_border);

}  // namespace geometry
