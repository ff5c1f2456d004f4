// A picture in memory, and PNG files.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace render {

// 8-bit sRGB with alpha, row 0 at the top.
struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;  // 4 * width * height
  Image() = default;
  Image(int w, int h) : width(w), height(h), rgba(4 * static_cast<std::size_t>(w) * h, 255) {}
  std::uint8_t* at(int x, int y) { return &rgba[4 * (static_cast<std::size_t>(y) * width + x)]; }
  const std::uint8_t* at(int x, int y) const { return &rgba[4 * (static_cast<std::size_t>(y) * width + x)]; }
};

// Writes RGB (alpha is dropped); the same image gives the same bytes. Throws std::runtime_error naming the file.
void write_png(const Image& image, const std::string& path);
Image read_png(const std::string& path);

// Copies `source` with its top left corner at (x, y); what lies outside is left out.
void paste(Image& target, const Image& source, int x, int y);

}  // namespace render
