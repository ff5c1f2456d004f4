#include "render/text.h"

#include <ft2build.h>
#include FT_FREETYPE_H

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

namespace render {

struct Font::Face {
  FT_Library library = nullptr;
  FT_Face face = nullptr;
  ~Face() {
    if (face) FT_Done_Face(face);
    if (library) FT_Done_FreeType(library);
  }
};

namespace {

// The letters of a UTF-8 text; a byte that starts none becomes U+FFFD.
std::vector<char32_t> letters(std::string_view text) {
  std::vector<char32_t> result;
  for (std::size_t i = 0; i < text.size();) {
    const auto first = static_cast<unsigned char>(text[i]);
    const int length = first < 0x80 ? 1 : (first >> 5) == 6 ? 2 : (first >> 4) == 14 ? 3 : (first >> 3) == 30 ? 4 : 0;
    char32_t letter = length == 1 ? first : first & (0x7f >> length);
    bool good = length > 0 && i + length <= text.size();
    for (int k = 1; good && k < length; ++k) {
      const auto next = static_cast<unsigned char>(text[i + k]);
      good = (next >> 6) == 2;
      letter = (letter << 6) | (next & 0x3f);
    }
    result.push_back(good ? letter : U'\uFFFD');
    i += good ? length : 1;
  }
  return result;
}

}  // namespace

Font::Font(bool bold) : face_(std::make_unique<Face>()) {
  const auto file = font_file(bold);
  if (FT_Init_FreeType(&face_->library) != 0 ||
      FT_New_Memory_Face(face_->library, file.data(), static_cast<FT_Long>(file.size()), 0, &face_->face) != 0)
    throw std::runtime_error("FreeType cannot open the built-in font");
}
Font::~Font() = default;
Font::Font(Font&&) noexcept = default;

const Font::Glyph& Font::glyph(char32_t letter, int size) {
  const auto found = glyphs_.find({size, letter});
  if (found != glyphs_.end()) return found->second;
  Glyph glyph;
  FT_Set_Pixel_Sizes(face_->face, 0, static_cast<FT_UInt>(std::max(size, 1)));
  if (FT_Load_Char(face_->face, letter, FT_LOAD_RENDER | FT_LOAD_TARGET_LIGHT) == 0) {
    const FT_GlyphSlot slot = face_->face->glyph;
    glyph.left = slot->bitmap_left;
    glyph.top = slot->bitmap_top;
    glyph.width = static_cast<int>(slot->bitmap.width);
    glyph.height = static_cast<int>(slot->bitmap.rows);
    glyph.advance = static_cast<float>(slot->advance.x) / 64;
    for (int y = 0; y < glyph.height; ++y)
      glyph.cover.insert(glyph.cover.end(), slot->bitmap.buffer + y * slot->bitmap.pitch,
                         slot->bitmap.buffer + y * slot->bitmap.pitch + glyph.width);
  }
  return glyphs_.emplace(std::pair{size, letter}, std::move(glyph)).first->second;
}

float Font::width(std::string_view text, int size) {
  float sum = 0;
  for (const char32_t letter : letters(text)) sum += glyph(letter, size).advance;
  return sum;
}

float Font::draw(Image& image, float x, float y, int size, std::string_view text, const Color& color, Align align) {
  const float wide = width(text, size);
  if (align == Align::center) x -= 0.5f * wide;
  if (align == Align::right) x -= wide;
  for (const char32_t letter : letters(text)) {
    const Glyph& g = glyph(letter, size);
    const int left = static_cast<int>(std::lround(x)) + g.left, top = static_cast<int>(std::lround(y)) - g.top;
    for (int row = 0; row < g.height; ++row)
      for (int column = 0; column < g.width; ++column)
        if (const std::uint8_t cover = g.cover[static_cast<std::size_t>(row) * g.width + column])
          blend(image, left + column, top + row, color, static_cast<float>(cover) / 255);
    x += g.advance;
  }
  return wide;
}

void blend(Image& image, int x, int y, const Color& color, float opacity) {
  if (x < 0 || y < 0 || x >= image.width || y >= image.height || opacity <= 0) return;
  std::uint8_t* pixel = image.at(x, y);
  for (int k = 0; k < 3; ++k) {
    const float old = pixel[k];
    pixel[k] = static_cast<std::uint8_t>(std::lround(std::clamp(old + std::min(opacity, 1.0f) * (255 * color[k] - old), 0.0f, 255.0f)));
  }
}

void fill(Image& image, float x, float y, float width, float height, const Color& color, float opacity) {
  const int left = static_cast<int>(std::lround(x)), top = static_cast<int>(std::lround(y));
  const int right = static_cast<int>(std::lround(x + width)), bottom = static_cast<int>(std::lround(y + height));
  const std::uint8_t solid[4] = {static_cast<std::uint8_t>(std::lround(255 * color[0])),
                                 static_cast<std::uint8_t>(std::lround(255 * color[1])),
                                 static_cast<std::uint8_t>(std::lround(255 * color[2])), 255};
  for (int row = std::max(top, 0); row < std::min(bottom, image.height); ++row)
    for (int column = std::max(left, 0); column < std::min(right, image.width); ++column)
      if (opacity >= 1)
        std::memcpy(image.at(column, row), solid, 4);
      else
        blend(image, column, row, color, opacity);
}

void stroke(Image& image, float x0, float y0, float x1, float y1, float width, const Color& color, float opacity) {
  const float reach = 0.5f * width + 1, dx = x1 - x0, dy = y1 - y0, length2 = dx * dx + dy * dy;
  const int left = std::max(0, static_cast<int>(std::floor(std::min(x0, x1) - reach)));
  const int right = std::min(image.width - 1, static_cast<int>(std::ceil(std::max(x0, x1) + reach)));
  const int top = std::max(0, static_cast<int>(std::floor(std::min(y0, y1) - reach)));
  const int bottom = std::min(image.height - 1, static_cast<int>(std::ceil(std::max(y0, y1) + reach)));
  for (int y = top; y <= bottom; ++y)
    for (int x = left; x <= right; ++x) {
      const float px = static_cast<float>(x) + 0.5f - x0, py = static_cast<float>(y) + 0.5f - y0;
      const float t = length2 > 0 ? std::clamp((px * dx + py * dy) / length2, 0.0f, 1.0f) : 0.0f;
      const float distance = std::hypot(px - t * dx, py - t * dy);
      blend(image, x, y, color, opacity * std::clamp(0.5f * width + 0.5f - distance, 0.0f, 1.0f));
    }
}

void disc(Image& image, float x, float y, float radius, const Color& color, float opacity) {
  stroke(image, x, y, x, y, 2 * radius, color, opacity);
}

}  // namespace render
