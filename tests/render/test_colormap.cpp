#include "render/colormap.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace render {
namespace {

const Colormap sequential[] = {Colormap::viridis, Colormap::inferno, Colormap::plasma, Colormap::cividis};

// matplotlib's published tables (CC0), end points and middles as bytes.
TEST(Colormap, agrees_with_the_published_tables) {
  const auto near = [](Colormap map, double t, int r, int g, int b) {
    const double limit = map == Colormap::cividis ? 14 : 6;  // the fit to cividis is the coarser one, in blue at its bright end
    const Color color = 255 * map_color(map, t);
    EXPECT_NEAR(color[0], r, limit);
    EXPECT_NEAR(color[1], g, limit);
    EXPECT_NEAR(color[2], b, limit);
  };
  near(Colormap::viridis, 0, 68, 1, 84);
  near(Colormap::viridis, 0.5, 33, 145, 140);
  near(Colormap::viridis, 1, 253, 231, 37);
  near(Colormap::plasma, 0, 13, 8, 135);
  near(Colormap::plasma, 0.5, 204, 71, 120);
  near(Colormap::plasma, 1, 240, 249, 33);
  near(Colormap::cividis, 0, 0, 34, 78);
  near(Colormap::cividis, 0.5, 125, 124, 120);
  near(Colormap::cividis, 1, 254, 232, 56);
  near(Colormap::inferno, 1, 252, 255, 164);
  near(Colormap::inferno, (0.5 - 0.14) / 0.86, 188, 55, 84);
}

TEST(Colormap, lightness_grows_evenly_along_sequential_maps) {
  for (const Colormap map : sequential) {
    const double low = lightness(map_color(map, 0)), high = lightness(map_color(map, 1));
    EXPECT_LT(low, 25);
    EXPECT_GT(high, 85);
    for (int i = 0; i < 20; ++i) {
      const double step = lightness(map_color(map, (i + 1) / 20.0)) - lightness(map_color(map, i / 20.0));
      EXPECT_GT(step, 0.4 * (high - low) / 20) << "map " << static_cast<int>(map) << " at " << i / 20.0;
      EXPECT_LT(step, 1.8 * (high - low) / 20) << "map " << static_cast<int>(map) << " at " << i / 20.0;
    }
  }
}

TEST(Colormap, diverging_is_symmetric_in_lightness_and_lightest_in_the_middle) {
  for (const double part : {0.1, 0.25, 0.4}) {
    const double left = lightness(map_color(Colormap::diverging, part)), right = lightness(map_color(Colormap::diverging, 1 - part));
    EXPECT_NEAR(left, right, 4);
    EXPECT_GT(lightness(map_color(Colormap::diverging, 0.5)), left + 5);
  }
}

// Deuteranopia and protanopia by the matrices of Machado, Oliveira & Fernandes 2009 (severity 1): the ends must stay apart in colour, not
// only in lightness.
TEST(Colormap, diverging_ends_stay_apart_for_the_colour_blind) {
  Eigen::Matrix3f protan, deutan;
  protan << 0.152286f, 1.052583f, -0.204868f, 0.114503f, 0.786281f, 0.099216f, -0.003882f, -0.048116f, 1.051998f;
  deutan << 0.367322f, 0.860646f, -0.227968f, 0.280085f, 0.672501f, 0.047413f, -0.011820f, 0.042940f, 0.968881f;
  const auto linear = [](const Color& c) { return Eigen::Vector3f(c.array().pow(2.2f)); };
  for (const Eigen::Matrix3f& sight : {protan, deutan}) {
    const Eigen::Vector3f apart = sight * (linear(map_color(Colormap::diverging, 0)) - linear(map_color(Colormap::diverging, 1)));
    EXPECT_GT(apart.norm(), 0.25f);
  }
}

TEST(Colormap, cuts_what_lies_outside_and_marks_what_is_no_number) {
  for (const Colormap map : sequential) {
    EXPECT_EQ(map_color(map, -3), map_color(map, 0));
    EXPECT_EQ(map_color(map, 7), map_color(map, 1));
    const Color grey = map_color(map, std::nan(""));
    EXPECT_EQ(grey[0], grey[1]);
    EXPECT_EQ(grey[1], grey[2]);
  }
}

TEST(Colormap, table_runs_from_end_to_end) {
  const auto table = color_table(Colormap::viridis, 256);
  ASSERT_EQ(table.size(), 256u);
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(table[0][k], std::lround(255 * map_color(Colormap::viridis, 0)[k]));
    EXPECT_EQ(table[255][k], std::lround(255 * map_color(Colormap::viridis, 1)[k]));
  }
}

TEST(Colormap, names_lead_back_and_unknown_ones_are_refused_with_the_known) {
  for (const std::string& name : colormap_names()) EXPECT_NO_THROW(colormap_by_name(name));
  try {
    colormap_by_name("rainbow");
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("viridis"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("rainbow"), std::string::npos);
  }
}

}  // namespace
}  // namespace render
