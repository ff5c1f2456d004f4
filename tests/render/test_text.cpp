#include "render/text.h"

#include <gtest/gtest.h>

namespace render {
namespace {

int inked(const Image& image) {
  int count = 0;
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) count += image.rgba[i] < 128;
  return count;
}

TEST(Text, is_drawn_where_it_is_said_and_as_wide_as_it_measures) {
  Font font;
  Image image(300, 60);
  const float width = font.draw(image, 20, 40, 24, "HIH", Color(0, 0, 0));
  EXPECT_NEAR(width, font.width("HIH", 24), 1e-3);
  int left = 300, right = 0, top = 60, bottom = 0;
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 300; ++x)
      if (image.at(x, y)[0] < 128) {
        left = std::min(left, x);
        right = std::max(right, x);
        top = std::min(top, y);
        bottom = std::max(bottom, y);
      }
  EXPECT_NEAR(left, 22, 3);
  EXPECT_NEAR(right, 20 + width - 3, 3);
  EXPECT_NEAR(bottom, 39, 1);                   // capitals stand on the baseline
  EXPECT_NEAR(bottom - top + 1, 0.73 * 24, 2);  // DejaVu's capital height is 0.729 em
}

TEST(Text, aligns) {
  Font font;
  Image left(200, 40), right(200, 40);
  const float width = font.draw(left, 100 - font.width("kPa", 20), 30, 20, "kPa", Color(0, 0, 0));
  font.draw(right, 100, 30, 20, "kPa", Color(0, 0, 0), Align::right);
  EXPECT_GT(width, 0);
  EXPECT_EQ(left.rgba, right.rgba);
}

TEST(Text, different_letters_differ_and_bold_is_heavier) {
  Font regular, bold(true);
  Image a(60, 40), b(60, 40), heavy(60, 40);
  regular.draw(a, 10, 30, 24, "8", Color(0, 0, 0));
  regular.draw(b, 10, 30, 24, "1", Color(0, 0, 0));
  bold.draw(heavy, 10, 30, 24, "8", Color(0, 0, 0));
  EXPECT_NE(a.rgba, b.rgba);
  EXPECT_GT(inked(heavy), inked(a));
}

TEST(Text, reads_utf8_and_survives_what_is_not) {
  Font font;
  EXPECT_NEAR(font.width("\u00b5", 20), font.width("u", 20), 3);  // one letter, not two
  Image image(100, 40);
  font.draw(image, 5, 30, 20, "\xff\xc3", Color(0, 0, 0));
  EXPECT_GT(inked(image), 0);
}

TEST(Text, shapes_cover_what_they_should) {
  Image image(100, 100);
  fill(image, 10, 20, 30, 40, Color(0, 0, 0));
  EXPECT_EQ(inked(image), 30 * 40);
  Image circle(100, 100);
  disc(circle, 50, 50, 20, Color(0, 0, 0));
  EXPECT_NEAR(inked(circle), 3.14159 * 400, 30);
  Image line(100, 100);
  stroke(line, 10, 50, 90, 50, 4, Color(0, 0, 0));
  EXPECT_NEAR(inked(line), 80 * 4 + 3.14 * 4, 16);
  fill(image, -50, -50, 500, 500, Color(1, 0, 0), 0.5f);  // outside is left out, not written over
  EXPECT_EQ(image.at(99, 99)[1], 128);
}

}  // namespace
}  // namespace render
