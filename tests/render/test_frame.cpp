#include "render/frame.h"

#include <gtest/gtest.h>

#include <functional>
#include <stdexcept>

#include "render/example_frame.h"

namespace render {
namespace {

std::string refusal(const std::function<void(Frame&)>& damage) {
  Frame frame = example::valve_frame(0.5f, 3e-3f);
  damage(frame);
  try {
    check_frame(frame);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

TEST(Frame, a_sound_frame_passes) {
  EXPECT_EQ(refusal([](Frame&) {}), "");
}

TEST(Frame, what_does_not_hold_together_is_named) {
  const auto says = [](const std::string& text, const char* part) { EXPECT_NE(text.find(part), std::string::npos) << "'" << text << "'"; };
  says(refusal([](Frame& f) { f.panels.clear(); }), "no panel");
  says(refusal([](Frame& f) { f.scales[1].maximum = f.scales[1].minimum; }), "Stress on the valve");
  says(refusal([](Frame& f) { f.particles[0].fields[0].pop_back(); }), "particles 'blood'");
  says(refusal([](Frame& f) { f.particles[0].radius = 0; }), "radius");
  says(refusal([](Frame& f) { f.surfaces[2].triangles[0][1] = 100000; }), "vertex 100000");
  says(refusal([](Frame& f) { f.panels[0].particles[0].set = 4; }), "particle set 4");
  says(refusal([](Frame& f) { f.panels[0].particles[0].style.field = 2; }), "field 2");
  says(refusal([](Frame& f) { f.panels[0].particles[0].style.scale = -1; }), "no colour scale");
  says(refusal([](Frame& f) { f.panels[1].legends = {5}; }), "colour scale 5");
  says(refusal([](Frame& f) { f.panels[1].camera.width = 0; }), "camera");
  says(refusal([](Frame& f) { f.plots[0].curves[0].value.pop_back(); }), "left ventricle");
}

TEST(Frame, side_by_side_keeps_each_panels_things_and_shares_the_scale) {
  Frame a = example::valve_frame(0.2f, 3e-3f), b = example::valve_frame(0.8f, 3e-3f);
  b.title = "Stiffer";
  b.scales[1].maximum = 9e5;
  b.surfaces[1].name = "the other leaflet";
  const Frame both = side_by_side({a, b});
  EXPECT_NO_THROW(check_frame(both));
  ASSERT_EQ(both.panels.size(), 4u);
  EXPECT_EQ(both.surfaces[both.panels[3].surfaces[1].surface].name, "the other leaflet");
  for (const Panel& panel : both.panels)
    for (const int legend : panel.legends) {
      if (both.scales[legend].label == a.scales[1].label) {
        EXPECT_EQ(both.scales[legend].maximum, 9e5);
      }
    }
  EXPECT_NE(both.title.find("Stiffer"), std::string::npos);
  EXPECT_THROW(side_by_side({}), std::invalid_argument);
}

}  // namespace
}  // namespace render
