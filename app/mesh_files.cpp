#include "app/mesh_files.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "app/base64.h"
#include "render/colormap.h"

namespace app {
namespace {

std::ofstream opened(const std::filesystem::path& file) {
  std::ofstream stream(file, std::ios::binary);
  if (!stream) throw std::runtime_error(file.string() + ": can't be written; is the folder there?");
  return stream;
}

template <class T>
void put(std::ofstream& stream, const T& value) {
  stream.write(reinterpret_cast<const char*>(&value), sizeof value);
}

std::array<float, 3> normal_of(const std::array<float, 3>& a, const std::array<float, 3>& b, const std::array<float, 3>& c) {
  const float u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
  std::array<float, 3> n{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
  const float length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  for (float& x : n) x = length > 0 ? x / length : 0;
  return n;
}

constexpr const char* notice = "for planning research, not for clinical decisions; SI units (m, m/s, Pa)";

template <class T>
std::size_t append(std::vector<unsigned char>& buffer, const std::vector<T>& values) {
  const std::size_t at = buffer.size();
  buffer.resize(at + values.size() * sizeof(T));
  if (!values.empty()) std::memcpy(buffer.data() + at, values.data(), values.size() * sizeof(T));
  while (buffer.size() % 4) buffer.push_back(0);
  return at;
}

}  // namespace

void write_stl(const ExportSurface& surface, const std::filesystem::path& file) {
  std::ofstream stream = opened(file);
  char heading[80] = "surface";
  stream.write(heading, sizeof heading);
  put(stream, static_cast<std::uint32_t>(surface.triangles.size()));
  for (const auto& triangle : surface.triangles) {
    const auto &a = surface.points[triangle[0]], &b = surface.points[triangle[1]], &c = surface.points[triangle[2]];
    for (const auto& vector : {normal_of(a, b, c), a, b, c}) put(stream, vector);
    put(stream, std::uint16_t{0});
  }
}

void write_ply(const ExportSurface& surface, const std::filesystem::path& file) {
  std::ofstream stream = opened(file);
  stream << "ply\nformat binary_little_endian 1.0\ncomment " << notice << "\nelement vertex " << surface.points.size()
         << "\nproperty float x\nproperty float y\nproperty float z\n";
  for (const NamedField& field : surface.fields)
    for (int k = 0; k < field.components; ++k)
      stream << "property float " << field.name << (field.components > 1 ? "_" + std::to_string(k) : "") << "\n";
  stream << "element face " << surface.triangles.size() << "\nproperty list uchar int vertex_indices\nend_header\n";
  for (std::size_t i = 0; i < surface.points.size(); ++i) {
    put(stream, surface.points[i]);
    for (const NamedField& field : surface.fields)
      for (int k = 0; k < field.components; ++k)
        put(stream, field.values[i * static_cast<std::size_t>(field.components) + static_cast<std::size_t>(k)]);
  }
  for (const auto& triangle : surface.triangles) put(stream, std::uint8_t{3}), put(stream, triangle);
}

void write_vtp(const ExportSurface& surface, const std::filesystem::path& file) {
  std::ofstream stream = opened(file);
  const std::size_t points = surface.points.size(), triangles = surface.triangles.size();
  const bool cloud = triangles == 0;
  stream << "<?xml version=\"1.0\"?>\n<!-- " << notice
         << " -->\n<VTKFile type=\"PolyData\" version=\"0.1\" byte_order=\"LittleEndian\">\n<PolyData>\n<FieldData>\n<DataArray "
            "type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" format=\"ascii\">"
         << surface.time
         << "</DataArray>\n</FieldData>\n<Piece "
            "NumberOfPoints=\""
         << points << "\" NumberOfVerts=\"" << (cloud ? points : 0) << "\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\""
         << triangles << "\">\n<PointData>\n";
  for (const NamedField& field : surface.fields) {
    stream << "<DataArray type=\"Float32\" Name=\"" << field.name << "\" NumberOfComponents=\"" << field.components
           << "\" format=\"ascii\">\n";
    if (!field.units.empty())
      stream << "<InformationKey name=\"UNITS_LABEL\" location=\"vtkDataArray\">" << field.units << "</InformationKey>\n";
    for (float value : field.values) stream << value << " ";
    stream << "\n</DataArray>\n";
  }
  stream << "</PointData>\n<Points>\n<DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">\n";
  stream.precision(9);
  for (const auto& p : surface.points) stream << p[0] << " " << p[1] << " " << p[2] << "\n";
  stream << "</DataArray>\n</Points>\n<" << (cloud ? "Verts" : "Polys")
         << ">\n<DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">\n";
  for (std::size_t i = 0; cloud && i < points; ++i) stream << i << " ";
  for (const auto& t : surface.triangles) stream << t[0] << " " << t[1] << " " << t[2] << "\n";
  stream << "</DataArray>\n<DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">\n";
  for (std::size_t i = 1; i <= (cloud ? points : triangles); ++i) stream << (cloud ? i : 3 * i) << " ";
  stream << "\n</DataArray>\n</" << (cloud ? "Verts" : "Polys") << ">\n</Piece>\n</PolyData>\n</VTKFile>\n";
}

void write_gltf(const ExportSurface& surface, const std::filesystem::path& file) {
  using nlohmann::json;
  std::vector<unsigned char> buffer;
  std::vector<float> flat, color;
  std::array<float, 3> low{1e30f, 1e30f, 1e30f}, high{-1e30f, -1e30f, -1e30f};
  for (const auto& p : surface.points)
    for (std::size_t k = 0; k < 3; ++k) flat.push_back(p[k]), low[k] = std::min(low[k], p[k]), high[k] = std::max(high[k], p[k]);
  std::vector<std::uint32_t> index;
  for (const auto& t : surface.triangles)
    for (std::int32_t corner : t) index.push_back(static_cast<std::uint32_t>(corner));
  json gltf{{"asset", {{"version", "2.0"}, {"generator", "cusp"}, {"extras", {{"notice", notice}, {"time", surface.time}}}}},
            {"scene", 0},
            {"scenes", json::array({{{"nodes", {0}}}})},
            {"nodes", json::array({{{"mesh", 0}}})}};
  const auto view = [&](std::size_t at, std::size_t bytes, int target) {
    gltf["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", at}, {"byteLength", bytes}, {"target", target}});
    return gltf["bufferViews"].size() - 1;
  };
  const std::size_t position = view(append(buffer, flat), flat.size() * 4, 34962);
  gltf["accessors"].push_back(
      {{"bufferView", position}, {"componentType", 5126}, {"count", surface.points.size()}, {"type", "VEC3"}, {"min", low}, {"max", high}});
  json primitive{{"attributes", {{"POSITION", 0}}}, {"mode", 4}};
  if (!surface.fields.empty() && surface.fields.front().components == 1 && !surface.fields.front().values.empty()) {
    const std::vector<float>& values = surface.fields.front().values;
    const float top = std::max(1e-30f, *std::max_element(values.begin(), values.end()));
    for (float value : values) {
      const render::Color c = render::map_color(render::Colormap::inferno, std::clamp(value / top, 0.0f, 1.0f));
      for (int k = 0; k < 3; ++k) color.push_back(std::pow(c[k], 2.2f));  // glTF's vertex colours are linear
    }
    const std::size_t at = view(append(buffer, color), color.size() * 4, 34962);
    gltf["accessors"].push_back({{"bufferView", at}, {"componentType", 5126}, {"count", surface.points.size()}, {"type", "VEC3"}});
    primitive["attributes"]["COLOR_0"] = 1;
  }
  const std::size_t indices = view(append(buffer, index), index.size() * 4, 34963);
  gltf["accessors"].push_back({{"bufferView", indices}, {"componentType", 5125}, {"count", index.size()}, {"type", "SCALAR"}});
  primitive["indices"] = gltf["accessors"].size() - 1;
  primitive["material"] = 0;
  gltf["materials"].push_back({{"doubleSided", true}, {"pbrMetallicRoughness", {{"metallicFactor", 0.0}, {"roughnessFactor", 0.8}}}});
  gltf["meshes"].push_back({{"primitives", json::array({primitive})}});
  gltf["buffers"].push_back({{"byteLength", buffer.size()}, {"uri", "data:application/octet-stream;base64," + base64(buffer)}});
  opened(file) << gltf.dump();
}

}  // namespace app
