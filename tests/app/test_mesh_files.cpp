// What is exported comes back through the program's own readers.
#include "app/mesh_files.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "geometry/check_mesh.h"
#include "geometry/load_mesh.h"

namespace {

app::ExportSurface tetrahedron() {
  app::ExportSurface surface;
  surface.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  surface.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  surface.fields = {{"von_mises_stress", 1, {1, 2, 3, 4}}, {"velocity", 3, {0, 0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 3}}};
  return surface;
}

std::filesystem::path folder() {
  const auto path = std::filesystem::temp_directory_path() / ("cusp_export_" + std::to_string(getpid()));
  std::filesystem::create_directories(path);
  return path;
}

double volume_read_back(const std::filesystem::path& file) {
  geometry::LoadedMesh loaded = geometry::load_mesh(file.string());
  geometry::weld_vertices(loaded.mesh);
  EXPECT_EQ(loaded.mesh.triangles.size(), 4u) << file;
  EXPECT_TRUE(geometry::measure_topology(loaded.mesh).closed()) << file;
  return geometry::signed_volume(loaded.mesh);
}

TEST(MeshFiles, ComeBackThroughTheReaders) {
  app::write_stl(tetrahedron(), folder() / "t.stl");
  app::write_ply(tetrahedron(), folder() / "t.ply");
  app::write_vtp(tetrahedron(), folder() / "t.vtp");
  app::write_gltf(tetrahedron(), folder() / "t.gltf");
  for (const char* name : {"t.stl", "t.ply", "t.vtp", "t.gltf"}) EXPECT_NEAR(volume_read_back(folder() / name), 1.0 / 6, 1e-6) << name;
}

TEST(MeshFiles, GltfBuffersHaveTheLengthTheySay) {
  app::write_gltf(tetrahedron(), folder() / "length.gltf");
  std::ifstream file(folder() / "length.gltf");
  const nlohmann::json gltf = nlohmann::json::parse(file);
  const std::string uri = gltf["buffers"][0]["uri"];
  const std::string digits = uri.substr(uri.find(',') + 1);
  const std::size_t padding = digits.size() - (digits.find_last_not_of('=') + 1);
  EXPECT_EQ(digits.size() / 4 * 3 - padding, gltf["buffers"][0]["byteLength"].get<std::size_t>());
}

TEST(MeshFiles, SayWhenTheyCannotBeWritten) { EXPECT_THROW(app::write_stl(tetrahedron(), "/nonexistent/x.stl"), std::runtime_error); }

}  // namespace
