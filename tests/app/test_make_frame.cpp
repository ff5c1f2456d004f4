#include "app/make_frame.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <stdexcept>

#include "tests/app/example_run.h"

namespace app {
namespace {

class MakeFrame : public testing::Test {
 protected:
  std::string valve_path_ = testing::TempDir() + "cusp_frame_valve.h5", flat_path_ = testing::TempDir() + "cusp_frame_flat.h5";
  MakeFrame() {
    example::write_valve_run(valve_path_);
    example::write_flat_run(flat_path_);
  }
  ~MakeFrame() override {
    for (const std::string& path : {valve_path_, flat_path_})
      for (const char* ending : {".h5", ".xmf", ".csv"}) std::filesystem::remove(std::filesystem::path(path).replace_extension(ending));
  }
};

TEST_F(MakeFrame, a_valve_shows_the_papers_pair_and_the_surgeons_view) {
  const sim::RunReader run(valve_path_);
  const FrameMaker maker(run, {}, field_ranges({&run}));
  const render::Frame frame = maker.make(4);
  EXPECT_NO_THROW(render::check_frame(frame));
  ASSERT_EQ(frame.panels.size(), 3u);
  EXPECT_TRUE(frame.panels[0].clip);  // blood cut open
  EXPECT_EQ(frame.panels[0].legends, std::vector<int>{scale_slot("pressure")});
  EXPECT_EQ(frame.panels[1].legends, std::vector<int>{scale_slot("stress")});
  EXPECT_TRUE(frame.panels[1].particles.empty());
  EXPECT_GT(frame.panels[2].camera.backward.z(), 0.99f);  // from the aorta
  EXPECT_LT(frame.panels[2].camera.up.x(), -0.99f);       // the first leaflet, towards +x, at the bottom
  EXPECT_EQ(frame.title, "Example valve");
  EXPECT_DOUBLE_EQ(*frame.time, 0.4);
  ASSERT_FALSE(frame.readouts.empty());
  EXPECT_EQ(frame.readouts[0], "LV 16.0 kPa (120 mmHg)");
  EXPECT_EQ(frame.warnings.size(), 1u);
  EXPECT_NE(frame.caption.find("not for clinical"), std::string::npos);
  ASSERT_EQ(frame.plots.size(), 2u);
  EXPECT_EQ(frame.plots[0].curves.size(), 2u);
  EXPECT_NEAR(frame.plots[0].curves[0].value[4], 16000 / 133.322, 1e-9);
}

TEST_F(MakeFrame, values_and_places_are_those_of_the_file) {
  const sim::RunReader run(valve_path_);
  const render::Frame frame = FrameMaker(run, {}, field_ranges({&run})).make(2);
  const sim::RunFrame state = run.frame(2);
  const render::Surface& leaflet = frame.surfaces[first_leaflet + 1];
  const std::size_t row = static_cast<std::size_t>(run.header().bodies[1].first) + 17;
  for (int k = 0; k < 3; ++k) EXPECT_FLOAT_EQ(leaflet.vertices[17][k], static_cast<float>(state.position[row][k]));
  EXPECT_EQ(leaflet.fields[field_index("stress")][17], state.von_mises[row]);
  EXPECT_EQ(leaflet.fields[field_index("principal_stress")][17], state.principal_stress[row]);
  const auto start = run.frame(0).position;
  EXPECT_NEAR(
      leaflet.fields[field_index("displacement")][17],
      std::hypot(state.position[row][0] - start[row][0], state.position[row][1] - start[row][1], state.position[row][2] - start[row][2]),
      1e-8);
  const render::ParticleSet& blood = frame.particles[fluid_set];
  std::size_t fluid = 0;
  for (std::size_t i = 0; i < state.size(); ++i) fluid += state.kind[i] == static_cast<std::uint8_t>(sim::Kind::fluid);
  EXPECT_EQ(blood.positions.size(), fluid);
  EXPECT_FLOAT_EQ(blood.fields[field_index("speed")][5], state.velocity.back()[2]);
}

TEST_F(MakeFrame, the_scale_stays_the_same_over_the_run_and_can_be_set) {
  const sim::RunReader run(valve_path_);
  const FieldRanges ranges = field_ranges({&run});
  const FrameMaker maker(run, {}, ranges);
  for (const std::size_t index : {0u, 4u, 8u}) {
    EXPECT_EQ(maker.make(index).scales[scale_slot("stress")].maximum, ranges.at("stress")[1]);
    EXPECT_EQ(maker.make(index).scales[scale_slot("pressure")].minimum, ranges.at("pressure")[0]);
  }
  EXPECT_EQ(ranges.at("stress"), (Range2{0, 3e5}));
  EXPECT_EQ(ranges.at("speed"), (Range2{0, 1}));
  EXPECT_LE(ranges.at("pressure")[0], 9100);
  EXPECT_GE(ranges.at("pressure")[1], 17000);
  PictureChoice choice;
  choice.ranges["stress"] = {1e5, 2e5};
  choice.pressure_units = "mmHg";
  choice.map = "cividis";
  const render::Frame frame = FrameMaker(run, choice, ranges).make(0);
  EXPECT_EQ(frame.scales[scale_slot("stress")].maximum, 2e5);
  EXPECT_EQ(frame.scales[scale_slot("pressure")].unit, "mmHg");
  EXPECT_EQ(frame.scales[scale_slot("stress")].map, render::Colormap::cividis);
}

// The first row of each made-up leaflet never moves: it is held, so it is left out of the range and shows the stress of the row beside it.
// The mark beside the colour bar is the largest value as computed among what moves.
TEST_F(MakeFrame, what_is_held_shows_what_is_beside_it) {
  const sim::RunReader run(valve_path_);
  const render::Frame frame = FrameMaker(run, {}, field_ranges({&run})).make(4);
  const std::vector<float>& stress = frame.surfaces[first_leaflet].fields[field_index("stress")];
  EXPECT_NEAR(stress[6], 3e5 * (1 - 0.7 / 8), 1);       // in the held row
  EXPECT_NEAR(stress[13 + 6], 3e5 * (1 - 0.7 / 8), 1);  // its neighbour's own
  ASSERT_TRUE(frame.scales[scale_slot("stress")].highest);
  EXPECT_NEAR(*frame.scales[scale_slot("stress")].highest, 3e5 * (1 - 0.7 / 8), 1);
}

// A water hammer of one frame in forty does not set the scale of the whole run.
TEST_F(MakeFrame, one_extreme_frame_does_not_set_the_scale) {
  const std::string path = testing::TempDir() + "cusp_frame_hammer.h5";
  const sim::RunReader calm(valve_path_);
  {
    sim::RunWriter writer = sim::RunWriter::create(path, calm.header());
    for (int n = 0; n < 40; ++n) {
      sim::RunFrame state = calm.frame(static_cast<std::size_t>(n % 9));
      state.time = 0.02 * n;
      if (n == 21)
        for (float& pressure : state.pressure) pressure *= 10;
      writer.add_frame(state);
    }
    writer.finish();
  }
  const sim::RunReader run(path);
  EXPECT_EQ(field_ranges({&run}, 40).at("pressure"), field_ranges({&calm}).at("pressure"));
  for (const char* ending : {".h5", ".xmf", ".csv"}) std::filesystem::remove(std::filesystem::path(path).replace_extension(ending));
}

TEST_F(MakeFrame, two_runs_share_their_widest_range) {
  const std::string other = testing::TempDir() + "cusp_frame_other.h5";
  example::write_valve_run(other, 5, 9e5);
  const sim::RunReader a(valve_path_), b(other);
  EXPECT_EQ(field_ranges({&a, &b}).at("stress")[1], 1e6);  // 0.9125 of 9e5 in the first row that moves, rounded outwards
  for (const char* ending : {".h5", ".xmf", ".csv"}) std::filesystem::remove(std::filesystem::path(other).replace_extension(ending));
}

TEST_F(MakeFrame, a_flat_scene_shows_everything_in_one_plane) {
  const sim::RunReader run(flat_path_);
  const render::Frame frame = FrameMaker(run, {}, field_ranges({&run})).make(2);
  EXPECT_NO_THROW(render::check_frame(frame));
  ASSERT_EQ(frame.panels.size(), 1u);
  EXPECT_EQ(frame.panels[0].particles.size(), 3u);  // walls, water, block
  for (const render::ParticleLayer& layer : frame.panels[0].particles) EXPECT_EQ(layer.shape, render::ParticleShape::disc);
  EXPECT_EQ(frame.panels[0].legends.size(), 2u);
  ASSERT_EQ(frame.lines.size(), 1u);
  ASSERT_EQ(frame.lines[0].points.size(), 11u);  // the beam, from end to end although its segments were not in order
  for (int i = 0; i < 11; ++i) EXPECT_NEAR(frame.lines[0].points[i].y(), 0.05 * i, 1e-6);
  EXPECT_FLOAT_EQ(frame.panels[0].lines[0].metres, 0.04f);
  ASSERT_EQ(frame.plots.size(), 1u);
  EXPECT_EQ(frame.plots[0].curves.size(), 2u);
  EXPECT_TRUE(frame.caption.empty());
}

TEST_F(MakeFrame, what_is_unknown_is_refused_with_what_there_is) {
  const sim::RunReader valve(valve_path_), flat(flat_path_);
  const auto says = [](const sim::RunReader& run, const PictureChoice& choice) {
    try {
      chosen_views(choice, run.header(), true);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  PictureChoice choice;
  choice.views = {"sideways"};
  EXPECT_NE(says(valve, choice).find("from_ventricle"), std::string::npos);
  choice.views = {"long_axis"};
  EXPECT_EQ(says(valve, choice), "");
  EXPECT_NE(says(flat, choice).find("plane"), std::string::npos);
  choice.fields = {"temperature"};
  EXPECT_NE(says(valve, choice).find("principal_stress"), std::string::npos);
  choice.fields = {"stress", "pressure"};
  EXPECT_NE(says(valve, choice).find("one each"), std::string::npos);
}

TEST(Chain, follows_open_and_closed_lines) {
  EXPECT_EQ(chain({{2, 1, -1}, {0, 1, -1}, {3, 2, -1}}), (std::vector<std::int32_t>{0, 1, 2, 3}));
  const std::vector<std::int32_t> ring = chain({{0, 1, -1}, {1, 2, -1}, {2, 0, -1}});
  ASSERT_EQ(ring.size(), 4u);
  EXPECT_EQ(ring.front(), ring.back());
  EXPECT_TRUE(chain({}).empty());
}

TEST(PictureWords, pressures_read_in_both_units) { EXPECT_EQ(pressure_text(15998.64), "16.0 kPa (120 mmHg)"); }

}  // namespace
}  // namespace app
