// Private to import_mesh: which unit makes this mesh an aorta.
#pragma once

#include <string>

#include "geometry/triangle_mesh.h"

namespace geometry::detail {

// "mm", "cm" or "m": the one unit in which the widest bore is 8-75 mm and the box 15-800 mm. The mesh is welded, in file units. Throws
// std::runtime_error asking for the units where none fits. (The window is less than a factor of ten wide: two never fit.)
std::string propose_units(const TriangleMesh& mesh);

}  // namespace geometry::detail
