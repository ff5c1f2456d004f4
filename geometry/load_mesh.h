// Reads a surface from a file into memory: nothing is welded, repaired or scaled here.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/triangle_mesh.h"

namespace geometry {

struct LoadedMesh {
  TriangleMesh mesh;                            // vertices in FILE units; STL corners are still split
  std::vector<std::int32_t> group_of_triangle;  // index into group_names, one a triangle
  std::vector<std::string> group_names;         // OBJ groups, GLB nodes, VTK face ids ("ModelFaceID 3"); at least one
  std::string format;                           // "stl", "obj", "ply", "glb", "gltf", "off", "vtp", "vtk"
  double metres_per_unit = 0;                   // fixed by the format (glTF: 1); 0 = the file does not say
};

// The limits of the child process in which foreign bytes are parsed.
struct LoadLimits {
  std::size_t memory = std::size_t(2) << 30;  // bytes beyond what this process already maps
  double seconds = 45;                        // wall and processor time
  std::size_t triangles = 20'000'000;         // more are refused
};

// STL, OBJ, PLY, GLB/glTF, OFF (assimp) and VTK polydata (.vtp, .vtk). Throws std::runtime_error with one line naming the file, what is
// wrong and the mend, whatever the file holds: the parsing happens in a child process that may crash, hang or eat memory in peace.
LoadedMesh load_mesh(const std::string& path, const LoadLimits& limits = {});

// "m", "cm", "mm", "um" (also "meter", "millimetres"...), or a number of them ("120 mm") -> metres. Throws std::runtime_error naming the
// known ones.
double metres_per_unit(std::string_view units);

}  // namespace geometry
