// Binary glTF 2.0 (GLB) of several surfaces in several scenes: the stressed valve at chosen moments within its vessel.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace app {

struct GlbSurface {
  std::string name;
  std::vector<std::array<float, 3>> points;  // m
  std::vector<std::array<std::int32_t, 3>> triangles;
  std::vector<float> value;              // per point, shown by colour from 0 to `top`; kept as attribute _VALUE; may be empty
  std::optional<Eigen::Vector4f> color;  // of the whole surface where there are no values: sRGB and opacity
};
struct GlbScene {
  std::string name;
  std::vector<std::size_t> surfaces;  // indices; a surface may be in several scenes
};

// One file's bytes. `top`: value at the colour scale's end. Colours by the map of leaflets' stress in pictures. Coordinates as they are
// (metres); glTF says y is up: the viewer turns.
std::vector<unsigned char> glb_bytes(const std::vector<GlbSurface>& surfaces, const std::vector<GlbScene>& scenes, double top);

}  // namespace app
