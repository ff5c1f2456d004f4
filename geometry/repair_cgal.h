// Private to repair_mesh: the steps that CGAL's polygon mesh processing does. Kept in one translation unit; it compiles for a minute.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/triangle_mesh.h"

namespace geometry::detail {

// Makes the triangles a manifold surface (splits vertices where sheets touch, stitches equal borders), removes faces without area and,
// where asked, self-intersections. Returns false, mesh untouched, where CGAL could not.
bool mend_surface(TriangleMesh& mesh, bool self_intersections);

// Fills a hole with triangles of the size of its neighbourhood, faired into the wall. `loop` as border_loops gives it. Returns false
// where no such patch exists.
bool fill_hole(TriangleMesh& mesh, const std::vector<std::int32_t>& loop);

}  // namespace geometry::detail
