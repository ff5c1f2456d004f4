#include "render/overlay.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "render/example_frame.h"

namespace render {
namespace {

int dark_pixels(const Image& image, const Rect& place) {
  int count = 0;
  for (int y = place.y; y < place.y + place.height; ++y)
    for (int x = place.x; x < place.x + place.width; ++x)
      count += image.at(x, y)[0] < 100 && image.at(x, y)[1] < 100 && image.at(x, y)[2] < 110;
  return count;
}

TEST(Overlay, ticks_are_round_and_within) {
  const Ticks ticks = round_ticks(0.3, 19.7, 5);
  EXPECT_EQ(ticks.values, (std::vector<double>{5, 10, 15}));
  EXPECT_EQ(ticks.decimals, 0);
  const Ticks fine = round_ticks(-0.02, 0.021, 4);
  EXPECT_EQ(fine.decimals, 2);
  ASSERT_EQ(fine.values.size(), 5u);
  EXPECT_NEAR(fine.values[0], -0.02, 1e-12);
  EXPECT_EQ(fine.values[2], 0.0);
  EXPECT_EQ(round_ticks(3, 3, 4).values.size(), 1u);
}

TEST(Overlay, numbers_read_as_print) {
  EXPECT_EQ(number_text(12.345, 1), "12.3");
  EXPECT_EQ(number_text(-2, 0), "\u22122");
  EXPECT_EQ(number_text(2.5e7, 0), "2.5e+07");
}

TEST(Overlay, panels_tile_the_picture_between_header_and_footer) {
  Frame frame = example::valve_frame(0.5f, 3e-3f);
  for (const int columns : {0, 1}) {
    frame.columns = columns;
    const Layout layout = lay_out(frame, 1920, 1080);
    ASSERT_EQ(layout.panels.size(), 2u);
    long area = static_cast<long>(layout.header.height + layout.footer.height + layout.plots.height) * 1920;
    for (const Rect& title : layout.titles) {
      EXPECT_GT(title.height, 0);  // the panels have titles: they stand above the pictures, not on them
      area += static_cast<long>(title.width) * title.height;
    }
    for (const Rect& panel : layout.panels) area += static_cast<long>(panel.width) * panel.height;
    EXPECT_EQ(area, 1920L * 1080);
  }
  EXPECT_THROW(lay_out(frame, 100, 50), std::invalid_argument);
}

// The legend shows the range: its ends carry the map's end colours, and the tick of a value stands at that value's colour.
TEST(Overlay, colour_bar_shows_the_map_from_end_to_end) {
  Image image(400, 600);
  Lettering lettering;
  const ColorScale scale{"Pressure", "kPa", 1e-3, 0, 2e4, Colormap::viridis};
  const Rect bar = color_bar_place({0, 0, 400, 600}, 0, 1, lettering.size);
  draw_color_bar(image, bar, scale, lettering);
  const auto expect_color = [&](int y, double t) {
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(image.at(bar.x + bar.width / 2, y)[k], 255 * map_color(Colormap::viridis, t)[k], 4) << "row " << y;
  };
  expect_color(bar.y, 1);
  expect_color(bar.y + bar.height - 1, 0);
  expect_color(bar.y + bar.height / 2, 0.5);
  // A tick at 10 kPa of 0 ... 20 stands in the middle, beside the bar, with its number; none stands between two ticks.
  EXPECT_LT(image.at(bar.x + bar.width + 4, bar.y + bar.height / 2)[0], 60);
  EXPECT_GT(dark_pixels(image, {bar.x + bar.width + 12, bar.y + bar.height / 2 - 8, 30, 16}), 10);
  EXPECT_EQ(dark_pixels(image, {bar.x + bar.width + 12, bar.y + bar.height / 2 + bar.height / 20 - 3, 30, 6}), 0);
  EXPECT_GT(dark_pixels(image, {bar.x - 60, bar.y - 36, 140, 24}), 60);  // the label with its unit
}

// The pointer stands at the highest value's colour, and at the bar's end where the value lies beyond it.
TEST(Overlay, colour_bar_points_at_the_highest_value) {
  Lettering lettering;
  ColorScale scale{"Stress", "kPa", 1e-3, 0, 2e4, Colormap::inferno};
  const Rect bar = color_bar_place({0, 0, 400, 600}, 0, 1, lettering.size);
  const auto pointed = [&](double highest) {
    scale.highest = highest;
    Image image(400, 600);
    draw_color_bar(image, bar, scale, lettering);
    EXPECT_GT(dark_pixels(image, {bar.x - 40, bar.y + bar.height + 26, 140, 20}), 20);  // the value in words
    int best = 0, most = 0;
    for (int y = bar.y - 8; y < bar.y + bar.height + 8; ++y)
      if (const int dark = dark_pixels(image, {bar.x - 8, y, 4, 1}); dark > most) most = dark, best = y;
    return best;
  };
  EXPECT_NEAR(pointed(1e4), bar.y + bar.height / 2, 3);
  EXPECT_NEAR(pointed(5e4), bar.y, 3);
}

TEST(Overlay, plot_cursor_moves_with_time) {
  Frame frame = example::valve_frame(0.5f, 3e-3f);
  Lettering lettering;
  const Rect place{0, 0, 800, 200};
  const auto darkest_column = [&](double time) {
    frame.time = time;
    Image image(800, 200);
    draw_plots(image, place, frame, lettering);
    int best = 0, most = 0;
    for (int x = 80; x < 770; ++x) {
      const int dark = dark_pixels(image, {x, 45, 1, 110});
      if (dark > most) {
        most = dark;
        best = x;
      }
    }
    return best;
  };
  const int early = darkest_column(0.2), late = darkest_column(0.6);
  const float left = 3.6f * 20, right = 800 - 1.7f * 20;  // the plot's frame
  EXPECT_NEAR(early, left + 0.25f * (right - left), 3);
  EXPECT_NEAR(late, left + 0.75f * (right - left), 3);
}

TEST(Overlay, header_and_footer_write_what_they_are_given) {
  Lettering lettering;
  Frame frame;
  Image bare(1200, 100), full(1200, 100);
  frame.caption = "";
  draw_header(bare, {0, 0, 1200, 66}, frame, lettering);
  EXPECT_EQ(dark_pixels(bare, {0, 0, 1200, 60}), 0);
  frame.title = "Case 12";
  frame.time = 0.125;
  draw_header(full, {0, 0, 1200, 66}, frame, lettering);
  EXPECT_GT(dark_pixels(full, {0, 0, 200, 60}), 100);
  EXPECT_GT(dark_pixels(full, {1000, 0, 200, 60}), 100);
}

}  // namespace
}  // namespace render
