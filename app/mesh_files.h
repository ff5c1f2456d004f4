// Surfaces and particles written in others' formats.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace app {

struct NamedField {
  std::string name;           // "von_mises_stress"
  int components = 1;         // 1, 3 or 6
  std::vector<float> values;  // components a point
  std::string units = {};     // "Pa"
};
struct ExportSurface {
  std::vector<std::array<float, 3>> points;
  std::vector<std::array<std::int32_t, 3>> triangles;  // empty: a cloud of points
  std::vector<NamedField> fields;
  double time = 0;  // s, of the frame
};

// Each throws std::runtime_error where the file can't be written.
void write_stl(const ExportSurface& surface, const std::filesystem::path& file);   // binary; points as they are
void write_ply(const ExportSurface& surface, const std::filesystem::path& file);   // binary, fields as properties
void write_vtp(const ExportSurface& surface, const std::filesystem::path& file);   // VTK polydata, XML with text arrays
void write_gltf(const ExportSurface& surface, const std::filesystem::path& file);  // one file, buffers inside; colours by the first field

}  // namespace app
