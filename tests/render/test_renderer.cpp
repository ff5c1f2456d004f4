// What the pictures show, pixel by pixel.
#include "render/renderer.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <stdexcept>

#include "render/example_frame.h"
#include "render/overlay.h"

namespace render {
namespace {

Renderer& renderer() {
  static Renderer one;
  return one;
}

const PictureSettings small{480, 360, {}};

// One panel, orthographic along -z, 10 mm high, no words.
Frame plain_frame() {
  Frame frame;
  frame.scales = {{"x", "m", 1, 0, 1, Colormap::viridis}};
  Panel panel;
  panel.camera.width = panel.camera.height = 0.010f;
  panel.scale_bar = false;
  frame.panels = {panel};
  return frame;
}

struct Seen {
  Rect place;
  Projection projection;
};
Seen view_of(const Frame& frame, const PictureSettings& settings, int panel = 0) {
  const Layout layout = lay_out(frame, settings.width, settings.height);
  const Rect place = layout.panels[panel];
  return {place,
          panel_projection(frame, frame.panels[panel], place.width, place.height, legend_space(frame.panels[panel], layout.text_size))};
}

Eigen::Vector3i pixel_at(const Image& image, const Seen& seen, const Eigen::Vector3f& point) {
  const Eigen::Vector3f at = to_pixel(seen.projection, point);
  const std::uint8_t* p = image.at(seen.place.x + static_cast<int>(at.x()), seen.place.y + static_cast<int>(at.y()));
  return {p[0], p[1], p[2]};
}

Surface square(float half, float z) {
  Surface surface;
  surface.vertices = {{-half, -half, z}, {half, -half, z}, {half, half, z}, {-half, half, z}};
  surface.triangles = {{0, 1, 2}, {0, 2, 3}};
  return surface;
}

bool is_background(const Eigen::Vector3i& pixel) {  // a grey-blue gradient, light
  return pixel.minCoeff() > 195 && pixel.z() >= pixel.x() && pixel.z() - pixel.x() < 25;
}

TEST(Renderer, a_disc_lands_at_its_pixel_with_the_mapped_colour) {
  Frame frame = plain_frame();
  frame.particles = {{"p", {{0.002f, -0.003f, 0}}, {{0.7f}}, 0.0008f}};
  frame.panels[0].particles = {{0, {0, 0}, ParticleShape::disc}};
  const Image image = renderer().draw(frame, small);
  const Seen seen = view_of(frame, small);
  const Color wanted = 255 * map_color(Colormap::viridis, 0.7);
  const Eigen::Vector3i found = pixel_at(image, seen, {0.002f, -0.003f, 0});
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(found[k], wanted[k], 2);
  EXPECT_FALSE(is_background(pixel_at(image, seen, {0.002f + 0.0007f, -0.003f, 0})));
  EXPECT_TRUE(is_background(pixel_at(image, seen, {0.002f + 0.0010f, -0.003f, 0})));
  EXPECT_TRUE(is_background(pixel_at(image, seen, {0.002f, -0.003f - 0.0010f, 0})));
}

TEST(Renderer, a_ball_is_shaded_keeps_its_hue_and_has_depth) {
  Frame frame = plain_frame();
  frame.particles = {{"p", {{0, 0, 0}, {0.0015f, 0, 0}}, {{0.2f, 0.9f}}, 0.002f}};
  frame.panels[0].particles = {{0, {0, 0}}};
  const Image image = renderer().draw(frame, small);
  const Seen seen = view_of(frame, small);
  // Two equal balls part in the plane half way between them, seen from the side.
  const Eigen::Vector3i left = pixel_at(image, seen, {0.0005f, 0, 0}), right = pixel_at(image, seen, {0.0010f, 0, 0});
  EXPECT_GT(left.z(), left.x());    // viridis at 0.2: blue above red
  EXPECT_GT(right.y(), right.z());  // at 0.9: green above blue
  // Lit from the upper left: brighter there than at the lower right of the same ball.
  EXPECT_GT(pixel_at(image, seen, {-0.0006f, 0.0009f, 0}).sum(), pixel_at(image, seen, {-0.0006f, -0.0016f, 0}).sum() + 30);
}

TEST(Renderer, balls_are_round_in_perspective_too) {
  Frame frame = plain_frame();
  frame.panels[0].camera.field_of_view = 0.5f;
  frame.particles = {{"p", {{0, 0, 0}}, {}, 0.003f}};
  frame.panels[0].particles = {{0, {}}};
  const Image image = renderer().draw(frame, small);
  const Seen seen = view_of(frame, small);
  const float distance = 0.005f / std::tan(0.25f), edge = 0.003f * distance / std::sqrt(distance * distance - 0.003f * 0.003f);
  for (const Eigen::Vector3f& way : {Eigen::Vector3f(1, 0, 0), Eigen::Vector3f(0, -1, 0), Eigen::Vector3f(0.70711f, 0.70711f, 0)}) {
    EXPECT_FALSE(is_background(pixel_at(image, seen, 0.96f * edge * way)));
    EXPECT_TRUE(is_background(pixel_at(image, seen, 1.04f * edge * way)));
  }
}

TEST(Renderer, nearer_things_hide_farther_ones) {
  Frame frame = plain_frame();
  frame.surfaces = {square(0.003f, 0), square(0.002f, 0.001f)};
  frame.panels[0].surfaces = {{1, {-1, -1, Color(0.8f, 0.1f, 0.1f)}}, {0, {-1, -1, Color(0.1f, 0.1f, 0.8f)}}};
  const Image image = renderer().draw(frame, small);
  const Seen seen = view_of(frame, small);
  EXPECT_GT(pixel_at(image, seen, {0, 0, 0}).x(), 150);
  EXPECT_GT(pixel_at(image, seen, {0.0026f, 0, 0}).z(), 120);
  EXPECT_LT(pixel_at(image, seen, {0.0026f, 0, 0}).x(), 60);
}

TEST(Renderer, a_surface_shows_its_values_between_its_corners) {
  Frame frame = plain_frame();
  frame.surfaces = {square(0.004f, 0)};
  frame.surfaces[0].fields = {{0.1f, 0.9f, 0.9f, 0.1f}};
  frame.panels[0].surfaces = {{0, {0, 0}}};
  const Image image = renderer().draw(frame, small);
  const Seen seen = view_of(frame, small);
  for (const float x : {-0.003f, 0.0f, 0.003f}) {
    const Color wanted = map_color(Colormap::viridis, 0.5 + 0.4 * x / 0.004);
    const Eigen::Vector3f found = pixel_at(image, seen, {x, 0.001f, 0}).cast<float>() / 255;
    EXPECT_NEAR((found.normalized() - wanted.normalized()).norm(), 0, 0.08) << "x = " << x;  // the hue; shading scales it
    EXPECT_NEAR(found.norm() / wanted.norm(), 1, 0.2);
  }
}

TEST(Renderer, glass_lets_what_is_behind_through_in_the_right_order) {
  Frame frame = plain_frame();
  frame.surfaces = {square(0.004f, -0.002f), square(0.003f, 0.001f), square(0.003f, 0.002f)};
  const Color red(0.9f, 0.1f, 0.1f), blue(0.1f, 0.1f, 0.9f), white(1, 1, 1);
  const auto middle = [&](const std::vector<SurfaceLayer>& layers) {
    frame.panels[0].surfaces = layers;
    return pixel_at(renderer().draw(frame, small), view_of(frame, small), {0.0003f, 0.0001f, 0});
  };
  const Eigen::Vector3i bare = middle({{0, {-1, -1, white}}});
  const Eigen::Vector3i through = middle({{0, {-1, -1, white}}, {1, {-1, -1, red, 0.4f}}});
  EXPECT_GT(through.x(), through.y() + 40);  // tinted ...
  EXPECT_GT(through.y(), 100);               // ... yet what is behind shows
  EXPECT_LT(through.y(), bare.y());
  // Red before blue and blue before red differ, and do not depend on the order in which they were named.
  const Eigen::Vector3i blue_front = middle({{0, {-1, -1, white}}, {1, {-1, -1, red, 0.5f}}, {2, {-1, -1, blue, 0.5f}}});
  const Eigen::Vector3i same = middle({{2, {-1, -1, blue, 0.5f}}, {1, {-1, -1, red, 0.5f}}, {0, {-1, -1, white}}});
  const Eigen::Vector3i red_front = middle({{0, {-1, -1, white}}, {1, {-1, -1, blue, 0.5f}}, {2, {-1, -1, red, 0.5f}}});
  EXPECT_EQ(blue_front, same);
  EXPECT_GT(blue_front.z(), blue_front.x());
  EXPECT_GT(red_front.x(), red_front.z());
  // Glass behind something opaque does not show.
  EXPECT_EQ(middle({{2, {-1, -1, white}}}), middle({{2, {-1, -1, white}}, {1, {-1, -1, red, 0.5f}}}));
}

TEST(Renderer, the_clip_plane_opens_surfaces_and_particles) {
  Frame frame = plain_frame();
  frame.surfaces = {square(0.004f, 0.001f), square(0.004f, -0.001f)};
  frame.panels[0].surfaces = {{0, {-1, -1, Color(0.9f, 0.1f, 0.1f)}}, {1, {-1, -1, Color(0.1f, 0.1f, 0.9f)}}};
  frame.panels[0].clip = ClipPlane{{0, 0, 0}, Eigen::Vector3f::UnitZ()};
  EXPECT_GT(pixel_at(renderer().draw(frame, small), view_of(frame, small), {0, 0, 0}).z(), 150);
  frame.panels[0].surfaces[0].style.clipped = false;
  EXPECT_GT(pixel_at(renderer().draw(frame, small), view_of(frame, small), {0, 0, 0}).x(), 150);
}

TEST(Renderer, a_cut_ball_shows_a_flat_face_in_its_true_colour) {
  Frame frame = plain_frame();
  frame.particles = {{"p", {{0, 0, 0}}, {{0.6f}}, 0.003f}};
  frame.panels[0].particles = {{0, {0, 0}}};
  frame.panels[0].clip = ClipPlane{{0, 0, 0}, Eigen::Vector3f::UnitZ()};
  const Image image = renderer().draw(frame, small);
  const Seen seen = view_of(frame, small);
  const Color wanted = 255 * map_color(Colormap::viridis, 0.6);
  for (const float x : {-0.0025f, 0.0f, 0.0025f})
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(pixel_at(image, seen, {x, 0, 0})[k], wanted[k], 3);
}

// A linear field on a lattice, cut: the face shows that field without gaps, whether or not the balls touch.
TEST(Renderer, the_section_shows_the_field_of_the_particles) {
  Frame frame = plain_frame();
  ParticleSet set;
  set.radius = 0.62f * 0.0005f;
  set.fields.resize(1);
  for (int z = -4; z <= 4; ++z)
    for (int y = -8; y <= 8; ++y)
      for (int x = -8; x <= 8; ++x) {
        set.positions.emplace_back(0.0005f * Eigen::Vector3f(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)));
        set.fields[0].push_back(0.5f + 0.05f * static_cast<float>(x));
      }
  frame.particles = {set};
  frame.panels[0].particles = {{0, {0, 0}, ParticleShape::sphere, true}};
  frame.panels[0].clip = ClipPlane{{0, 0, 0.0002f}, Eigen::Vector3f::UnitZ()};
  const Image image = renderer().draw(frame, small);
  const Seen seen = view_of(frame, small);
  for (float x = -0.003f; x <= 0.0031f; x += 0.00023f) {
    const Color wanted = 255 * map_color(Colormap::viridis, 0.5 + 0.05 * x / 0.0005);
    const Eigen::Vector3i found = pixel_at(image, seen, {x, 0.0007f, 0});
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(found[k], wanted[k], 10) << "x = " << x;
  }
  EXPECT_TRUE(is_background(pixel_at(image, seen, {0.0045f, 0.0007f, 0})));
}

TEST(Renderer, lines_have_their_width_and_lie_on_their_surface) {
  Frame frame = plain_frame();
  frame.surfaces = {square(0.004f, 0)};
  frame.lines = {{"l", {{-0.003f, 0, 0}, {0.003f, 0, 0}}, {}, false}};
  frame.panels[0].surfaces = {{0, {-1, -1, Color(0.9f, 0.9f, 0.9f)}}};
  frame.panels[0].lines = {{0, {-1, -1, Color(0.7f, 0, 0)}, 3, 0.0006f}};
  const Image image = renderer().draw(frame, small);
  const Seen seen = view_of(frame, small);
  EXPECT_LT(pixel_at(image, seen, {0.001f, 0.0002f, 0}).y(), 40);
  EXPECT_GT(pixel_at(image, seen, {0.001f, 0.0005f, 0}).y(), 150);
}

TEST(Renderer, a_skin_has_thickness_from_the_side) {
  Frame frame = plain_frame();
  frame.surfaces = {square(0.003f, 0)};
  frame.surfaces[0].thickness = 0.001f;
  frame.panels[0].camera.backward = Eigen::Vector3f::UnitX();
  frame.panels[0].camera.up = Eigen::Vector3f::UnitZ();
  frame.panels[0].surfaces = {{0, {-1, -1, Color(0.8f, 0.2f, 0.2f)}}};
  const Image image = renderer().draw(frame, small);
  const Seen seen = view_of(frame, small);
  EXPECT_GT(pixel_at(image, seen, {0, 0, 0.0004f}).x(), pixel_at(image, seen, {0, 0, 0.0004f}).y() + 50);
  EXPECT_TRUE(is_background(pixel_at(image, seen, {0, 0, 0.0007f})));
}

// A bent strip, cut across: along its middle the cut shows the strip's own colour, also where its pieces meet at an angle, and nowhere the
// dark of its edge.
TEST(Renderer, a_cut_skin_shows_one_colour_without_seams) {
  for (int direction = 1; direction <= 12; ++direction) {  // depths round otherwise in each
    Frame frame = plain_frame();
    const Eigen::Matrix3f turn =
        Eigen::AngleAxisf(0.5f * static_cast<float>(direction), Eigen::Vector3f(1, 2, 3).normalized()).toRotationMatrix();
    const Eigen::Vector3f shift(0.0013f, -0.0007f, 0.0211f);
    Surface strip{"leaflet", {}, {}, {}};
    const auto height = [](int i) { return 0.0012f * std::sin(0.9f * static_cast<float>(i)); };
    for (int i = 0; i <= 12; ++i)
      for (const float z : {-0.002f, 0.002f})
        strip.vertices.emplace_back(shift + turn * Eigen::Vector3f(-0.0036f + 0.0006f * static_cast<float>(i), height(i), z));
    for (int i = 0; i < 12; ++i) {
      strip.triangles.push_back({2 * i, 2 * i + 2, 2 * i + 1});
      strip.triangles.push_back({2 * i + 1, 2 * i + 2, 2 * i + 3});
    }
    strip.thickness = 0.0008f;
    frame.surfaces = {strip};
    Panel& panel = frame.panels[0];
    panel.clip = ClipPlane{shift, turn.col(2)};
    panel.camera.target = shift;
    panel.camera.backward = turn.col(2);
    panel.camera.up = turn.col(1);
    const Color color(0.9f, 0.8f, 0.6f);
    panel.surfaces = {{0, {-1, -1, color}, false, true}};
    const Image image = renderer().draw(frame, small);
    const Seen seen = view_of(frame, small);
    for (int i = 0; i < 12; ++i)
      for (int k = 0; k <= 10; ++k) {
        const float part = 0.1f * static_cast<float>(k);
        const Eigen::Vector3f place(-0.0036f + 0.0006f * (static_cast<float>(i) + part), (1 - part) * height(i) + part * height(i + 1), 0);
        EXPECT_LT((pixel_at(image, seen, shift + turn * place).cast<float>() - 255 * color).cwiseAbs().maxCoeff(), 6) << i << " + " << part;
      }
  }
}

TEST(Renderer, occlusion_darkens_a_corner_and_leaves_the_open_alone) {
  Frame frame = plain_frame();
  Surface wall = square(0.004f, 0);
  frame.surfaces = {wall};
  frame.particles = {{"p", {{0, 0, 0.0004f}}, {}, 0.0005f}};
  frame.panels[0].surfaces = {{0, {-1, -1, Color(0.9f, 0.9f, 0.9f)}}};
  frame.panels[0].particles = {{0, {-1, -1, Color(0.9f, 0.9f, 0.9f)}}};
  PictureSettings off = small;
  off.draw.ambient_occlusion = false;
  const Image with = renderer().draw(frame, small), without = renderer().draw(frame, off);
  const Seen seen = view_of(frame, small);
  const auto change = [&](const Eigen::Vector3f& p) { return pixel_at(without, seen, p).sum() - pixel_at(with, seen, p).sum(); };
  EXPECT_GT(change({0.00056f, 0, 0}), 10);
  EXPECT_LT(std::abs(change({0.0030f, 0, 0})), 6);
}

TEST(Renderer, supersampling_and_smoothing_soften_a_slanted_edge) {
  Frame frame = plain_frame();
  frame.surfaces = {square(0.003f, 0)};
  for (Eigen::Vector3f& v : frame.surfaces[0].vertices) v = Eigen::Vector3f(v.x() + 0.2f * v.y(), v.y() - 0.2f * v.x(), 0);
  frame.panels[0].surfaces = {{0, {-1, -1, Color(0.1f, 0.1f, 0.1f)}}};
  const auto between = [&](int supersampling, bool smooth) {
    PictureSettings settings = small;
    settings.draw = {supersampling, false, smooth};
    const Image image = renderer().draw(frame, settings);
    int count = 0;
    for (int y = 40; y < 330; ++y)
      for (int x = 0; x < image.width; ++x) count += image.at(x, y)[0] > 60 && image.at(x, y)[0] < 180;
    return count;
  };
  const int rough = between(1, false);
  EXPECT_GT(between(1, true), rough + 100);
  EXPECT_GT(between(2, true), rough + 100);
}

TEST(Renderer, a_frame_of_background_alone_is_refused) {
  Frame frame = plain_frame();
  frame.panels[0].title = "Blood";
  for (const bool outside : {false, true}) {
    if (outside) {
      frame.particles = {{"p", {{1, 1, 0}}, {}, 0.001f}};
      frame.panels[0].particles = {{0, {}}};
    }
    try {
      renderer().draw(frame, small);
      FAIL();
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find("Blood"), std::string::npos);
      EXPECT_NE(std::string(error.what()).find("background"), std::string::npos);
    }
  }
}

TEST(Renderer, the_same_frame_gives_the_same_bytes) {
  const Frame frame = example::valve_frame(0.4f, 2e-3f);
  const Image first = renderer().draw(frame, {640, 360, {}});
  renderer().draw(example::valve_frame(0.9f, 2e-3f), {500, 400, {2, true, true}});  // something else between
  EXPECT_EQ(renderer().draw(frame, {640, 360, {}}).rgba, first.rgba);
  Renderer another;
  EXPECT_EQ(another.draw(frame, {640, 360, {}}).rgba, first.rgba);
}

TEST(Renderer, the_valve_is_where_it_should_be_and_opens) {
  const PictureSettings settings{960, 540, {}};
  const auto middle_shows_valve = [&](float opening) {
    const Frame frame = example::valve_frame(opening, 2e-3f);
    const Image image = renderer().draw(frame, settings);
    const Eigen::Vector3i pixel = pixel_at(image, view_of(frame, settings, 1), {0.0025f, 0, 0.008f});

    return !is_background(pixel) && pixel.x() > pixel.y() + 10;  // inferno: red above green
  };
  EXPECT_TRUE(middle_shows_valve(0.05f));
  EXPECT_FALSE(middle_shows_valve(0.95f));
}

TEST(Renderer, a_picture_beyond_the_driver_is_refused_in_words) {
  EXPECT_THROW(renderer().draw(example::valve_frame(0.5f, 3e-3f), {60000, 200, {}}), std::exception);
  EXPECT_THROW(renderer().draw(example::valve_frame(0.5f, 3e-3f), {10, 10, {}}), std::invalid_argument);
}

// Blood that reaches beyond the vessel, cut along it: the cut face ends at the vessel's wall.
TEST(Renderer, a_section_ends_at_the_vessels_wall) {
  Frame frame = plain_frame();
  ParticleSet blood{"blood", {}, {{}}, 0.0003f};
  for (float z = -0.0015f; z < 0.0016f; z += 0.0005f)
    for (float y = -0.004f; y < 0.00401f; y += 0.0005f)
      for (float x = -0.004f; x < 0.00401f; x += 0.0005f) {
        blood.positions.emplace_back(x, y, z);
        blood.fields[0].push_back(0.5f);
      }
  frame.particles = {blood};
  Surface tube{"vessel", {}, {}, {}};  // a closed box of half width 2 mm across and 3 mm along
  for (const float z : {-0.002f, 0.002f})
    for (const auto& [x, y] : {std::pair{-1.f, -1.f}, {1.f, -1.f}, {1.f, 1.f}, {-1.f, 1.f}})
      tube.vertices.emplace_back(0.002f * x, 0.003f * y, z);
  for (const auto& [a, b, c, d] : {std::array{3, 2, 1, 0}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}) {
    tube.triangles.push_back({a, b, c});
    tube.triangles.push_back({a, c, d});
  }
  frame.surfaces = {tube};
  Panel& panel = frame.panels[0];
  panel.clip = ClipPlane{{0, 0, 0.0001f}, Eigen::Vector3f::UnitZ()};
  panel.particles = {{0, {0, 0}, ParticleShape::sphere, true}};
  const Eigen::Vector3f inside(0.0012f, 0.0012f, 0.0001f), outside(0.0030f, 0.0012f, 0.0001f);
  const Color wanted = 255 * map_color(Colormap::viridis, 0.5);
  for (const bool bounded : {false, true}) {
    if (bounded) panel.surfaces = {{0, {-1, -1, Color(0.8f, 0.5f, 0.5f), 0.2f}, false, true}};
    const Image image = renderer().draw(frame, small);
    const Seen seen = view_of(frame, small);
    const auto is_blood = [&](const Eigen::Vector3f& p) { return (pixel_at(image, seen, p).cast<float>() - wanted).norm() < 12; };
    EXPECT_TRUE(is_blood(inside));
    EXPECT_EQ(is_blood(outside), !bounded);
  }
}

}  // namespace
}  // namespace render
