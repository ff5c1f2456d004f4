// Colour maps: perceptually uniform, readable with every common colour blindness, and none of them a rainbow.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace render {

using Color = Eigen::Vector3f;  // sRGB, each 0 ... 1

// viridis, inferno, plasma, cividis: from dark to light as the value grows. diverging: blue - light grey - orange about the middle.
enum class Colormap { viridis, inferno, plasma, cividis, diverging };

// The colour at t; t is cut to [0, 1], NaN gives a grey that no map contains.
Color map_color(Colormap map, double t);

// `count` colours from t = 0 to t = 1 inclusive, for a texture; RGB bytes.
std::vector<std::array<std::uint8_t, 3>> color_table(Colormap map, int count);

// The map of that name; throws std::invalid_argument naming the known ones.
Colormap colormap_by_name(std::string_view name);
std::vector<std::string> colormap_names();

// CIE L* (0 black ... 100 white) of an sRGB colour, D65.
double lightness(const Color& color);

}  // namespace render
