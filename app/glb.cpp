#include "app/glb.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "render/colormap.h"

namespace app {
namespace {

using nlohmann::json;

float linear(float srgb) { return std::pow(srgb, 2.2f); }  // glTF's colours are linear

class Builder {
 public:
  json gltf{{"asset", {{"version", "2.0"}, {"generator", "cusp"}}}, {"scene", 0}};
  std::vector<unsigned char> binary;

  template <class T>
  std::size_t add(const std::vector<T>& values, int target, int component, const char* type, std::size_t count) {
    const std::size_t at = binary.size(), bytes = values.size() * sizeof(T);
    binary.resize(at + (bytes + 3) / 4 * 4);
    if (bytes > 0) std::memcpy(binary.data() + at, values.data(), bytes);
    gltf["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", at}, {"byteLength", bytes}, {"target", target}});
    gltf["accessors"].push_back(
        {{"bufferView", gltf["bufferViews"].size() - 1}, {"componentType", component}, {"count", count}, {"type", type}});
    return gltf["accessors"].size() - 1;
  }

  void add_surface(const GlbSurface& surface, double top) {
    constexpr int vertices = 34962, indices = 34963, floats = 5126, integers = 5125;
    std::vector<float> flat;
    std::array<float, 3> low{1e30f, 1e30f, 1e30f}, high{-1e30f, -1e30f, -1e30f};
    for (const auto& p : surface.points)
      for (std::size_t k = 0; k < 3; ++k) flat.push_back(p[k]), low[k] = std::min(low[k], p[k]), high[k] = std::max(high[k], p[k]);
    const std::size_t position = add(flat, vertices, floats, "VEC3", surface.points.size());
    gltf["accessors"][position]["min"] = low, gltf["accessors"][position]["max"] = high;
    json primitive{{"attributes", {{"POSITION", position}}}, {"mode", 4}, {"material", gltf["meshes"].size()}};
    if (!surface.value.empty()) {
      std::vector<float> color;
      for (const float value : surface.value) {
        const render::Color c = render::map_color(render::Colormap::inferno, value / std::max(top, 1e-30));
        for (int k = 0; k < 3; ++k) color.push_back(linear(c[k]));
      }
      primitive["attributes"]["COLOR_0"] = add(color, vertices, floats, "VEC3", surface.points.size());
      primitive["attributes"]["_VALUE"] = add(surface.value, vertices, floats, "SCALAR", surface.points.size());
    }
    std::vector<std::uint32_t> index;
    for (const auto& t : surface.triangles)
      for (const std::int32_t corner : t) index.push_back(static_cast<std::uint32_t>(corner));
    primitive["indices"] = add(index, indices, integers, "SCALAR", index.size());
    json material{{"doubleSided", true}, {"pbrMetallicRoughness", {{"metallicFactor", 0.0}, {"roughnessFactor", 0.8}}}};
    if (surface.color) {
      const Eigen::Vector4f& c = *surface.color;
      material["pbrMetallicRoughness"]["baseColorFactor"] = {linear(c[0]), linear(c[1]), linear(c[2]), c[3]};
      if (c[3] < 1) material["alphaMode"] = "BLEND";
    }
    gltf["materials"].push_back(material);
    gltf["meshes"].push_back({{"name", surface.name}, {"primitives", json::array({primitive})}});
    gltf["nodes"].push_back({{"name", surface.name}, {"mesh", gltf["meshes"].size() - 1}});
  }
};

void put(std::vector<unsigned char>& bytes, std::uint32_t word) {
  for (int k = 0; k < 4; ++k) bytes.push_back(static_cast<unsigned char>(word >> (8 * k)));
}

}  // namespace

std::vector<unsigned char> glb_bytes(const std::vector<GlbSurface>& surfaces, const std::vector<GlbScene>& scenes, double top) {
  Builder builder;
  builder.gltf["meshes"] = json::array();
  for (const GlbSurface& surface : surfaces) builder.add_surface(surface, top);
  for (const GlbScene& scene : scenes) builder.gltf["scenes"].push_back({{"name", scene.name}, {"nodes", scene.surfaces}});
  builder.gltf["buffers"].push_back({{"byteLength", builder.binary.size()}});
  std::string text = builder.gltf.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  std::vector<unsigned char> bytes;  // header, JSON chunk, binary chunk (glTF 2.0, section 4.4)
  put(bytes, 0x46546C67), put(bytes, 2), put(bytes, static_cast<std::uint32_t>(12 + 8 + text.size() + 8 + builder.binary.size()));
  put(bytes, static_cast<std::uint32_t>(text.size())), put(bytes, 0x4E4F534A);
  bytes.insert(bytes.end(), text.begin(), text.end());
  put(bytes, static_cast<std::uint32_t>(builder.binary.size())), put(bytes, 0x004E4942);
  bytes.insert(bytes.end(), builder.binary.begin(), builder.binary.end());
  return bytes;
}

}  // namespace app
