#include "app/view_knobs.h"

#include <gtest/gtest.h>

namespace app {
namespace {

const char* const scene_text =
    "title = \"a valve\"\nspacing = 1.5e-3\n[patient]\nvalve = { youngs_modulus = 8e5, thickness = 0.4e-3 }\nheart_rate = 60\n";

TEST(ViewKnobs, start_as_the_case_has_them) {
  const Knobs knobs = knobs_of(parse_scene_text(scene_text, "valve.toml"));
  EXPECT_EQ(knobs.youngs_modulus, 8e5);
  EXPECT_EQ(knobs.thickness, 0.4e-3);
  EXPECT_EQ(knobs.heart_rate, 60);
  EXPECT_TRUE(knob_settings(knobs, knobs).empty());
  EXPECT_EQ(knobs_text(knobs, knobs), "nothing changed");
}

// What the sliders mean is what --set understands: the scene read with the settings has the sliders' values.
TEST(ViewKnobs, settings_lead_to_the_values) {
  const Knobs start = knobs_of(parse_scene_text(scene_text, "valve.toml"));
  Knobs now = start;
  now.youngs_modulus = 2.5e6;
  now.poisson_ratio = 0.4;
  now.heart_rate = 90;
  now.own_pressures = true;
  now.aortic_systolic = 18000, now.aortic_diastolic = 12000;
  now.spots.push_back({{0.001, -0.002, 0.003}, 0.0015, 30});
  const SceneFile scene = parse_scene_text(scene_text, "valve.toml", knob_settings(start, now));
  const Knobs reached = knobs_of(scene);
  EXPECT_EQ(reached.youngs_modulus, 2.5e6);
  EXPECT_EQ(reached.poisson_ratio, 0.4);
  EXPECT_EQ(reached.heart_rate, 90);
  EXPECT_EQ(reached.aortic_diastolic, 12000);
  ASSERT_EQ(scene.bodies[0].stiffness_map.size(), 1u);
  EXPECT_EQ(scene.bodies[0].stiffness_map[0].scale, 30);
  EXPECT_NEAR((scene.bodies[0].stiffness_map[0].region.center - Eigen::Vector3d(0.001, -0.002, 0.003)).norm(), 0, 1e-12);
  EXPECT_EQ(knobs_text(start, now), "leaflets 2.5 MPa (was 0.8), Poisson's ratio 0.4, 90 beats a minute, own pressures, 1 stiff spot");
}

}  // namespace
}  // namespace app
