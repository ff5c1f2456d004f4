// Text and plain shapes drawn into an Image, on the processor: the same pixels on every machine.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "render/colormap.h"
#include "render/image.h"

namespace render {

enum class Align { left, center, right };

// DejaVu Sans, built into the library. UTF-8.
class Font {
 public:
  explicit Font(bool bold = false);
  ~Font();
  Font(Font&&) noexcept;
  // Pixels that the text is wide; `size` = height of the letters' box in pixels.
  float width(std::string_view text, int size);
  // Draws with the baseline at y; returns the width. Broken UTF-8 and letters the font lacks are drawn as boxes.
  float draw(Image& image, float x, float y, int size, std::string_view text, const Color& color, Align align = Align::left);

 private:
  struct Face;
  struct Glyph {
    int left = 0, top = 0, width = 0, height = 0;
    float advance = 0;
    std::vector<std::uint8_t> cover;
  };
  const Glyph& glyph(char32_t letter, int size);
  std::unique_ptr<Face> face_;
  std::map<std::pair<int, char32_t>, Glyph> glyphs_;
};

// The built-in font files (defined in the generated embedded.cpp).
std::span<const unsigned char> font_file(bool is_bold);

void blend(Image& image, int x, int y, const Color& color, float opacity);
void fill(Image& image, float x, float y, float width, float height, const Color& color, float opacity = 1);
void stroke(Image& image, float x0, float y0, float x1, float y1, float width, const Color& color, float opacity = 1);
void disc(Image& image, float x, float y, float radius, const Color& color, float opacity = 1);

}  // namespace render
