// A picture in 256 colours, for GIF.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "render/image.h"

namespace render {

using Palette = std::vector<std::array<std::uint8_t, 3>>;  // RGB

// At most `colors` (2 ... 256) colours by median cut (P. Heckbert 1982): the box of the most pixels times its longest side is cut at its
// median until there are enough; each colour is the mean of its box.
Palette make_palette(const Image& image, int colors = 256);

// For each pixel the index of the palette's nearest colour (of the middle of a cell of 8 x 8 x 8 levels, found once for each cell).
std::vector<std::uint8_t> indexed(const Image& image, const Palette& palette);

}  // namespace render
