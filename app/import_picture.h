// import.png: what was understood of a patient's mesh. The vessel as glass with its ends in colour and named, the centreline, the root's
// rings and commissures, the leaflets, what is wrong and where.
#pragma once

#include <filesystem>
#include <vector>

#include "geometry/import_mesh.h"
#include "render/frame.h"

namespace app {

// `leaflets`: as they will stand in the root, metres; may be empty.
render::Frame import_frame(const geometry::ImportResult& imported, const std::vector<geometry::TriangleMesh>& leaflets);

// 1920 x 1080 PNG. Throws std::runtime_error where no EGL device works or the file cannot be written.
void write_import_picture(const geometry::ImportResult& imported, const std::vector<geometry::TriangleMesh>& leaflets,
                          const std::filesystem::path& file);

}  // namespace app
