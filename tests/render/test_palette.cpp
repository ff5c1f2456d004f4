#include "render/palette.h"

#include <gtest/gtest.h>

#include <cmath>

namespace render {
namespace {

TEST(Palette, few_colours_are_kept_exactly) {
  Image image(6, 1);
  const std::array<std::uint8_t, 3> colors[3] = {{200, 30, 30}, {30, 180, 60}, {40, 60, 210}};
  for (int x = 0; x < 6; ++x)
    for (int k = 0; k < 3; ++k) image.at(x, 0)[k] = colors[x % 3][k];
  const Palette palette = make_palette(image);
  ASSERT_EQ(palette.size(), 3u);
  const std::vector<std::uint8_t> pixels = indexed(image, palette);
  for (int x = 0; x < 6; ++x) EXPECT_EQ(palette[pixels[x]], colors[x % 3]);
}

TEST(Palette, many_colours_come_near_in_256) {
  Image image(64, 64);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x)
      image.at(x, y)[0] = static_cast<std::uint8_t>(4 * x), image.at(x, y)[1] = static_cast<std::uint8_t>(4 * y), image.at(x, y)[2] = 90;
  const Palette palette = make_palette(image);
  EXPECT_EQ(palette.size(), 256u);
  const std::vector<std::uint8_t> pixels = indexed(image, palette);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x)
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(palette[pixels[64 * y + x]][k], image.at(x, y)[k], 20);
}

}  // namespace
}  // namespace render
