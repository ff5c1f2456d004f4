// Private to the readers: what runs inside load_mesh's child process. All throw std::runtime_error without the file's name (the caller adds
// it).
#pragma once

#include <string>
#include <string_view>

#include "geometry/load_mesh.h"

namespace geometry::detail {

// Everything assimp reads; `format` is the lower-case suffix.
LoadedMesh read_with_assimp(const std::string& path, const std::string& format);

// VTK polydata: .vtp (XML: ascii, base64, appended raw or base64, zlib) and legacy .vtk (ascii, binary).
LoadedMesh read_vtp(std::string_view bytes);
LoadedMesh read_legacy_vtk(std::string_view bytes);

// "stl", "ply", ... by the file's first bytes and size; "" = cannot tell (OBJ has no mark).
std::string sniff_format(std::string_view bytes);

// Refuses files whose header promises more than the file holds, in one line; `most_triangles` bounds any claim.
void check_claims(std::string_view bytes, const std::string& format, std::size_t most_triangles);

// Refuses, after reading, a mesh with fewer faces than the file's header announced, no triangle, or a vertex that is not finite.
void check_loaded(const LoadedMesh& mesh, std::string_view bytes);

}  // namespace geometry::detail
